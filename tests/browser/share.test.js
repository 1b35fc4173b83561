// The Share menu: pictures and numbers of the run, a clip of the scene, and what a link shows in other programs.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { Stage, reachPhase, releaseTo } from './stage.js';

const stage = await Stage.open();

/** Chooses an entry of the menu and gives the file that it saves. */
async function saved(page, id) {
  await page.click('#share-open');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click(`#${id}`)]);
  assert.equal(await page.locator('#share-menu').isVisible(), false, 'the menu closes');
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

const isPng = (bytes) => bytes.subarray(0, 8).equals(Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]));
const sizeOf = (bytes) => [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];

test('pictures and numbers of the run are saved from the menu', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.table.tilt_gain=1.2&speed=20', {
    stored: { symbols: 'on' },
  });
  await page.locator('#share-open').waitFor();
  await releaseTo(page, 3);

  const png = await saved(page, 'save-png');
  assert.equal(png.name, 'equipoise-scene.png');
  assert.ok(isPng(png.bytes));
  const svg = await saved(page, 'save-svg');
  assert.equal(svg.name, 'equipoise-scene.svg');
  assert.match(svg.bytes.toString(), /^<svg .*<title>Scene<\/title>.*impulse/s);
  assert.doesNotMatch(svg.bytes.toString(), /NaN|undefined/);

  const csv = await saved(page, 'save-csv');
  assert.equal(csv.name, 'equipoise-impacts.csv');
  const rows = csv.bytes.toString().trim().split('\r\n').length - 1;
  const url = `${stage.url}v1/trajectories?preset=case-1&scene.table.tilt_gain=1.2&bounces=${rows}&format=csv`;
  assert.deepEqual(csv.bytes, Buffer.from(await (await fetch(url)).arrayBuffer()));

  const card = await saved(page, 'save-card');
  assert.ok(isPng(card.bytes));
  assert.deepEqual(sizeOf(card.bytes), [1200, 630]);
  clean();
});

test('a clip is recorded with its progress, and can be stopped', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.locator('#share-open').waitFor();
  await page.click('#share-open');
  await page.click('#save-clip');
  // The run begins by itself, so that the clip moves.
  await reachPhase(page, 'running');
  const bar = page.getByRole('progressbar', { name: 'Recorded' });
  await bar.waitFor();
  await page.waitForFunction(() => document.querySelector('.clip progress')?.value > 1);
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Stop and save' }).click(),
  ]);
  assert.match(download.suggestedFilename(), /^equipoise-scene\.(webm|mp4)$/);
  const bytes = await readFile(await download.path());
  const isVideo = bytes.readUInt32BE(0) === 0x1a45dfa3 || bytes.toString('latin1', 4, 8) === 'ftyp';
  assert.ok(isVideo && bytes.length > 5000, `${bytes.length} bytes`);
  await bar.waitFor({ state: 'detached' });
  clean();
});

test('the menu works by keys alone', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.locator('#share-open').waitFor();
  await page.locator('#share-open').focus();
  await page.keyboard.press('Enter');
  await page.locator('#save-svg').focus();
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Enter')]);
  assert.equal(download.suggestedFilename(), 'equipoise-scene.svg');
  assert.equal(await page.evaluate(() => document.activeElement?.id), 'share-open');
  clean();
});

test('on a phone the menus close, and nothing hides the clip that is recorded', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 390, height: 844 } });
  await page.locator('#tools-open').waitFor();
  await page.click('#tools-open');
  await page.click('#share-open');
  await page.click('#save-clip');
  const stop = page.getByRole('button', { name: 'Stop and save' });
  await stop.waitFor();
  assert.equal(await page.locator('#tools-open').getAttribute('aria-expanded'), 'false');
  await page.waitForFunction(() => document.querySelector('.clip progress')?.value > 0.5);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await Promise.all([page.waitForEvent('download'), stop.click()]);
  clean();
});

test('a link shows the run in words and as a picture', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.table.tilt_gain=1.6&tab=map');
  const tag = (name) => page.locator(`meta[property="og:${name}"]`).getAttribute('content');
  assert.match(await tag('title'), /^Falls at bounce \d+: /);
  assert.match(await tag('description'), /κ = 1\.6/);
  const url = new URL(await tag('url'));
  assert.equal(url.searchParams.get('tab'), 'map');
  const image = await tag('image');
  assert.ok(image.startsWith(`${stage.url}v1/previews?`), image);
  const answer = await fetch(image);
  assert.equal(answer.headers.get('content-type'), 'image/png');
  assert.deepEqual(sizeOf(Buffer.from(await answer.arrayBuffer())), [1200, 630]);
  clean();
});
