// What follows a slider while it moves: verdict, eigenvalues and the preview of a release.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, verdict } from './stage.js';

const stage = await Stage.open();

/** Moves a slider through values without letting it go, one each frame or two. */
const drag = (page, selector, from, to, steps) =>
  page.locator(selector).evaluate(
    async (slider, [first, last, count]) => {
      for (let k = 1; k <= count; k += 1) {
        slider.value = String(first + ((last - first) * k) / count);
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        await new Promise((resolve) => setTimeout(resolve, 25));
      }
    },
    [from, to, steps],
  );

const gainIn = (page) => page.locator('.margin-value').innerText();
const settled = (page) =>
  page.waitForFunction(() => document.querySelector('#verdict[aria-busy=false] .verdict-words'));

for (const [slider, name] of [
  ['#gain', 'beside the scene'],
  ['[aria-label="Tilt gain, slider"]', 'of the form'],
])
  test(`verdict and preview follow the slider ${name} before it is let go`, async () => {
    const { page, clean } = await stage.page('?preset=case-1');
    await verdict(page);
    await page.locator(slider).waitFor();
    const asked = { stability: [], trajectories: [] };
    const open = { stability: 0, trajectories: 0 };
    let most = 0;
    for (const kind of Object.keys(asked)) {
      const mine = (request) => request.url().includes(`/v1/${kind}`);
      page.on('request', (request) => {
        if (!mine(request)) return;
        asked[kind].push(request.url());
        open[kind] += 1;
        most = Math.max(most, open[kind]);
      });
      for (const end of ['requestfinished', 'requestfailed'])
        page.on(end, (request) => {
          if (mine(request)) open[kind] -= 1;
        });
    }
    await drag(page, slider, 1.1, 1.6, 50);
    await settled(page);
    await page.waitForFunction(() => /Falls/.test(document.querySelector('.verdict-words').textContent));
    const value = await page.locator(slider).inputValue();
    assert.ok(asked.stability.length >= 3, `${asked.stability.length} verdicts asked for while it moves`);
    assert.ok(asked.stability.length < 50, 'not one for every move');
    assert.equal(most, 1, 'one request of a kind at a time');
    assert.equal(Number(value), 1.6);
    assert.match(await gainIn(page), /1\.6$/, 'the verdict is on the value of the slider');
    assert.match(await page.locator('#circle .readout').textContent(), /κ.1\.600/);
    for (const kind of Object.keys(asked)) {
      assert.match(asked[kind].at(-1), /tilt_gain=1\.6(&|$)/, 'the latest wins');
      assert.ok(
        asked[kind].some((url) => !/tilt_gain=1\.6(&|$)/.test(url)),
        `${kind} is asked for on the way`,
      );
    }
    assert.match(asked.trajectories.at(-1), /bounces=200/);
    clean();
  });

test('a slow answer for an old value is given up once the slider rests', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  let held = 0;
  await page.route('**/v1/stability?*tilt_gain=1.2*', async () => {
    // It never answers.
    held += 1;
  });
  await drag(page, '#gain', 1.1, 1.2, 1);
  while (held === 0) await page.waitForTimeout(20);
  await drag(page, '#gain', 1.2, 1.55, 4);
  await settled(page);
  assert.match(await verdict(page), /Falls/);
  assert.match(await gainIn(page), /1\.55$/);
  clean();
});

test('the basin is not asked for while a slider moves', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  const asked = [];
  page.on('request', (request) => {
    if (/basin=true/.test(request.url())) asked.push(request.url());
  });
  await drag(page, '#gain', 1.1, 1.3, 20);
  await settled(page);
  assert.deepEqual(asked, []);
  clean();
});
