// “What if from here”: a second run with another tilt gain parts from the run at the shown impact.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, ink, pausedRun, reachPhase, slide, speedUp, releaseTo } from './stage.js';

const stage = await Stage.open();

/** Shows an impact of the past. */
async function show(page, impact) {
  await page.locator('#scrub').focus();
  await page.keyboard.press('Home');
  for (let n = 1; n <= impact; n += 1) await page.keyboard.press('ArrowRight');
  await page.locator('#timeline-told', { hasText: new RegExp(`n\\s${impact}\\s`) }).waitFor();
}

/** The answer of the server to a fork at the fifth impact. */
const answer = async (gain) =>
  (
    await fetch(
      `${stage.url}v1/trajectories?preset=case-1&interventions.0.impact=6&interventions.0.set.table.tilt_gain=${gain}&bounces=305`,
    )
  ).json();

test('a fork asks for the run with another gain from here on, tells how it ends, and moves on the same clock', async () => {
  const { page, clean } = await pausedRun(stage, '?preset=case-1', 14);
  await show(page, 5);
  const asked = [];
  page.on('request', (request) => {
    if (/trajectories.*interventions/.test(request.url())) asked.push(new URL(request.url()).searchParams);
  });
  const before = await ink(page, '#plane-angle', '--measured');
  await page.click('#fork');
  await page.locator('#fork-told', { hasText: 'From bounce 5' }).waitFor();
  // Beyond the critical gain of 1.5, since the run itself is below.
  assert.ok(Number(await page.inputValue('#fork-gain')) > 1.5);
  const [query] = asked;
  assert.equal(query.get('preset'), 'case-1');
  assert.equal(query.get('interventions.0.impact'), '6');
  assert.equal(query.get('interventions.0.set.table.tilt_gain'), await page.inputValue('#fork-gain'));
  await slide(page, '#fork-gain', 1.9);
  const { outcome } = await answer(1.9);
  assert.notEqual(outcome.kind, 'completed');
  await page.locator('#fork-told', { hasText: `κ 1.9: fell at bounce ${outcome.bounces}` }).waitFor();
  await slide(page, '#fork-gain', 1.3);
  await page.locator('#fork-told', { hasText: 'κ 1.3: survives the next 300 bounces' }).waitFor();
  assert.equal((await answer(1.3)).outcome.kind, 'completed');
  await page.waitForFunction(() =>
    /what if κ/.test(document.querySelector('#plane-angle [role=application]').ariaLabel),
  );
  assert.ok((await ink(page, '#plane-angle', '--measured')) > before + 20, 'its dots are in the plane');
  // It plays by itself, so that they are seen to part.
  await page.waitForFunction(() => /n\s([89]|\d\d+)\s/.test(document.querySelector('#timeline-told').textContent));
  if ((await page.locator('#run').innerText()) === 'Pause') await page.click('#run');
  await show(page, 9);
  const picture = () =>
    page.evaluate(async () => {
      for (let frame = 0; frame < 3; frame += 1) await new Promise(requestAnimationFrame);
      return document.querySelector('#scene-frame canvas').toDataURL();
    });
  const both = await picture();
  assert.equal(await picture(), both, 'the past stands still');
  await page.click('#fork-close');
  assert.ok(await page.locator('#fork-box').isHidden());
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fork');
  assert.notEqual(await picture(), both, 'its rod has gone');
  clean();
});

test('a run that fell goes on in its fork', async () => {
  const { page, clean } = await stage.page('?preset=case-3&scene.release.theta=0.3', { reducedMotion: 'reduce' });
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await page.click('#run');
  await reachPhase(page, 'ended');
  const end = Number(await page.locator('#scrub').getAttribute('aria-valuemax'));
  await page.locator('#scrub').focus();
  for (let back = 0; back < 2; back += 1) await page.keyboard.press('ArrowLeft');
  await page.click('#fork');
  await slide(page, '#fork-gain', 1.2);
  await page.locator('#fork-told', { hasText: 'From bounce 2 with κ 1.2: survives' }).waitFor();
  await page.locator('#scrub').focus();
  await page.keyboard.press('ArrowLeft');
  await page.waitForFunction(
    (t) => Number(document.querySelector('#scrub').getAttribute('aria-valuemax')) > t + 1,
    end,
  );
  clean();
});

test('a table under state feedback has no gain to fork with', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&scene.table.tilt_gain=null&scene.table.feedback.theta=-2.9&scene.table.feedback.x=0.3&scene.table.feedback.x_dot=0.36&scene.table.feedback.theta_dot=-0.25',
  );
  await page.locator('#scrub').waitFor();
  await releaseTo(page, 1);
  assert.ok(await page.locator('#fork').isDisabled());
  clean();
});
