// Pinned runs: up to three references beside the present run, in the address, two of them on one clock.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { GAIN, Stage, ink, reachImpact, reachPhase, slide, speedUp, releaseTo } from './stage.js';

const stage = await Stage.open();

const pin = (page, name) => page.locator(`.pin[data-pin="${name}"]`);
const computed = (page, name) =>
  pin(page, name)
    .locator('.pin-words b', { hasText: /fell|survived|rest/ })
    .waitFor();

/** Sets the tilt gain by its slider, and pins the scene. */
async function pinGain(page, gain, name) {
  await slide(page, GAIN, gain);
  await page.waitForFunction((value) => location.search.includes(`tilt_gain=${value}`), gain);
  await page.click('#pin');
  await computed(page, name);
}

test('a pin keeps what a run was, beside a scene that goes on', async () => {
  const { page, clean } = await stage.page('?preset=case-3&tab=why');
  await page.click('#pin');
  await computed(page, 'A');
  const answer = await (await fetch(`${stage.url}v1/trajectories?preset=case-3&bounces=1000`)).json();
  const words = await pin(page, 'A').locator('.pin-words').innerText();
  const largest = Math.max(...answer.impacts.theta.map(Math.abs));
  assert.match(words, new RegExp(`κ 1\\.55, e 1: fell at bounce ${answer.outcome.bounces}`));
  assert.match(words, new RegExp(`largest θ ${Number(largest.toPrecision(3))}\\srad`));
  assert.match(words, /The scene is the same/);
  assert.ok((await ink(page, '#plane-angle', '--series-3')) > 10, 'its dots are in the plane');
  await slide(page, GAIN, 1.2);
  await pin(page, 'A').getByText('Differs in tilt gain').waitFor();
  clean();
});

test('three pins at most, none twice, and each can be removed, undone and done again', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  await pinGain(page, 1.2, 'A');
  await page.click('#pin');
  await page.locator('#pins-told', { hasText: 'pinned already, as A' }).waitFor();
  await pinGain(page, 1.3, 'B');
  await slide(page, GAIN, 1.4);
  await page.locator('#main').click({ position: { x: 2, y: 2 } });
  await page.keyboard.press('a');
  await computed(page, 'C');
  await slide(page, GAIN, 1.45);
  await page.waitForFunction(() => location.search.includes('tilt_gain=1.45'));
  await page.click('#pin');
  await page.locator('#pins-told', { hasText: 'Three runs at most' }).waitFor();
  await page.getByRole('button', { name: 'Remove B' }).click();
  assert.equal(await page.locator('.pin').count(), 2);
  await page.keyboard.press('Control+z');
  await computed(page, 'B');
  await page.waitForFunction(() => location.search.includes('pin.1.preset=case-1'));
  await page.keyboard.press('Control+y');
  await page.waitForFunction(() => document.querySelectorAll('.pin').length === 2);
  await page.click('#pin');
  await computed(page, 'B');
  assert.match(await pin(page, 'B').innerText(), /1\.45/);
  clean();
});

test('pins go round through the address, a kick on the way included', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2&tab=why');
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await releaseTo(page, 3);
  await page.locator('#exact input').fill('0.05');
  await page.getByRole('button', { name: 'Kick clockwise' }).click();
  await page.waitForFunction(() => /kick\.theta_dot=-0\.05/.test(location.search));
  await page.click('#pin');
  await computed(page, 'A');
  await page.waitForFunction(() => /pin\.0\.interventions\.0\.kick\.theta_dot=-0\.05/.test(location.search));
  const search = new URLSearchParams(await page.evaluate(() => location.search));
  const keys = [...search.keys()].filter((key) => key.startsWith('pin.0.'));
  assert.deepEqual(keys.sort(), [
    'pin.0.interventions.0.impact',
    'pin.0.interventions.0.kick.theta_dot',
    'pin.0.preset',
    'pin.0.scene.release.theta',
  ]);
  const words = await pin(page, 'A').locator('.pin-words').innerText();
  assert.match(words, /with a change on the way/);
  const pins = new URLSearchParams([['preset', 'case-2'], ...[...search].filter(([key]) => key.startsWith('pin.'))]);
  const other = await stage.page(`?${pins}&tab=why`);
  await computed(other.page, 'A');
  const outcome = (text) => /e 1: ([^,]+), largest θ \S+/.exec(text)[0];
  assert.equal(outcome(await pin(other.page, 'A').locator('.pin-words').innerText()), outcome(words));
  await other.page.getByRole('button', { name: 'Bring back A' }).click();
  await other.page.waitForFunction(() =>
    /preset=case-1.*interventions\.0\.kick\.theta_dot=-0\.05/.test(location.search),
  );
  await reachImpact(other.page, 1);
  clean();
  other.clean();
});

test('a link with a broken pin says so and keeps the rest', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&pin.0.preset=nowhere&pin.1.preset=case-2&pin.7.preset=case-3&tab=why',
  );
  await computed(page, 'B');
  assert.equal(await page.locator('.pin').count(), 1);
  const notices = await page.locator('#notices').innerText();
  assert.match(notices, /of pin A: the case “nowhere”/);
  assert.match(notices, /“pin\.7\.preset”/);
  clean();
});

test('a swap brings the pinned run back and pins the present one', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  await pinGain(page, 1.3, 'A');
  await slide(page, GAIN, 1.2);
  await page.waitForFunction(() => /tilt_gain=1\.2/.test(location.search));
  await page.getByRole('button', { name: 'Swap A' }).click();
  await page.locator('.pin-words', { hasText: 'κ 1.2' }).waitFor();
  assert.equal(await page.inputValue(GAIN), '1.3');
  await reachImpact(page, 1);
  clean();
});

test('a pin that would make the link too long is refused clearly', async () => {
  const vertices = Array.from({ length: 32 }, (_, index) => {
    const angle = -Math.PI / 2 + (2 * Math.PI * index) / 32;
    return [Math.cos(angle) * 0.1234567890123, Math.sin(angle) * 0.1234567890123];
  });
  const query = new URLSearchParams({ 'scene.release.height': '0.2', 'scene.table.tilt_gain': '1.1' });
  vertices.forEach(([x, y], index) => {
    query.set(`scene.body.vertices.${index}.0`, String(x));
    query.set(`scene.body.vertices.${index}.1`, String(y));
  });
  const { page } = await stage.page(`?${query}&tab=why`);
  await page.click('#pin');
  await page.locator('.pin').first().waitFor();
  await page.waitForFunction(() => location.search.includes('pin.0'));
  await slide(page, GAIN, 1.2);
  await page.waitForFunction(() => /(?<!pin\.0\.scene\.table\.)tilt_gain=1\.2/.test(location.search));
  await page.click('#pin');
  await page.locator('#pins-told', { hasText: /Not pinned: the link would have \d/ }).waitFor();
  assert.equal(await page.locator('.pin').count(), 1);
});

test('two runs that differ by 0.001 rad are dropped together and seen to part', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-3&scene.release.theta=0.101&pin.0.preset=case-3&pin.1.preset=case-3&pin.1.scene.release.theta=0.102&tab=why',
  );
  await computed(page, 'A');
  await computed(page, 'B');
  await speedUp(page);
  await page.click('#double-drop');
  await reachPhase(page, 'running');
  assert.equal(await pin(page, 'A').locator('.rod').getAttribute('aria-pressed'), 'true');
  await reachPhase(page, 'ended');
  await page.click('#to-now');
  await page.locator('#scrub').focus();
  await page.keyboard.press('Home');
  await page.waitForFunction(() => /differ by 0\.001\s/.test(document.querySelector('#drop-told').textContent));
  await page.keyboard.press('End');
  await page.waitForFunction(
    () => Number(/differ by (\S+?)\s/.exec(document.querySelector('#drop-told').textContent)?.[1]) > 0.01,
  );
  assert.ok((await ink(page, '.parting', '--accent')) > 20, 'the curve of the distance');
  // Two pins: the first is the run, the second beside it.
  await page.selectOption('#drop-pair', 'A B');
  await page.click('#double-drop');
  await page.waitForFunction(() => /B and the run differ by/.test(document.querySelector('#drop-told').textContent));
  assert.equal(await page.inputValue('#case'), 'case-3');
  assert.equal(await pin(page, 'A').locator('.rod').getAttribute('aria-pressed'), 'false');
  clean();
});
