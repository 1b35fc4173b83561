// A fall is seen: the body goes on to the ground, the page says why, and the last strikes can be seen once more, slowly.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, drawn, reachPhase, speedUp } from './stage.js';

const stage = await Stage.open();
const FALLS = '?preset=case-3&scene.release.theta=0.3';

/** The time of the scene, s. */
const time = (page) =>
  page.locator('#timeline-told').evaluate((told) => Number(/([\d.]+)\ss/.exec(told.textContent)?.[1] ?? NaN));

/** Waits until the body lies on the ground, below the table. */
const lies = (page) =>
  page.waitForFunction(
    () =>
      Number(/y\s(\S+)\sm/.exec(document.querySelector('#scene-readout').textContent)?.[1].replace('−', '-')) < -0.02,
  );

test('a fall goes to the ground and is told; Slow motion shows its last three strikes, Again drops it anew; nothing jumps', async () => {
  const { page, clean } = await stage.page(FALLS);
  const places = () =>
    page.evaluate(() =>
      ['#scrub', '#run', '#to-now', '#map-box'].map((id) => {
        const { left, top, width } = document.querySelector(id).getBoundingClientRect();
        return [left, top + scrollY, width].map(Math.round);
      }),
    );
  await page.locator('#map-box').waitFor();
  await page.click('#run');
  await page.locator('#timeline-told', { hasText: /n\s[1-9]/ }).waitFor();
  const before = await places();
  await reachPhase(page, 'ended');
  const { outcome } = await (await fetch(`${stage.url}v1/trajectories${FALLS}&bounces=500`)).json();
  const told = new RegExp(`^Fell at bounce ${outcome.bounces}: .*\\w\\.`);
  assert.match(await page.locator('.ending.fell p').innerText(), told);
  assert.match(
    await page.locator('#verdict .headline.fell').innerText(),
    new RegExp(`Fell at bounce ${outcome.bounces}`),
  );
  await lies(page);
  assert.deepEqual(await places(), before);
  assert.equal(await page.locator('#run').innerText(), 'Run again');

  await page.click('#slow');
  const slowly = page.locator('#timeline-told', { hasText: 'at a tenth of the speed' });
  await slowly.waitFor();
  assert.match(await slowly.innerText(), new RegExp(`^n\\s${outcome.bounces - 2}\\s`));
  assert.deepEqual(await places(), before);
  const [from, begun] = [await time(page), Date.now()];
  await page.waitForFunction(
    (t) => Number(/([\d.]+)\ss/.exec(document.querySelector('#timeline-told').textContent)?.[1]) > t + 0.04,
    from,
  );
  const pace = ((await time(page)) - from) / ((Date.now() - begun) / 1000);
  assert.ok(pace < 0.2, `${pace} times real time`);
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();
  assert.ok(Math.abs((await time(page)) - outcome.t) < 0.01);
  await lies(page);
  // Once more, and stopped on the way.
  await page.click('#to-now');
  await slowly.waitFor();
  await page.click('#to-now');
  await page.locator('#to-now', { hasText: 'Replay the fall' }).waitFor();

  await page.click('#again');
  await page.locator('.ending').waitFor({ state: 'hidden' });
  await reachPhase(page, 'ended');
  clean();
});

test('where motion is unwanted the body lies at once, and so it does of a run that ended long ago', async () => {
  const { page, clean } = await stage.page(FALLS, { reducedMotion: 'reduce' });
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await page.click('#run');
  await reachPhase(page, 'ended');
  await lies(page);
  await drawn(page);
  const picture = () => page.locator('#scene-frame canvas').evaluate((canvas) => canvas.toDataURL());
  const at = await picture();
  await page.waitForTimeout(300);
  assert.equal(await picture(), at);
  await page.click('#slow');
  await page.locator('#timeline-told', { hasText: 'at a tenth of the speed' }).waitFor();
  clean();
  const past = await stage.page(`${FALLS}&epoch_ms=${Date.now() - 3600_000}`);
  await reachPhase(past.page, 'ended');
  await lies(past.page);
  await past.page.locator('.ending.fell').waitFor();
  past.clean();
});
