// The page on opening: without a run in its address the case runs by itself, unless that is unwanted.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, ink, reachImpact, reachPhase, tool, verdict } from './stage.js';

const stage = await Stage.open();

/** The page is whole, and has had time to begin. */
async function rests(page) {
  await verdict(page);
  await page.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  await page.waitForTimeout(500);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
}

test('a first visitor sees motion and impacts without a click, and Pause is the first control', async () => {
  const { page, clean } = await stage.page('', { autorun: true });
  await reachImpact(page, 3);
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > 5, 'the plane has dots');
  assert.equal(await page.locator('#run').innerText(), 'Pause');
  const readout = () => page.locator('#scene-readout').innerText();
  const before = await readout();
  await page.waitForFunction((words) => document.querySelector('#scene-readout').innerText !== words, before);
  assert.doesNotMatch(page.url(), /epoch/, 'the address names the scene only');
  clean();
});

test('a run that began by itself is in the address once somebody acts on it, and going back works', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { autorun: true });
  await reachImpact(page, 2);
  const length = await page.evaluate(() => history.length);
  await page.selectOption('#case', 'case-2');
  await reachImpact(page, 2);
  assert.doesNotMatch(page.url(), /epoch/);
  assert.equal(await page.evaluate(() => history.length), length + 1);
  await page.goBack();
  await page.waitForFunction(() => document.querySelector('#case').value === 'case-1');
  await reachImpact(page, 2);
  await page.click('#run');
  await reachPhase(page, 'paused');
  await page.waitForFunction(() => /epoch_ms=/.test(location.search) && /clock/.test(location.search));
  assert.equal(await page.evaluate(() => history.length), length + 1);
  clean();
});

test('nothing runs by itself where less motion is wanted', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { autorun: true, reducedMotion: 'reduce' });
  await rests(page);
  clean();
});

test('nothing runs in a hidden tab, until it is looked at', async () => {
  const { page, clean } = await stage.page('?preset=case-1', {
    autorun: true,
    prepare: () => {
      globalThis.away = true;
      Object.defineProperty(document, 'hidden', { get: () => globalThis.away });
    },
  });
  await rests(page);
  await page.evaluate(() => {
    globalThis.away = false;
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await reachImpact(page, 1);
  clean();
});

test('who does not want it switches it off for good', async () => {
  const { page, context, clean } = await stage.page('?preset=case-1', { autorun: true });
  await reachImpact(page, 1);
  await page.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  await tool(page, 'keys-open');
  await page.getByLabel('Run when the page opens').uncheck();
  const again = await context.newPage();
  await again.goto(`${stage.url}?preset=case-1`);
  await rests(again);
  clean();
});
