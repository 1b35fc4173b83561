// A whole run in the page: from the case to a verdict that turns.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  GAIN,
  Stage,
  changeUnderWay,
  enter,
  impacts,
  ink,
  inkOf,
  numbers,
  reachImpact,
  reachPhase,
  showChart,
  slide,
  speedUp,
  verdict,
  runTo,
  releaseTo,
} from './stage.js';

const stage = await Stage.open();

test('case 1 runs, its impacts arrive, and a gain beyond the critical one turns the verdict', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  assert.match(await verdict(page), /elliptic/i);
  assert.equal(await ink(page, '#plane-angle', '--series-0'), 0);
  await page.click('#run');
  await speedUp(page);
  await reachImpact(page, 10);
  await reachPhase(page, 'running');
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > 20, 'the angle plane has dots');
  assert.ok((await ink(page, '#plane-velocity', '--series-0')) > 20, 'the velocity plane has dots');
  assert.ok((await ink(page, '#energy', '--series-0')) > 20, 'the energy plot has dots');
  const dial = page.locator('#circle svg.figure');
  await dial.waitFor();
  assert.ok((await dial.locator('circle').count()) >= 4, 'the circle has its eigenvalues');
  assert.ok((await ink(page, '#scene-frame', '--accent')) > 200, 'the scene has its table');
  await changeUnderWay(page);
  await slide(page, GAIN, 1.55);
  await page.waitForFunction(
    () =>
      document.querySelector('#verdict[aria-busy=false]') &&
      /unstable/i.test(document.querySelector('.verdict-words').textContent),
  );
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.55');
  await page.waitForFunction(() => /interventions\.0\.set\.table\.tilt_gain=1\.55/.test(location.search));
  await reachPhase(page, 'ended');
  assert.match(await page.locator('#outcome').innerText(), /\d/);
  assert.ok((await ink(page, '#plane-angle', '--series-1')) > 5, 'impacts with the new gain have their own colour');
  clean();
});

test('what is drawn is what the server computes', async () => {
  const { page, clean } = await stage.page('?preset=case-4');
  await speedUp(page);
  await runTo(page, 12);
  const answer = await (await fetch(`${stage.url}v1/trajectories?preset=case-4&bounces=200`)).json();
  const rows = await numbers(page, 'plane-angle');
  assert.ok(rows.length >= 12);
  for (const [n, t, theta, spin, alpha] of rows) {
    const at = answer.impacts.n.indexOf(Number(n));
    const value = (text) => Number(text.replace('\u2212', '-'));
    assert.ok(Math.abs(value(t) - answer.impacts.t[at]) <= 0.5001e-4, `t of impact ${n}`);
    assert.ok(Math.abs(value(theta) - answer.impacts.theta[at]) <= 0.5001e-6, `theta of impact ${n}`);
    assert.ok(Math.abs(value(spin) - answer.impacts.theta_dot[at]) <= 0.5001e-6, `theta_dot of impact ${n}`);
    assert.ok(Math.abs(value(alpha) - answer.impacts.alpha[at]) <= 0.5001e-6, `alpha of impact ${n}`);
  }
  clean();
});

test('pause holds the run, step moves it by one impact, a kick is in the address, restart begins again', async () => {
  const { page, clean } = await stage.page('?preset=case-2');
  await runTo(page, 3);
  await page.waitForTimeout(300);
  const held = await impacts(page);
  await page.waitForTimeout(600);
  assert.equal(await impacts(page), held);
  await page.click('#step');
  await reachImpact(page, held + 1);
  await page.click('#step');
  await reachImpact(page, held + 2);
  assert.equal(await impacts(page), held + 2);
  await releaseTo(page, held + 4);
  // Some kicks make the body fall within a second, and then there is nothing to kick.
  await page.click('#run');
  await reachPhase(page, 'paused');
  await page.locator('#exact input').fill('much');
  await page.click('#kick');
  assert.match(await page.locator('#kick-by-error').innerText(), /not a number/);
  await page.locator('#exact input').fill('0.01');
  await page.click('#kick');
  await page.waitForFunction(() => /kick\.theta_dot=0\.01/.test(location.search));
  await page.click('#restart');
  await page.waitForFunction(
    (before) =>
      Number(/^n\s(\d+)/.exec(document.querySelector('#plane-angle .readout').textContent)?.[1] ?? 0) < before,
    held,
  );
  await reachImpact(page, 1);
  await reachPhase(page, 'running');
  clean();
});

test('an edit drops the body anew; with a run under way it waits for what its table cannot change', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  await releaseTo(page, 2);
  const epoch = () => page.evaluate(() => new URLSearchParams(location.search).get('epoch_ms'));
  const before = await epoch();
  await enter(page, '#field-release-theta', '0.05');
  await page.waitForFunction(
    (old) => ![old, null].includes(new URLSearchParams(location.search).get('epoch_ms')),
    before,
  );
  await page.waitForFunction(() => /scene\.release\.theta=0\.05/.test(location.search));
  await reachImpact(page, 1);
  const rows = await numbers(page, 'plane-angle');
  assert.equal(Math.abs(Number(rows.at(-1)[2].replace('\u2212', '-'))), 0.05);
  await page.click('#tab-values');
  await page.check('#under-way');
  const dropped = await epoch();
  await enter(page, '#field-release-theta', '0.06');
  await page.locator('#restart.attention').waitFor();
  assert.equal(await page.locator('#restart').getAttribute('aria-label'), 'Restart with changes');
  assert.equal(await epoch(), dropped);
  await page.click('#restart');
  await page.locator('#restart:not(.attention)').waitFor();
  await page.waitForFunction(() => /scene\.release\.theta=0\.06/.test(location.search));
  clean();
});

test('a server that goes away and comes back loses no impact, and what was typed meanwhile is made up for', async () => {
  const { page } = await stage.page('?preset=case-1&tab=values');
  await verdict(page);
  await page.check('#under-way');
  await releaseTo(page, 3);
  await stage.stopServer();
  await page.locator('.notice', { hasText: 'Connection lost' }).waitFor();
  await page.locator('.countdown', { hasText: /\d s/ }).waitFor();
  const before = await impacts(page);
  await enter(page, '#field-table-tilt_gain', '1.2');
  await page.locator('#verdict', { hasText: 'The connection to the server is lost' }).waitFor();
  // Long enough for a try to fail.
  await page.waitForTimeout(1500);
  await stage.startServer();
  await reachPhase(page, 'running');
  await page.locator('.notice', { hasText: 'Connection lost' }).waitFor({ state: 'detached' });
  await page.waitForFunction(() => /interventions\.0\.set\.table\.tilt_gain=1\.2/.test(location.search));
  await page.locator('#verdict-more', { hasText: 'decided by' }).waitFor({ state: 'attached' });
  assert.equal(await page.locator('#restart').getAttribute('aria-label'), 'Restart');
  await reachImpact(page, before + 6);
  const seen = (await numbers(page, 'plane-angle')).map(([n]) => Number(n));
  assert.deepEqual(
    seen,
    seen.map((_, index) => seen[0] - index),
    'every number once',
  );
});

test('a server that comes back between a try and the question why it failed is not given up', async () => {
  const { page } = await stage.page('?preset=case-1', {
    prepare: () => {
      const real = globalThis.fetch;
      globalThis.asked = 0;
      globalThis.fetch = (input, init) => {
        if (!String(input).startsWith('v1/live?')) return real(input, init);
        globalThis.asked += 1;
        // As the server answers that is there again by the third question.
        return globalThis.asked === 3 ? Promise.resolve(new Response('{}', { status: 426 })) : real(input, init);
      };
    },
  });
  await releaseTo(page, 2);
  await stage.stopServer();
  await page.waitForFunction(() => globalThis.asked === 3);
  await stage.startServer();
  await page.getByRole('button', { name: 'Try now' }).click();
  await reachPhase(page, 'running');
  await reachImpact(page, 4);
});

test('the point mass runs with what it has', async () => {
  const { page, clean } = await stage.page('?preset=point-mass');
  await page.click('#run');
  await page.waitForFunction(() => /bounce\s[1-9]/.test(document.querySelector('#scene-readout').textContent));
  assert.ok(await page.locator('#field-body-contact_distance').isDisabled());
  clean();
});

test('without frames, as in a hidden tab, nothing is drawn, and all of it on return', async () => {
  const { page, clean } = await stage.page('?preset=case-1', {
    prepare: () => {
      const frame = requestAnimationFrame.bind(globalThis);
      const held = [];
      globalThis.hide = () => {
        globalThis.requestAnimationFrame = (callback) => held.push(callback);
      };
      globalThis.show = () => {
        globalThis.requestAnimationFrame = frame;
        for (const callback of held.splice(0)) frame(callback);
      };
      globalThis.heldFrames = () => held.length;
      globalThis.heard = 0;
      const Socket = WebSocket;
      globalThis.WebSocket = class extends Socket {
        set onmessage(listener) {
          super.onmessage = (event) => {
            globalThis.heard += 1;
            listener(event);
          };
        }
      };
    },
  });
  await showChart(page, 'plane-angle');
  const dotsOf = () => inkOf(page.locator('#plane-angle canvas').first(), '--series-0');
  await speedUp(page);
  await releaseTo(page, 3);
  await page.evaluate(() => globalThis.hide());
  // Polled by time, since there are no frames to poll by.
  const wait = (condition, argument) => page.waitForFunction(condition, argument, { polling: 50 });
  await wait(() => globalThis.heldFrames() > 0);
  const dots = await dotsOf();
  const before = await page.evaluate(() => globalThis.heard);
  await wait((from) => globalThis.heard >= from + 8, before);
  assert.equal(await dotsOf(), dots, 'nothing was drawn');
  assert.equal(await page.evaluate(() => globalThis.heldFrames()), 1, 'one frame waits, however much there is to draw');
  await page.evaluate(() => globalThis.show());
  await reachImpact(page, 11);
  assert.ok((await dotsOf()) > dots);
  clean();
});
