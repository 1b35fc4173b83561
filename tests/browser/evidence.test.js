// Evidence of the verdict beyond the linear map, compared with the server’s numbers.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, verdict } from './stage.js';

const stage = await Stage.open();

const ask = async (query) => (await fetch(`${stage.url}v1/stability?${query}`)).json();
/** Numbers of a text, with what comes after them. */
const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');
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
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  const { rotation_number: rotation, chaos } = await ask('preset=case-1');
  const told = await words(page);
  assert.ok(told.includes(`${short(rotation.measured)} turns a bounce`), told);
  assert.ok(told.includes(`small deviations ${short(rotation.small)}`), told);
  assert.ok(told.includes(`${rotation.resonance.p}/${rotation.resonance.q}`), told);
  assert.ok(
    told.includes('Regular') && told.includes(`MEGNO ${short(chaos.indicator, 3)} over ${chaos.bounces} impacts`),
    told,
  );
  assert.match(told, /For all 500 impacts watched/);
  clean();
});

test('a chaotic run says so, and for how long it can be predicted', async () => {
  // Released so far aside that the run wanders about between islands before it falls.
  const query = 'preset=case-1&scene.table.tilt_gain=1.15&scene.release.theta=0.365';
  const { page, clean } = await stage.page(`?${query}`);
  await verdict(page);
  const { chaos, predictable_bounces: predictable } = await ask(query);
  assert.ok(chaos.chaotic && predictable > 0);
  const told = await words(page);
  assert.match(told, /Chaotic/);
  assert.ok(told.includes(`For ${predictable} impacts`), told);
  clean();
});

test('a line tells it for a first look, and what was opened stays open', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  const gist = async () => plain(await page.locator('.evidence summary').innerText());
  const { rotation_number: rotation, chaos } = await ask('preset=case-1');
  assert.equal(
    await gist(),
    `Regular · ${short(rotation.measured, 3)} turns a bounce · predictable ≥ ${chaos.bounces} impacts`,
  );
  assert.ok(!(await page.locator('.evidence dl').isVisible()));
  await disclose(page);
  await enter(page, '#field-table-tilt_gain', '1.375');
  await page.locator('.evidence', { hasText: 'near 1/3' }).waitFor();
  assert.ok(await page.locator('.evidence dl').isVisible());
  clean();
});

test('at 1280 × 860 scene, verdict, planes and eigenvalues are seen at once', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  for (const selector of [
    '#scene-frame',
    '#controls',
    '#verdict',
    '#plane-angle canvas',
    '#plane-velocity canvas',
    '#circle svg.figure',
  ]) {
    const box = await page.locator(selector).first().boundingBox();
    assert.ok(box.y >= 0 && box.y + box.height <= 860, `${selector} ends at ${box.y + box.height} px`);
  }
  clean();
});

test('a resonance nearby is named', async () => {
  const query = 'preset=case-1&scene.table.tilt_gain=1.375&scene.release.theta=0.02';
  const { page, clean } = await stage.page(`?${query}`);
  await verdict(page);
  assert.match(await words(page), /Resonance\s+1\/3: the rotation number is within/);
  clean();
});

test('the basin is measured when somebody asks, and belongs to its scene', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
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
      `${basin.bounces} impacts from up to ${short(basin.unbroken)} rad (${short((basin.unbroken * 180) / Math.PI, 3)}°)`,
    ),
    told,
  );
  assert.ok(told.includes(`${basin.holes.length} gaps up to ${short(basin.theta)} rad`), told);
  assert.equal(asked.length, 1);
  await enter(page, '#field-table-tilt_gain', '1.2');
  await page.locator('#basin').waitFor();
  assert.equal(asked.length, 1);
  clean();
});

test('a basin that cannot be asked for can be asked for again', async () => {
  const { page } = await stage.page('?preset=case-1');
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
  const { page, clean } = await stage.page('?preset=point-mass');
  await verdict(page);
  assert.equal(await page.locator('.evidence').count(), 0);
  clean();
});

test('the budget of errors is computed when somebody asks', async () => {
  const query = 'preset=case-1&scene.table.length=1&scene.release.theta=0.05&scene.table.errors.tilt_gain=0.02';
  const { page, clean } = await stage.page(`?${query}`);
  const asked = [];
  page.on('request', (request) => {
    if (request.url().includes('budget=true')) asked.push(request.url());
  });
  await verdict(page);
  await page.locator('.budget summary').click();
  assert.equal(asked.length, 0);
  await page.click('#budget');
  await page.locator('.budget table').waitFor();
  const { budget } = await ask(`${query}&budget=true&bounces=500`);
  const told = plain(await page.locator('.budget').innerText());
  for (const { field: path, reference, above, reason } of budget.errors) {
    assert.ok(told.includes(path), `${path}: ${told}`);
    if (reason !== null) assert.match(told, new RegExp(`${path}: .*turns as it strikes`));
    else if (above?.value === 0) assert.match(told, new RegExp(`${path}, here 0( \\S+)?\\s+–\\s+none\\s`));
    if (above && above.decided_by !== 'range' && above.value >= 1e-4) {
      const shown = reference === 0 ? `+${short(above.value, 3)}` : short(reference + above.value, 3);
      assert.ok(told.includes(shown), `${path} ${above.value}: ${told}`);
    }
  }
  assert.match(told, /Beyond it\s+contact\.friction, here 0\s+–\s+none\s+Small deviations grow/);
  const { together, present } = budget;
  assert.ok(told.includes(`each up to ${short(100 * together.factor.value, 3)} %`), told);
  assert.ok(told.includes(`${short(100 * present.factor.value, 3)} %`), told);
  assert.equal(asked.length, 1);
  await enter(page, '#field-table-tilt_gain', '1.2');
  await page.locator('#budget').waitFor();
  clean();
});
