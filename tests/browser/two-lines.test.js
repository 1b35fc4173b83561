// The two lines of the verdict: on the setting, which rests on a fresh release, and on the run that is seen.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { GAIN, Stage, changeUnderWay, enter, reachPhase, slide, speedUp, verdict, plain, releaseTo } from './stage.js';

const stage = await Stage.open();

const thisRun = async (page) => plain(await page.locator('#this-run').innerText());

test('the setting stays up in plain words, with the field’s term and the evidence below', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  assert.match(await verdict(page), /Stays up\s+Elliptic; 2000 bounces of a fresh release survived/);
  assert.doesNotMatch(plain(await page.locator('#verdict-card').innerText()), /this run ended|_gain|\bnull\b/);
  await releaseTo(page, 2);
  assert.match(await thisRun(page), /^This run\s+Bounce \d+\s+Angle/);
  // Its place, which the words of an end take, tells how far it has gone.
  await page.click('#run');
  await reachPhase(page, 'paused');
  const n = Number(/Bounce (\d+)/.exec(await thisRun(page))[1]);
  const { impacts } = await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${n}`)).json();
  const told = (value) => String(Number(value.toPrecision(3)));
  const most = (values) => told(Math.max(...values.map(Math.abs)));
  const words = await thisRun(page);
  assert.ok(words.includes(`up to ${most(impacts.theta)} rad`), words);
  assert.ok(words.includes(`up to ${most(impacts.alpha)} rad`), words);
  assert.ok(words.includes(`${told(Math.min(...impacts.x))} to ${told(Math.max(...impacts.x))} m`), words);
  clean();
});

test('a run that falls says so in its own line, and nothing moves', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&scene.table.tilt_gain=1.49&tab=why');
  // All buttons of the scene's card are there.
  await page.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  const boxes = () =>
    page.evaluate(() =>
      ['#scene-frame', '#verdict-card', '#studies', '#controls', '#time'].map((selector) => {
        const { x, y, height } = document.querySelector(selector).getBoundingClientRect();
        return [selector, x, y, height];
      }),
    );
  const before = await boxes();
  await page.click('#run');
  await reachPhase(page, 'ended');
  const answer = await (
    await fetch(`${stage.url}v1/trajectories?preset=case-1&scene.table.tilt_gain=1.49&bounces=200`)
  ).json();
  assert.match(
    await thisRun(page),
    new RegExp(`^This run\\s+Fell at bounce ${answer.outcome.bounces}\\s+The table struck too steeply\\.\\s+Details`),
  );
  assert.deepEqual(await boxes(), before, 'nothing jumps when it ends');
  const details = page.locator('#this-run details');
  assert.equal(await details.evaluate((element) => element.open), false);
  await details.locator('summary').click();
  assert.match(await thisRun(page), /does not rise again/);
  clean();
});

test('a fall after a kick leaves the verdict on the setting as it was', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.05&tab=why');
  assert.match(await verdict(page), /Stays up/);
  await speedUp(page);
  await releaseTo(page, 4);
  await page.locator('#exact input').fill('4');
  await page.click('#kick');
  await page.waitForFunction(() => /kick\.theta_dot=4/.test(location.search));
  const at = await page.evaluate(() => new URLSearchParams(location.search).get('interventions.0.impact'));
  await reachPhase(page, 'ended');
  assert.match(await thisRun(page), new RegExp(`Fell at bounce \\d+, after your kick at ${at}\\s`));
  // The line shows what is on the screen, the reasons what they are of.
  assert.match(await page.locator('#verdict .headline').innerText(), /^▲ Fell at bounce \d+$/);
  assert.match(await verdict(page), /Stays up\s+Elliptic; 2000 bounces of a fresh release survived/);
  clean();
});

test('a fall after a change names what was changed', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2&tab=why');
  await speedUp(page);
  await releaseTo(page, 4);
  await changeUnderWay(page);
  await slide(page, GAIN, 1.7);
  await reachPhase(page, 'ended');
  assert.match(await thisRun(page), /Fell at bounce \d+, after your change of tilt gain at \d+/);
  assert.match(await verdict(page), /Falls\s+Unstable; a fresh release fell at bounce \d+/);
  clean();
});

test('no verdict stands beside a scene that there is not, and its message leads to the field', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=why');
  const held = async () => {
    await page.locator('#verdict[aria-busy=false]', { hasText: /^– No verdict/ }).waitFor();
    assert.ok(await page.locator('#verdict-more').evaluate((more) => more.hidden));
  };
  const renewed = () => page.locator('#verdict[aria-busy=false] .headline.stable', { hasText: 'Stays up' }).waitFor();
  // A refused entry leaves the scene, and so the verdict on it, as it was.
  await enter(page, '#field-table-tilt_gain', 'much');
  assert.match(await verdict(page), /Stays up/);
  await enter(page, '#field-table-tilt_gain', '1.2');
  await renewed();
  // A value that only the server can refuse: so low that the rod would stand in the table.
  await enter(page, '#field-release-height', '0.01');
  await page.locator('#field-release-height').press('Tab');
  await held();
  await page.locator('#verdict .held button', { hasText: 'Height' }).click();
  await page.waitForFunction(() => document.activeElement.id === 'field-release-height');
  await enter(page, '#field-release-height', '0.2');
  await renewed();
  // The browser itself notes every refusal by the server.
  clean(/status of 422/);
});

for (const query of [
  'preset=case-1&scene.table.limits.tilt=0.1',
  'preset=case-3',
  'preset=case-1&scene.topple_angle=0.2',
])
  test(`an end has the words of the server's headline: ${query}`, async () => {
    const { page, clean } = await stage.page(`?${query}&speed=10&tab=why`);
    await page.click('#run');
    await reachPhase(page, 'ended');
    const { title } = await (await fetch(`${stage.url}v1/previews?${query}&format=json`)).json();
    const [, verb, bounce, reason] = /^(Falls|Comes to rest) at bounce (\d+): (.*)$/.exec(title);
    const words = await thisRun(page);
    const said = verb === 'Falls' ? 'Fell' : 'Stopped bouncing';
    assert.ok(words.includes(`${said} at bounce ${bounce}`), `${words} | ${title}`);
    assert.ok(words.toLowerCase().includes(reason), `${words} | ${title}`);
    clean();
  });
