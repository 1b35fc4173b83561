// The time line, a fork and pins for everybody: axe in both schemes, no sideways scrolling, all by keys.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, reachImpact } from './stage.js';

const stage = await Stage.open();

for (const width of [320, 1280]) {
  test(`axe finds nothing with a fork and three pins at ${width} px in both schemes`, async () => {
    const { page } = await stage.page(
      '?preset=case-1&pin.0.preset=case-2&pin.1.preset=case-3&pin.2.preset=case-1&pin.2.scene.table.tilt_gain=1.3&tab=why',
      { viewport: { width, height: 800 } },
    );
    await page.locator('.pin[data-pin=C] b', { hasText: 'fell' }).waitFor();
    await page.click('#double-drop');
    await reachImpact(page, 3);
    await page.click('#step-back');
    await page.click('#fork');
    await page.locator('#fork-told', { hasText: 'From bounce' }).waitFor();
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  });
}

test('pins, a fork and the past are worked by keys alone', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  await page.locator('#scrub').waitFor();
  const press = async (selector, key) => {
    await page.locator(selector).focus();
    await page.keyboard.press(key);
  };
  await press('#run', 'Enter');
  await reachImpact(page, 4);
  await press('#pin', 'Enter');
  await page.locator('.pin b', { hasText: 'survived' }).waitFor();
  await press('.pin .rod', 'Space');
  assert.equal(await page.evaluate(() => document.activeElement.className), 'rod', 'the focus stays');
  await press('#scrub', 'PageDown');
  await press('#fork', 'Enter');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fork-gain');
  await page.keyboard.press('ArrowRight');
  await page.locator('#fork-told', { hasText: 'From bounce' }).waitFor();
  await press('#fork-close', 'Enter');
  await press('.pin .remove', 'Enter');
  assert.equal(await page.locator('.pin').count(), 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'pin');
  clean();
});
