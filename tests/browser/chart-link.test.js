// The chart of two that share a place is part of the address.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage } from './stage.js';

const stage = await Stage.open();
const energy = '.switch [aria-controls=energy]';

test('the chosen chart is in the address, and a link restores it', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.click(energy);
  await page.waitForFunction(() => /[?&]chart=energy/.test(location.search));
  await page.reload();
  await page.locator(`${energy}[aria-pressed=true]`).waitFor();
  assert.ok(await page.locator('#energy').isVisible());
  assert.ok(await page.locator('#circle').isHidden());
  await page.click('.switch [aria-controls=circle]');
  await page.waitForFunction(() => !/chart=/.test(location.search));
  clean();
});

test('a chart that is not known is dropped, and said', async () => {
  const { page, clean } = await stage.page('?preset=case-1&chart=kitchen');
  await page.locator('.notice', { hasText: 'the chart “kitchen”' }).waitFor();
  assert.ok(await page.locator('#circle').isVisible());
  clean();
});
