// Notices move nothing and cover no control of the run.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage } from './stage.js';

const stage = await Stage.open();
const ALL = 'button, select, input, summary, a';
const PHONE = '.bar :is(button, select), #controls button, #tabs button, #map-box, #why';

/** The places of the parts of the page, px. */
const places = (page) =>
  page.evaluate(() =>
    Object.fromEntries(
      ['.bar', '#scene-frame', '#controls', '#verdict-card', '#studies', '.try'].map((part) => {
        const { x, y, width, height } = document.querySelector(part).getBoundingClientRect();
        return [part, [x, y, width, height].map(Math.round)];
      }),
    ),
  );

/** The same once they rest: the line below the map comes a little after it. */
async function restingPlaces(page) {
  for (let before = null; ; ) {
    const now = JSON.stringify(await places(page));
    if (now === before) return JSON.parse(now);
    before = now;
    await page.waitForTimeout(300);
  }
}

/** Controls in the window that lie below something else. */
const covered = (page, selector) =>
  page.locator(selector).evaluateAll((controls) =>
    controls
      .filter((control) => {
        const { left, top, width, height } = control.getBoundingClientRect();
        const [x, y] = [left + width / 2, top + height / 2];
        if (!control.checkVisibility() || y < 0 || y > innerHeight || x < 0 || x > innerWidth) return false;
        return document.elementFromPoint(x, y)?.closest('.notice') != null;
      })
      .map(({ id, textContent }) => id || textContent),
  );

for (const [width, height, controls] of [
  [1280, 800, ALL],
  [844, 390, ALL],
  [390, 844, PHONE],
  [320, 568, PHONE],
])
  test(`a notice moves nothing and covers no control, ${width} × ${height} px`, async () => {
    const { page, clean } = await stage.page('?preset=case-1', { viewport: { width, height }, folded: true });
    await page.locator('#grab').waitFor();
    await page.locator('#map-box[aria-busy=false]').waitFor();
    await page.locator('#verdict .facts span').first().waitFor();
    const before = await restingPlaces(page);
    const tell = (kind, words) =>
      page.evaluate(
        async ([name, text]) => (await import('/dom/notices.js')).notice(name, [text], { caution: true }),
        [kind, words],
      );
    await tell('one', `The server did not take this run. ${'Its contact distance is not a number. '.repeat(3)}`);
    await tell('two', 'The link was not whole: two parts of it were dropped.');
    const notices = page.locator('.notice');
    await notices.nth(1).waitFor();
    assert.deepEqual(await places(page), before);
    const own = await page.locator('.notice button').count();
    assert.equal(own, 2);
    assert.deepEqual(await covered(page, controls.replaceAll(/(\w+)(?=,|$)/g, '$1:not(.notice *)')), []);
    // Each can be read and dismissed, although the place is small.
    await notices.nth(1).getByRole('button', { name: 'Dismiss' }).click();
    await notices.first().getByRole('button', { name: 'Dismiss' }).click();
    assert.equal(await notices.count(), 0);
    assert.deepEqual(await places(page), before);
    clean();
  });
