// A run whose bounces end goes on in contact: drawn by the server's hold, paused, scrubbed, thrown and replayed by its address.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, openPanel, openTab, reachPhase, slide, plain, poseOf } from './stage.js';

const stage = await Stage.open();
/** Bounces for 0.14 s; then the body slides and falls over by 0.39 s. */
const SETTLES = 'preset=still-lossy&scene.contact.restitution=0.1&scene.release.theta=0.1&scene.release.x_dot=0';
const trajectory = async (query) => (await fetch(`${stage.url}v1/trajectories?${query}&bounces=1000&hold=6`)).json();

/** Compares a drawn pose with the contact of the server: its moments are 10 ms apart, and the page draws a cubic between them. */
function assertHeld({ t, n, theta, x, y }, { hold, outcome, scene }) {
  assert.equal(n, outcome.bounces);
  const after = hold.t.findIndex((one) => one >= t - 5e-5);
  assert.ok(after >= 0 && t >= hold.t[0] - 5e-5, `${t} lies in the contact`);
  const near = (column, value, room) => {
    const both = [column[Math.max(0, after - 1)], column[after]];
    assert.ok(value >= Math.min(...both) - room && value <= Math.max(...both) + room, `${value} in ${both}`);
  };
  near(hold.theta, theta, 1e-3);
  near(hold.x, x, 1e-3);
  // The contact point stays on the table.
  assert.ok(Math.abs(y - scene.body.contact_distance * Math.cos(theta)) < 1e-4, `y ${y}`);
}

const told = async (page) => plain(await page.locator('#timeline-told').innerText());

test('the run goes on in contact up to its end, which the time line has', async () => {
  const run = await trajectory(SETTLES);
  assert.equal(run.hold_end.kind, 'toppled');
  const { page, clean } = await stage.page(`?${SETTLES}&speed=0.5`);
  await page.click('#run');
  await reachPhase(page, 'ended');
  const end = await poseOf(page);
  assert.ok(Math.abs(end.t - run.hold_end.t) < 1e-4, `${end.t}, ${run.hold_end.t}`);
  assert.ok(Math.abs(end.theta - run.hold.theta.at(-1)) < 1e-3);
  assertHeld(end, run);
  assert.match(await told(page), new RegExp(`^n ${run.outcome.bounces} · 0\\.${run.hold_end.t.toFixed(2).slice(2)} s`));
  // The headline says what the contact did, and the body has fallen.
  const headline = plain(await page.locator('#outcome .headline').innerText());
  assert.equal(headline, `Stopped bouncing and fell over after bounce ${run.outcome.bounces}`);
  assert.equal(await page.locator('#outcome .run-reason').innerText(), 'Its bounces died out; then it tipped over.');
  assert.match(await page.locator('#this-run .headline').getAttribute('class'), /\bfell\b/);
  await openTab(page, 'why');
  await page.locator('#outcome summary').click();
  assert.match(plain(await page.locator('#outcome p.muted').innerText()), /the bounces end at .*; then at t = /);
  // Scrubbed into the contact, and back to the last bounce.
  const box = await page.locator('#scrub').boundingBox();
  const [settled, last] = [run.outcome.settle_time, run.hold_end.t];
  const share = (settled + 0.6 * (last - settled)) / last;
  await page.mouse.click(box.x + 9 + (box.width - 18) * share, box.y + box.height / 2);
  const scrubbed = await poseOf(page);
  assert.ok(scrubbed.t > settled && scrubbed.t < last, `${scrubbed.t}`);
  assertHeld(scrubbed, run);
  assert.doesNotMatch(await told(page), /the end of the run/);
  await page.click('#step-back');
  assert.ok(Math.abs((await poseOf(page)).t - run.outcome.t) < 1e-4);
  // The address names the run, and the contact belongs to it.
  assert.ok(!page.url().includes('hold='), page.url());
  const second = await stage.page(new URL(page.url()).search);
  await reachPhase(second.page, 'ended');
  assert.deepEqual(await poseOf(second.page), end);
  second.clean();
  // An address of the API may name another time in contact.
  const shorter = await stage.page(`?${SETTLES}&hold=0.05&speed=20`);
  await reachPhase(shorter.page, 'ended');
  assert.ok(Math.abs((await poseOf(shorter.page)).t - settled - 0.05) < 1e-4);
  assert.match(shorter.page.url(), /[?&]hold=0\.05(&|$)/);
  shorter.clean();
  clean();
});

test('in contact it is paused, joined by its address, and thrown', async () => {
  const query = SETTLES.replace('theta=0.1', 'theta=0.001');
  const run = await trajectory(query);
  const { page, clean } = await stage.page(`?${query}&speed=0.05`);
  await openPanel(page, 'catch');
  await page.click('#run');
  await page.locator('#catch-live-told', { hasText: 'The table holds the body' }).waitFor();
  await page.click('#run');
  await reachPhase(page, 'paused');
  const paused = await poseOf(page);
  assertHeld(paused, run);
  await page.waitForFunction(() => /clock\.0\.speed=0/.test(location.search));
  const second = await stage.page(new URL(page.url()).search);
  await reachPhase(second.page, 'paused');
  assert.deepEqual(await poseOf(second.page), paused);
  second.clean();
  await page.fill('#catch-height', '0.5');
  await page.click('#catch-throw');
  await page.waitForFunction(() => /interventions\.0\.throw\.t=/.test(location.search));
  await page.click('#run');
  await slide(page, '#speed', 75);
  const n = run.outcome.bounces;
  await page.waitForFunction(
    (bounces) => Number(/bounce\s(\d+)/.exec(document.querySelector('#scene-readout').textContent)?.[1]) > bounces,
    n,
  );
  const thrown = await page.evaluate(() => new URLSearchParams(location.search).get('interventions.0.impact'));
  assert.equal(Number(thrown), n + 1);
  clean();
});
