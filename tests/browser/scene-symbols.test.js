// What the scene shows beside the rod: the symbols of Fig. 1, the first flights of a scene that is not released, and a body for any typed length.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, enter, impacts, ink, inkOf, openTab, reachImpact, tool, verdict, startPaused } from './stage.js';

const stage = await Stage.open();
const wake = (page) => page.locator('#grab').waitFor();

/** Pixels of the scene that are not its ground. */
const drawn = (page) =>
  page.locator('#scene-frame canvas').evaluate((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let at = 3; at < data.length; at += 4) if (data[at] > 0) count += 1;
    return count;
  });

test('symbols are drawn by the button and by a key, told in words, and remembered', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await wake(page);
  const before = await ink(page, '#scene-frame', '--ink');
  await tool(page, 'symbols');
  await page
    .locator('#symbols-words', { hasText: /l\s0\.1333\sm, ρ\s0\.0943\sm, θ\s0\.300/ })
    .waitFor({ state: 'attached' });
  const after = await ink(page, '#scene-frame', '--ink');
  assert.ok(after > before + 40, `${before} ${after}`);
  await page.locator('body').press('l');
  assert.equal(await page.getAttribute('#symbols', 'aria-pressed'), 'false');
  await page.waitForFunction(() => document.querySelector('#symbols-words').textContent === '');
  await page.locator('body').press('l');
  await page.reload();
  await wake(page);
  assert.equal(await page.getAttribute('#symbols', 'aria-pressed'), 'true');
  // At a strike α and β belong to it.
  await startPaused(page);
  await page.click('#step');
  await reachImpact(page, 1);
  await page.locator('#symbols-words', { hasText: /α\s[−\d.]+/ }).waitFor({ state: 'attached' });
  await openTab(page, 'why');
  await page.click('#about-picture summary');
  await page.locator('#about-picture dd', { hasText: 'radius of gyration' }).waitFor();
  clean();
});

test('a point mass has an α and no length', async () => {
  const { page, clean } = await stage.page('?preset=point-mass');
  await wake(page);
  await tool(page, 'symbols');
  await page.locator('#symbols-words', { hasText: /scene: α\s0\.000\srad\.$/ }).waitFor({ state: 'attached' });
  clean();
});

test('the first flights of the typed scene are a faint path, which follows a setting', async () => {
  const { page, clean } = await stage.judged('?preset=case-1');
  // Over the level of the table, far from the rod, there is nothing but the grid and the path.
  const canvas = page.locator('#scene-frame canvas');
  const [width, height] = await canvas.evaluate((element) => [element.width, element.height]);
  const left = () => inkOf(canvas, '--accent', { margins: [0, 0, width / 2 + 60, height / 2], opacity: 29 });
  await page.waitForFunction(() => document.querySelector('#scene-readout').textContent.includes('Released'));
  let path = await left();
  for (let tries = 0; path < 60 && tries < 100; tries += 1) {
    await page.waitForTimeout(100);
    path = await left();
  }
  assert.ok(path >= 60, `${path}`);
  await openTab(page, 'values');
  await enter(page, '#field-release-theta', '-0.3');
  // Tilted to the other side it flies to the other side.
  let other = await left();
  for (let tries = 0; other >= 60 && tries < 100; tries += 1) {
    await page.waitForTimeout(100);
    other = await left();
  }
  assert.ok(other < 60, `${other}`);
  clean();
});

test('with a length of 0 the scene still draws a body', async () => {
  const { page } = await stage.page('?preset=case-1');
  await verdict(page);
  const before = await ink(page, '#scene-frame', '--ink');
  await openTab(page, 'values');
  await enter(page, '#field-body-contact_distance', '0');
  await page.locator('#field-body-contact_distance-error:not(:empty)').waitFor();
  await page.waitForTimeout(300);
  assert.ok((await ink(page, '#scene-frame', '--ink')) > before / 2);
  assert.ok((await drawn(page)) > 0);
});

test('axe finds nothing with the rod in hand and the symbols drawn', async () => {
  const { page } = await stage.page('?preset=case-1', { viewport: { width: 320, height: 800 } });
  await verdict(page);
  await wake(page);
  await tool(page, 'symbols');
  await page.locator('#about-picture').evaluate((details) => {
    details.open = true;
  });
  await page.focus('#grab');
  await page.keyboard.press('ArrowUp');
  await page.locator('#scene-readout', { hasText: 'Held' }).waitFor();
  assert.deepEqual(await violations(page), []);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 320));
});

test('the numbers of a strike stand at one place', async () => {
  const { page, clean } = await stage.page('?preset=case-1&speed=0.1', { stored: { symbols: 'on' } });
  await startPaused(page);
  for (let k = 0; k < 3; k += 1) {
    const n = (await impacts(page)) + 1;
    await page.click('#step');
    await reachImpact(page, n);
    await page.waitForFunction(
      (wanted) =>
        document.querySelector('#scene-readout').textContent.replace(/\s/g, ' ').includes(`bounce ${wanted} `),
      n,
    );
    // The right end below the level of the table, which has the right colour only there: the rod is in the middle.
    const canvas = page.locator('#scene-frame canvas');
    const [left, top] = await canvas.evaluate(({ width, height }) => [width - 190, height - 100]);
    const inked = await inkOf(canvas, '--strike', { margins: [left, top, left, top], opacity: 150, off: 60 });
    assert.ok(inked > 30, `${n}: ${inked}`);
  }
  clean();
});
