// Files that load before the first plot stay small, and all come from this server.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage } from './stage.js';

const stage = await Stage.open();
const LIMIT_BYTES = 60 * 1024;

for (const query of ['', '?preset=case-2&scene.table.tilt_gain=1.2&speed=2&map.columns=48'])
  test(`before its first plot the page loads no more than 60 KiB, compressed: ${query}`, async () => {
    const { page, clean } = await stage.page(query);
    await page.waitForFunction(() => performance.getEntriesByName('first plot').length > 0);
    const loaded = await page.evaluate(() =>
      performance
        .getEntriesByType('resource')
        .concat(performance.getEntriesByType('navigation'))
        .filter(
          ({ name, startTime }) =>
            !name.includes('/v1/') && startTime <= performance.getEntriesByName('first plot')[0].startTime,
        )
        .map(({ name, encodedBodySize }) => ({ name, encodedBodySize })),
    );
    assert.ok(loaded.length > 10);
    const total = loaded.reduce((sum, { encodedBodySize }) => sum + encodedBodySize, 0);
    assert.ok(total > 0 && total <= LIMIT_BYTES, `${total} bytes: ${JSON.stringify(loaded)}`);
    clean();
  });
