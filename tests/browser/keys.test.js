// Single keys: what each does, and that they can be turned off for good.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { Stage, impacts, reachImpact, reachPhase, tool, verdict } from './stage.js';

const stage = await Stage.open();

test('every key does what the list says', async () => {
  const { page, clean } = await stage.judged('');
  await page.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  const press = (key) => page.keyboard.press(key);
  for (const [number, preset] of [
    [3, 'case-4'],
    [5, 'rough-catch'],
    [1, 'case-1'],
  ]) {
    await press(String(number));
    await page.waitForFunction((wanted) => document.querySelector('#case').value === wanted, preset);
    await reachPhase(page, 'running');
    if (number === 5) await page.waitForFunction(() => /interventions\.0\.catch\.strategy/.test(location.search));
  }
  await press(' ');
  await reachPhase(page, 'paused');
  await press(' ');
  await reachImpact(page, 2);
  await press('[');
  await page.waitForFunction(() => /clock\.\d+\.speed=0\.5/.test(location.search));
  await press(']');
  await page.waitForFunction(() => /clock\.[2-9]\.speed=1/.test(location.search));
  await press('.');
  await reachPhase(page, 'paused');
  const held = await impacts(page);
  await press('.');
  await reachImpact(page, held + 1);
  const saved = page.waitForEvent('download');
  await press('e');
  const download = await saved;
  assert.equal(download.suggestedFilename(), 'equipoise-impacts.csv');
  assert.match(await readFile(await download.path(), 'utf8'), /^n,t_s,/);
  await press('s');
  await page.waitForFunction(() => document.querySelector('#share').textContent === 'Copied');
  // The link replays the run from its release.
  const replay = new URL(page.url());
  for (const key of [...replay.searchParams.keys()])
    if (/^(epoch_ms$|clock\.)/.test(key)) replay.searchParams.delete(key);
  const copied = new URL(await page.evaluate(() => navigator.clipboard.readText()));
  for (const url of [replay, copied]) url.searchParams.sort();
  copied.searchParams.set('speed', replay.searchParams.get('speed'));
  assert.equal(copied.href, replay.href);
  await press('m');
  await page.waitForFunction(() => document.activeElement.id === 'map-box');
  await page.evaluate(() => document.activeElement.blur());
  await press('r');
  await reachPhase(page, 'running');
  await press('p');
  await page.locator('html.presenting').waitFor();
  await press('ArrowRight');
  await page.waitForFunction(() => document.querySelector('#case').value === 'case-3');
  await press('Escape');
  await page.locator('html:not(.presenting)').waitFor();
  await press('?');
  assert.ok(await page.locator('#keys').isVisible());
  const listed = await page.locator('#keys-list kbd').allInnerTexts();
  assert.deepEqual(listed, [
    'Space',
    '.',
    ',',
    'a',
    'n',
    'r',
    'k',
    '1 – 5',
    '[ ]',
    'm',
    'p',
    'Ctrl Z',
    'l',
    's',
    'e',
    '?',
  ]);
  clean();
});

test('keys that are turned off stay off, and typing is no key', async () => {
  const { page, context, clean } = await stage.page('?preset=case-1&tab=values');
  await verdict(page);
  await page.locator('#field-gravity').focus();
  await page.keyboard.type('3.s');
  assert.equal(await page.locator('#case').inputValue(), 'case-1');
  await tool(page, 'keys-open');
  await page.locator('#keys-on').uncheck();
  await page.keyboard.press('Escape');
  assert.ok(await page.locator('#tools').isHidden());
  assert.equal(await page.evaluate(() => document.activeElement.id), 'tools-open');
  const again = await context.newPage();
  await again.goto(`${stage.url}?preset=case-1`);
  await verdict(again);
  await again.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  await again.keyboard.press('3');
  await again.keyboard.press('?');
  await again.waitForTimeout(200);
  assert.equal(await again.locator('#case').inputValue(), 'case-1');
  assert.ok(!(await again.locator('#keys').isVisible()));
  clean();
});
