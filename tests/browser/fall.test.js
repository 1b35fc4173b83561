// A fall is seen: its last three strikes are replayed slowly, unless motion is unwanted.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, reachPhase, speedUp } from './stage.js';

const stage = await Stage.open();
const FALLS = '?preset=case-3&scene.release.theta=0.3';

/** Runs until it falls. @returns the impact at which it ended */
async function fallen(page) {
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await page.click('#run');
  await reachPhase(page, 'ended');
  const { outcome } = await (await fetch(`${stage.url}v1/trajectories${FALLS}&bounces=500`)).json();
  return outcome;
}

/** The time of the scene, s. */
const time = (page) =>
  page.locator('#timeline-told').evaluate((told) => Number(/([\d.]+)\ss/.exec(told.textContent)?.[1] ?? NaN));

test('the last three strikes of a fall are replayed at a tenth of the speed', async () => {
  const { page, clean } = await stage.page(FALLS);
  const outcome = await fallen(page);
  const told = page.locator('#timeline-told', { hasText: 'at a tenth of the speed' });
  await told.waitFor();
  assert.match(await told.innerText(), new RegExp(`^n\\s${outcome.bounces - 2}\\s`));
  const [from, begun] = [await time(page), Date.now()];
  await page.waitForFunction(
    (t) => Number(/([\d.]+)\ss/.exec(document.querySelector('#timeline-told').textContent)?.[1]) > t + 0.04,
    from,
  );
  const pace = ((await time(page)) - from) / ((Date.now() - begun) / 1000);
  assert.ok(pace < 0.2, `${pace} times real time`);
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();
  assert.equal(await page.locator('#run').innerText(), 'Run again');
  assert.ok(Math.abs((await time(page)) - outcome.t) < 0.01);
  // Once more, and stopped on the way.
  await page.click('#to-now');
  await told.waitFor();
  await page.click('#to-now');
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();
  clean();
});

test('where motion is unwanted a fall is replayed only when asked for', async () => {
  const { page, clean } = await stage.page(FALLS, { reducedMotion: 'reduce' });
  const outcome = await fallen(page);
  const button = page.locator('#to-now', { hasText: 'Replay the fall' });
  await button.waitFor();
  await page.waitForTimeout(400);
  assert.ok(Math.abs((await time(page)) - outcome.t) < 0.01, 'the end is shown');
  await button.click();
  await page.locator('#timeline-told', { hasText: 'at a tenth of the speed' }).waitFor();
  clean();
});

test('nothing jumps when a run falls, is replayed and is over', async () => {
  const { page, clean } = await stage.page(FALLS);
  await page.locator('#scrub').waitFor();
  const places = () =>
    page.evaluate(() =>
      ['#scrub', '#gain', '#to-now'].map((id) => {
        const { left, top, width } = document.querySelector(id).getBoundingClientRect();
        return [left, top + scrollY, width].map(Math.round);
      }),
    );
  await speedUp(page);
  await page.click('#run');
  await page.locator('#timeline-told', { hasText: /n\s2/ }).waitFor();
  const before = await places();
  await page.locator('#timeline-told', { hasText: 'at a tenth of the speed' }).waitFor();
  assert.deepEqual(await places(), before);
  await page.click('#to-now');
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();
  assert.deepEqual(await places(), before);
  clean();
});

test('a run that ended long ago is shown at its end', async () => {
  const { page, clean } = await stage.page(`${FALLS}&epoch_ms=${Date.now() - 3600_000}`);
  await reachPhase(page, 'ended');
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();
  clean();
});
