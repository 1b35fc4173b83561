// The unit of angles: radians or degrees for all that is shown and typed, never for what is asked of the server.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, impacts, numbers, openPanel, openTab, tool, verdict, runTo } from './stage.js';

const stage = await Stage.open();

/** The queries of the verdicts that a page asks for. */
function asked(page) {
  const found = [];
  page.on('request', (request) => {
    const url = new URL(request.url());
    // The picture of the eigenvalues is no verdict.
    if (url.pathname === '/v1/stability' && !url.searchParams.has('format')) found.push(url.search);
  });
  return found;
}

test('readouts, axes, tables and the verdict follow the switch, and no request changes', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&scene.release.theta=0.2345678901234567');
  // The last fact on it is there too.
  await page.locator('#verdict .facts', { hasText: 'ends it' }).waitFor();
  const requests = asked(page);
  assert.match(await page.locator('#scene-readout').innerText(), /θ\s0\.235\srad/);
  const numbersOf = () => page.locator('#verdict-more').textContent();
  const radians = await numbersOf();
  assert.match(radians, /rad/);
  await tool(page, 'units');
  assert.match(await page.locator('#scene-readout').innerText(), /θ\s13\.44°/);
  await page.waitForFunction(() => /°/.test(document.querySelector('#verdict-more').textContent));
  assert.doesNotMatch(await numbersOf(), /rad\b/);
  await runTo(page, 3);
  await openTab(page, 'why');
  assert.match(await page.locator('#plane-angle .readout').innerText(), /θ\s.+°\s.*θ̇\s.+°\/s/);
  const n = await impacts(page);
  const degrees = await numbers(page, 'plane-angle');
  assert.match(await page.locator('#plane-angle thead').innerText(), /θ \/ °/);
  await tool(page, 'units');
  await page.waitForFunction(() => /rad/.test(document.querySelector('#plane-angle .readout').textContent));
  const again = await numbers(page, 'plane-angle');
  assert.equal(Number(again[0][0]), n);
  const number = (text) => Number(text.replace('−', '-').replace(/\s/g, ''));
  assert.ok(Math.abs(number(degrees[0][2]) - (number(again[0][2]) * 180) / Math.PI) < 1e-4);
  assert.deepEqual(requests, [], 'a unit is nothing to ask the server about');
  clean();
});

test('the choice is remembered, a link keeps it, and another reader’s choice stays', async () => {
  const { page, clean } = await stage.judged('?preset=case-1');
  assert.doesNotMatch(page.url(), /angles/);
  await tool(page, 'units');
  await page.waitForFunction(() => new URLSearchParams(location.search).get('angles') === 'deg');
  const link = new URL(page.url()).search;
  await page.goto(`${stage.url}?preset=case-1`);
  await page.locator('#units', { hasText: '°' }).waitFor({ state: 'attached' });
  const other = await stage.page(link);
  await other.page.locator('#units', { hasText: '°' }).waitFor({ state: 'attached' });
  await verdict(other.page);
  assert.equal(await other.page.locator('.notice').count(), 0);
  assert.match(await other.page.locator('#scene-readout').innerText(), /°/);
  await other.page.goto(`${stage.url}?preset=case-1`);
  await other.page.locator('#units', { hasText: 'rad' }).waitFor({ state: 'attached' });
  clean();
  other.clean();
});

test('an angle may be typed in degrees at any time, and a field that is not edited keeps its value exactly', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&scene.release.theta=0.2345678901234567&tab=values');
  const theta = page.locator('#field-release-theta');
  const typed = () => page.evaluate(() => Number(new URLSearchParams(location.search).get('scene.release.theta')));
  const reach = (value) =>
    page.waitForFunction(
      (wanted) => Number(new URLSearchParams(location.search).get('scene.release.theta')) === wanted,
      value,
    );
  // There and back without an edit, with the focus in the field too.
  await tool(page, 'units');
  assert.equal(await theta.inputValue(), '13.44');
  await theta.focus();
  assert.match(await theta.inputValue(), /^13\.4397\d{8,}$/);
  await theta.blur();
  await tool(page, 'units');
  assert.equal(await typed(), 0.2345678901234567);
  for (const [text, value] of [
    ['20°', 20 * (Math.PI / 180)],
    ['-7.5 deg', -7.5 * (Math.PI / 180)],
    ['0,25 rad', 0.25],
  ]) {
    await enter(page, theta, text);
    await reach(value);
  }
  await tool(page, 'units');
  for (const [text, value] of [
    ['20', 20 * (Math.PI / 180)],
    ['0.3 rad', 0.3],
    ['10 degrees', 10 * (Math.PI / 180)],
  ]) {
    // The value of the case is not in the address.
    if (value === 0.3) continue;
    await enter(page, theta, text);
    await reach(value);
  }
  await theta.blur();
  assert.equal(await theta.inputValue(), '10', '10° come back as they were typed');
  await theta.focus();
  await page.keyboard.press('ArrowUp');
  await reach(10.5 / (180 / Math.PI));
  assert.equal(await theta.inputValue(), '10.5');
  clean();
});

test('the ends of the map and the spin of a kick are in the unit that is shown', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&angles=deg');
  await openPanel(page, 'map');
  await page.click('#map-options > summary');
  assert.equal(Number(await page.inputValue('#map-y-to')).toFixed(4), ((0.5 * 180) / Math.PI).toFixed(4));
  await page.fill('#map-y-to', '30');
  await page.locator('#map-y-to').blur();
  await page.waitForFunction(() => /map\.y\.to=0\.5235987/.test(location.search));
  assert.equal(new URL(page.url()).searchParams.get('map.y.from'), '0');
  await tool(page, 'units');
  assert.equal(Number(await page.inputValue('#map-y-to')).toFixed(6), (Math.PI / 6).toFixed(6));
  clean();
});

test('the server’s sentences name fields by their titles, and no unit is no words', async () => {
  const { page, clean } = await stage.judged(
    '?preset=case-1&scene.noise.timing_sd=0.01&scene.noise.model=strike&scene.table.limits.tilt_rate=3',
  );
  const text = await page.locator('main').evaluate((main) => main.textContent);
  assert.match(text, /[Tt]iming noise is 0\.01/);
  assert.doesNotMatch(text, /timing_sd|tilt_gain|contact_distance| is null|\(no unit\)/);
  clean();
  await enter(page, '#field-release-height', '0.01');
  await page.locator('#field-release-height-error').filter({ hasText: /\d/ }).waitFor();
  assert.doesNotMatch(await page.locator('#field-release-height-error').innerText(), /_|`/);
});
