// What follows a slider while it moves: verdict, facts, eigenvalues and the preview of a release.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { GAIN, Stage } from './stage.js';

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

/** The gain of the verdict, as the picture of its eigenvalues tells it. */
const gainIn = async (page) => Number(/κ\s([\d.]+)/.exec(await page.locator('#circle .readout').textContent())[1]);
const falls = (page) => page.locator('#verdict[aria-busy=false]', { hasText: 'Falls' }).waitFor();

test('verdict and preview follow a slider before it is let go, and dearer facts wait until it rests', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  await page.locator('#verdict .facts span').nth(1).waitFor();
  const kinds = {
    verdicts: /stability(?!.*(basin|budget|margins))/,
    previews: /trajectories.*bounces=200/,
    facts: /basin|budget|margins/,
  };
  const asked = { verdicts: [], previews: [], facts: [] };
  const open = { verdicts: 0, previews: 0, facts: 0 };
  let most = 0;
  for (const [kind, path] of Object.entries(kinds)) {
    const mine = (request) => path.test(request.url());
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
  await drag(page, GAIN, 1.1, 1.6, 50);
  await falls(page);
  const { verdicts, previews, facts } = asked;
  assert.ok(verdicts.length >= 3, `${verdicts.length} verdicts asked for while it moves`);
  assert.ok(verdicts.length < 50, 'not one for every move');
  assert.ok(facts.length < verdicts.length / 2, `${facts.length} facts`);
  assert.equal(most, 1, 'one request of a kind at a time');
  assert.equal(Number(await page.inputValue(GAIN)), 1.6);
  assert.equal(await gainIn(page), 1.6, 'the verdict is on the value of the slider');
  for (const urls of [verdicts, previews]) {
    assert.match(urls.at(-1), /tilt_gain=1\.6(&|$)/, 'the latest wins');
    assert.ok(
      urls.some((url) => !/tilt_gain=1\.6(&|$)/.test(url)),
      'asked for on the way',
    );
  }
  clean();
});

test('a slow answer for an old value is given up once the slider rests', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  let held = 0;
  await page.route('**/v1/stability?*tilt_gain=1.2*', async () => {
    // It never answers.
    held += 1;
  });
  await drag(page, GAIN, 1.1, 1.2, 1);
  while (held === 0) await page.waitForTimeout(20);
  await drag(page, GAIN, 1.2, 1.55, 4);
  await falls(page);
  assert.equal(await gainIn(page), 1.55);
  clean();
});
