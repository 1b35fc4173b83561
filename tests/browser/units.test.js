// The unit of angles: radians or degrees for all that is shown and typed, never for what is asked of the server.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, impacts, numbers, reachImpact, reachPhase, verdict } from './stage.js';

const stage = await Stage.open();

/** The queries of the verdicts that a page asks for. */
function asked(page) {
  const found = [];
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (url.pathname === '/v1/stability') found.push(url.search);
  });
  return found;
}

test('readouts, axes, tables and the verdict follow the switch, and no request changes', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2345678901234567');
  await verdict(page);
  const requests = asked(page);
  assert.match(await page.locator('#scene-readout').innerText(), /θ\s0\.235\srad/);
  const numbersOf = () => page.locator('#verdict-more').textContent();
  const radians = await numbersOf();
  assert.match(radians, /rad/);
  await page.click('#units');
  assert.match(await page.locator('#scene-readout').innerText(), /θ\s13\.44°/);
  await page.waitForFunction(() => /°/.test(document.querySelector('#verdict-more').textContent));
  assert.doesNotMatch(await numbersOf(), /rad\b/);
  await page.click('#run');
  await reachImpact(page, 3);
  await page.click('#run');
  await reachPhase(page, 'paused');
  assert.match(await page.locator('#plane-angle .readout').innerText(), /θ\s.+°\s.*θ̇\s.+°\/s/);
  const n = await impacts(page);
  const degrees = await numbers(page, 'plane-angle');
  assert.match(await page.locator('#plane-angle thead').innerText(), /θ \/ °/);
  await page.click('#units');
  await page.waitForFunction(() => /rad/.test(document.querySelector('#plane-angle .readout').textContent));
  const again = await numbers(page, 'plane-angle');
  assert.equal(Number(again[0][0]), n);
  const number = (text) => Number(text.replace('−', '-').replace(/\s/g, ''));
  assert.ok(Math.abs(number(degrees[0][2]) - (number(again[0][2]) * 180) / Math.PI) < 1e-4);
  assert.deepEqual(requests, [], 'a unit is nothing to ask the server about');
  clean();
});

test('the choice is remembered, a link keeps it, and another reader’s choice stays', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  assert.doesNotMatch(page.url(), /angles/);
  await page.click('#units');
  await page.waitForFunction(() => new URLSearchParams(location.search).get('angles') === 'deg');
  const link = new URL(page.url()).search;
  await page.goto(`${stage.url}?preset=case-1`);
  await page.locator('#units', { hasText: '°' }).waitFor();
  const other = await stage.page(link);
  await other.page.locator('#units', { hasText: '°' }).waitFor();
  await verdict(other.page);
  assert.equal(await other.page.locator('.notice').count(), 0);
  assert.match(await other.page.locator('#scene-readout').innerText(), /°/);
  await other.page.goto(`${stage.url}?preset=case-1`);
  await other.page.locator('#units', { hasText: 'rad' }).waitFor();
  clean();
  other.clean();
});
