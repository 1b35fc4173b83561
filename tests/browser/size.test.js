// What loads before the first plot stays small, and all of it comes from here.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, verdict } from './stage.js';

const stage = await Stage.open();
const LIMIT_BYTES = 60 * 1024;

test('the page loads no more than 60 KiB, compressed', async () => {
  const { page, clean } = await stage.page('');
  await verdict(page);
  const loaded = await page.evaluate(() => performance.getEntriesByType('resource').concat(performance.getEntriesByType('navigation'))
    .filter(({ name }) => !name.includes('/v1/')).map(({ name, encodedBodySize }) => ({ name, encodedBodySize })));
  assert.ok(loaded.length > 10);
  const total = loaded.reduce((sum, { encodedBodySize }) => sum + encodedBodySize, 0);
  assert.ok(total > 0 && total <= LIMIT_BYTES, `${total} bytes: ${JSON.stringify(loaded)}`);
  clean();
});
