// Evidence of the verdict beyond the linear map, compared with the server’s numbers.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, openTab, verdict, plain } from './stage.js';

const stage = await Stage.open();

const ask = async (query) => (await fetch(`${stage.url}v1/stability?${query}`)).json();
/** Numbers of a text, with what comes after them. */
const disclose = (page) => page.locator('.evidence:not([open]) summary').click();
/** What it says once it is opened, without its line for a first look. */
const words = async (page) => {
  // It comes after the verdict, with a module of its own.
  await page.locator('.evidence').waitFor();
  if ((await page.locator('.evidence:not([open])').count()) > 0) await disclose(page);
  return plain(await page.locator('.evidence dl').innerText());
};
const short = (value, digits = 4) => String(Number(value.toPrecision(digits)));

test('rotation, chaos and predictability are told with the server’s numbers', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=why');
  const { rotation_number: rotation, chaos } = await ask('preset=case-1');
  const told = await words(page);
  assert.ok(told.includes(`${short(rotation.measured)} turns a bounce`), told);
  assert.ok(told.includes(`small deviations ${short(rotation.small)}`), told);
  assert.ok(told.includes(`${rotation.resonance.p}/${rotation.resonance.q}`), told);
  assert.ok(
    told.includes('Regular') && told.includes(`MEGNO ${short(chaos.indicator, 3)} over ${chaos.bounces} bounces`),
    told,
  );
  assert.match(told, /For all 500 bounces watched/);
  clean();
});

test('a chaotic run says so, and for how long it can be predicted', async () => {
  // Released so far aside that the run wanders about between islands before it falls.
  const query = 'preset=case-1&scene.table.tilt_gain=1.15&scene.release.theta=0.365';
  const { page, clean } = await stage.judged(`?${query}&tab=why`);
  const { chaos, predictable_bounces: predictable } = await ask(query);
  assert.ok(chaos.chaotic && predictable > 0);
  const told = await words(page);
  assert.match(told, /Chaotic/);
  assert.ok(told.includes(`For ${predictable} bounces`), told);
  clean();
});

test('a line tells it for a first look, and what was opened stays open', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=why');
  const gist = async () => plain(await page.locator('.evidence summary').innerText());
  const { rotation_number: rotation, chaos } = await ask('preset=case-1');
  assert.equal(
    await gist(),
    `Regular · ${short(rotation.measured, 3)} turns a bounce · predictable ≥ ${chaos.bounces} bounces`,
  );
  assert.ok(!(await page.locator('.evidence dl').isVisible()));
  await disclose(page);
  await enter(page, '#field-table-tilt_gain', '1.375');
  await openTab(page, 'why');
  await page.locator('.evidence', { hasText: 'near 1/3' }).waitFor();
  assert.ok(await page.locator('.evidence dl').isVisible());
  clean();
});

test('a resonance nearby is named', async () => {
  const query = 'preset=case-1&scene.table.tilt_gain=1.375&scene.release.theta=0.02';
  const { page, clean } = await stage.judged(`?${query}&tab=why`);
  assert.match(await words(page), /Resonance\s+1\/3: the rotation number is within/);
  clean();
});

test('the basin is measured when somebody asks, and belongs to its scene', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  const asked = [];
  page.on('request', (request) => {
    if (request.url().includes('basin=true')) asked.push(request.url());
  });
  await verdict(page);
  assert.equal(asked.length, 0);
  await disclose(page);
  await page.click('#basin');
  await page.locator('.evidence', { hasText: 'Released at rest' }).waitFor();
  const { basin } = await ask('preset=case-1&basin=true');
  const told = await words(page);
  assert.ok(
    told.includes(
      `${basin.bounces} bounces from up to ${short(basin.unbroken)} rad (${short((basin.unbroken * 180) / Math.PI, 3)}°)`,
    ),
    told,
  );
  assert.ok(told.includes(`${basin.holes.length} gaps up to ${short(basin.theta)} rad`), told);
  assert.equal(asked.length, 1);
  await enter(page, '#field-table-tilt_gain', '1.2');
  await openTab(page, 'why');
  await page.locator('#basin').waitFor();
  assert.equal(asked.length, 1);
  clean();
});

test('a basin that cannot be asked for can be asked for again', async () => {
  const { page } = await stage.page('?preset=case-1&tab=why');
  await verdict(page);
  // All of the page is there before the server goes.
  await page.locator('#keys-list dt').first().waitFor({ state: 'attached' });
  await page.waitForLoadState('networkidle');
  await stage.stopServer();
  await disclose(page);
  await page.click('#basin');
  await page.locator('.evidence', { hasText: 'did not answer' }).waitFor();
  await stage.startServer();
  await page.click('#basin');
  await page.locator('.evidence', { hasText: 'Released at rest' }).waitFor();
});

test('a point mass has none of it', async () => {
  const { page, clean } = await stage.judged('?preset=point-mass&tab=why');
  assert.equal(await page.locator('.evidence').count(), 0);
  clean();
});
