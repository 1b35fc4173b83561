// The time line: the past of a run is scrubbed, stepped through and played, without the server.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  GAIN,
  Stage,
  changeUnderWay,
  impacts,
  numbers,
  pausedRun,
  reachImpact,
  reachPhase,
  slide,
  speedUp,
  poseOf,
  releaseTo,
} from './stage.js';

const stage = await Stage.open();

/** A paused run of case 1 with so many impacts. */
const paused = (n, query = '?preset=case-1', options = {}) => pausedRun(stage, query, n, options);

/** The impact that the angle plane marks. */
const marked = impacts;

const told = (page) => page.locator('#timeline-told').innerText();

test('scrubbing back draws the flight in closed form and asks nothing of the server', async () => {
  const { page, clean } = await paused(12);
  const asked = [];
  page.on('request', (request) => {
    if (/\/v1\/(live|trajectories)/.test(request.url())) asked.push(request.url());
  });
  const box = await page.locator('#scrub').boundingBox();
  const last = await marked(page);
  await page.mouse.move(box.x + box.width * 0.9, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.4, box.y + box.height / 2, { steps: 6 });
  await page.mouse.up();
  await page.waitForFunction(
    (n) => Number(/^n\s(\d+)/.exec(document.querySelector('#plane-angle .readout').textContent)?.[1]) < n,
    last,
  );
  const { t, n, theta, x, y } = await poseOf(page);
  const { impacts: all, scene } = await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=100`)).json();
  const [before, after] = [n - 1, n];
  assert.ok(n >= 2 && n < last, `${n} lies in the past`);
  assert.ok(all.t[before] <= t + 5e-5 && t <= all.t[after] + 5e-5, `${t} lies between impacts ${n} and ${n + 1}`);
  const part = (t - all.t[before]) / (all.t[after] - all.t[before]);
  const even = (column) => column[before] + (column[after] - column[before]) * part;
  const l = scene.body.contact_distance;
  const [from, to] = [l * Math.cos(all.theta[before]), l * Math.cos(all.theta[after])];
  const height = from + (to - from) * part + (scene.gravity / 2) * (t - all.t[before]) * (all.t[after] - t);
  assert.ok(Math.abs(theta - even(all.theta)) < 1e-3, `theta ${theta}, ${even(all.theta)}`);
  assert.ok(Math.abs(x - even(all.x)) < 1e-3, `x ${x}, ${even(all.x)}`);
  assert.ok(Math.abs(y - height) < 1e-3, `y ${y}, ${height}`);
  assert.equal(await marked(page), n, 'the planes mark the shown impact');
  assert.match(await told(page), new RegExp(`^n\\s${n}\\s`));
  assert.deepEqual(asked, [], 'no request');
  clean();
});

test('stepping back goes from strike to strike, the past plays and holds, and stepping on comes back to now', async () => {
  const { page, clean } = await paused(6);
  const last = await marked(page);
  await page.click('#step-back');
  assert.equal((await poseOf(page)).n, last);
  for (const n of [last - 1, last - 2]) {
    await page.click('#step-back');
    await page.locator('#timeline-told', { hasText: new RegExp(`n\\s${n}\\s`) }).waitFor();
    await page.locator('#plane-angle .readout', { hasText: new RegExp(`^n\\s${n}\\b`) }).waitFor({ state: 'attached' });
  }
  assert.equal(await page.locator('#run').innerText(), 'Play');
  await page.click('#step');
  await page.locator('#timeline-told', { hasText: new RegExp(`n\\s${last - 1}\\s`) }).waitFor();
  // The past plays at the speed of the run, and holds.
  await page.locator('#scrub').focus();
  await page.keyboard.press('Home');
  await page.click('#run');
  assert.equal(await page.locator('#run').innerText(), 'Pause');
  await page.waitForFunction(() => /^n\s[2-9]/.test(document.querySelector('#timeline-told').textContent));
  await page.locator('#scrub').focus();
  await page.keyboard.press('End');
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await page.locator('#run').innerText(), 'Play');
  await page.click('#step');
  await page.click('#step');
  // In the present it is the run itself that steps.
  assert.equal(await page.locator('#run').innerText(), 'Resume');
  await page.click('#step');
  await reachImpact(page, last + 1);
  clean();
});

test('the run goes on while its past is shown, and Back to now shows it again', async () => {
  const { page, clean } = await stage.page('?preset=case-2');
  await page.locator('#scrub').waitFor();
  await releaseTo(page, 3);
  assert.equal(await page.locator('#to-now').getAttribute('aria-disabled'), 'true');
  await page.locator('#scrub').focus();
  await page.keyboard.press('Home');
  await page.locator('#timeline-told', { hasText: /n\s0\s/ }).waitFor();
  assert.equal(await page.locator('#to-now').innerText(), 'Back to now');
  const before = (await numbers(page, 'plane-angle')).length;
  await numbers(page, 'plane-angle', before + 3);
  assert.match(await told(page), /^n\s0\s/, 'the past stands still');
  await reachPhase(page, 'running');
  await page.click('#to-now');
  assert.equal(await page.locator('#to-now').innerText(), 'Now');
  await reachImpact(page, before + 3);
  clean();
});

test('keys on the bar go by one strike, by ten, to the release and to now', async () => {
  const { page, clean } = await paused(25);
  const last = await marked(page);
  const bar = page.locator('#scrub');
  await bar.focus();
  const shows = (n) => page.locator('#timeline-told', { hasText: new RegExp(`n\\s${n}\\s`) }).waitFor();
  await page.keyboard.press('ArrowLeft');
  await shows(last);
  await page.keyboard.press('ArrowLeft');
  await shows(last - 1);
  await page.keyboard.press('PageDown');
  await shows(last - 11);
  assert.match(await bar.getAttribute('aria-valuetext'), new RegExp(`^bounce ${last - 11}, `));
  await page.keyboard.press('ArrowRight');
  await shows(last - 10);
  await page.keyboard.press('PageUp');
  await shows(last);
  await page.keyboard.press('Home');
  await shows(0);
  assert.equal(await bar.getAttribute('aria-valuenow'), '0.00');
  await page.keyboard.press('End');
  assert.equal(await page.locator('#to-now').innerText(), 'Now');
  // The page's own keys: back by a strike, on by one, to now.
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press(',');
  await page.keyboard.press(',');
  await shows(last - 1);
  await page.keyboard.press('.');
  await shows(last);
  await page.keyboard.press('n');
  assert.equal(await page.locator('#to-now').innerText(), 'Now');
  clean();
});

test('a finger drags the bar', async () => {
  const { page, context, clean } = await paused(12, '?preset=case-1', {
    hasTouch: true,
    viewport: { width: 390, height: 844 },
  });
  await page.locator('#scrub').scrollIntoViewIfNeeded();
  const last = await marked(page);
  const { x, y, width, height } = await page.locator('#scrub').boundingBox();
  assert.ok(width > 150, `${width} px to drag along`);
  const touch = await context.newCDPSession(page);
  const at = (share) => [{ x: x + width * share, y: y + height / 2 }];
  await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: at(0.9) });
  for (const share of [0.8, 0.6, 0.3])
    await touch.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: at(share) });
  await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  const { n } = await poseOf(page);
  assert.ok(n > 0 && n < last - 3, `impact ${n} of ${last}`);
  clean();
});

test('kicks, changes and the end of the run are marked', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2');
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await releaseTo(page, 3);
  await page.getByRole('button', { name: 'Kick to the left' }).click();
  await page.waitForFunction(() => /kick\.x_dot=-0\.1/.test(location.search));
  await changeUnderWay(page);
  await slide(page, GAIN, 1.9);
  await page.waitForFunction(() => /tilt_gain=1\.9/.test(location.search));
  await reachPhase(page, 'ended');
  const query = new URLSearchParams(await page.evaluate(() => location.search));
  const [kick, change] = [0, 1].map((index) => Number(query.get(`interventions.${index}.impact`)));
  const marks = await page.locator('#timeline-moments').textContent();
  assert.match(marks, new RegExp(`Bounce ${kick}: kick −0\\.1\\sm/s ẋ`));
  assert.match(marks, new RegExp(`Bounce ${change}: tilt gain 1\\.9`));
  assert.match(marks, /Bounce \d+: the end of the run/);
  await page.locator('#scrub').focus();
  await page.keyboard.press('Home');
  for (let n = 1; n <= kick; n += 1) await page.keyboard.press('ArrowRight');
  await page.locator('#timeline-told', { hasText: 'kick −0.1' }).waitFor();
  clean();
});

test('a long run keeps its past in constant memory', async () => {
  const { page } = await stage.page('?preset=case-1');
  const sizes = await page.evaluate(async () => {
    const { COLUMNS, Impacts } = await import('./run/impacts.js');
    const kept = new Impacts();
    const impact = Object.fromEntries(COLUMNS.map((name) => [name, 1]));
    const bytes = () => COLUMNS.reduce((sum, name) => sum + kept.column(name).byteLength, 0);
    const sizes = [];
    for (const upTo of [1 << 16, 3 << 16]) {
      for (let n = kept.end + 1; n <= upTo; n += 1) kept.append({ ...impact, n, t: n / 10, flight_time: 0.1 });
      sizes.push([bytes(), kept.begin, kept.row(kept.begin).flight_time, kept.lastUpTo('t', kept.begin / 10 + 5)]);
    }
    return sizes;
  });
  assert.equal(sizes[0][0], sizes[1][0]);
  assert.ok(sizes[0][0] < 10e6, `${sizes[0][0]} bytes`);
  assert.deepEqual(sizes[1].slice(1), [2 << 16, 0.1, (2 << 16) + 49]);
});
