// The stability map of catches: which releases are caught, and how soon the body is at rest.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FALLS, SURVIVES, anew, openMap, shows, whole } from './map-steps.js';
import { Stage } from './stage.js';

const stage = await Stage.open();

const open = (query) => openMap(stage, query, {});

test('catches have a map with their own settings and classes, and a link restores it', async () => {
  const query =
    '?preset=case-1&map.x.parameter=release.theta&map.x.from=-1.2&map.x.to=1.2&map.y.parameter=release.theta_dot&map.y.from=-8&map.y.to=8&map.columns=48';
  const { page, clean } = await open(query);
  await whole(page);
  assert.ok(await page.locator('#map-catch-strategy').isHidden());
  await anew(page, () => page.selectOption('#map-quantity', 'caught'));
  await page.locator('#map-catch-ratio').fill('0,6');
  await anew(page, () => page.locator('#map-catch-ratio').blur());
  assert.ok(await page.locator('#map-impacts').isHidden());
  const request = new URL(await page.locator('#map-links a', { hasText: 'JSON' }).evaluate((link) => link.href));
  const asked = ['quantity', 'catch.strategy', 'catch.ratio'].map((key) => request.searchParams.get(key));
  assert.deepEqual(asked, ['caught', 'bounce_down', '0.6']);
  const answer = await (await fetch(request)).json();
  const share = Math.round((100 * answer.counts.held) / (48 * 32));
  const told = (await page.locator('#map-told').innerText()).replaceAll('\u202f', ' ');
  assert.ok(told.includes(`caught in ${share} %`), `${told} ${share}`);
  // Caught cells have the colour of success, those that fall none.
  const place = ([column, row]) => [(column + 0.5) / 48, (row + 0.5) / 32];
  const cellOf = (name) => {
    const code = answer.outcome_names.indexOf(name);
    const row = answer.outcomes.findIndex((codes) => codes.some((one, at) => at > 0 && at < 47 && one === code));
    return [answer.outcomes[row].findIndex((one, at) => at > 0 && at < 47 && one === code), row];
  };
  assert.ok(await shows(page, ...place(cellOf('held')), SURVIVES), 'caught');
  assert.ok(await shows(page, ...place(cellOf('fell')), FALLS), 'fell');
  await page.waitForFunction(() => /map\.catch\.ratio=0\.6/.test(location.search));
  const second = await open(new URL(page.url()).search);
  await whole(second.page);
  assert.equal(await second.page.inputValue('#map-catch-ratio'), '0.6');
  assert.equal(await second.page.locator('#map-told').innerText(), await page.locator('#map-told').innerText());
  assert.equal(await second.page.locator('#notices').innerText(), '');
  second.clean();
  // A setting out of its range is marked in its place.
  await page.locator('#map-catch-ratio').fill('2');
  await page.locator('#map-catch-ratio').blur();
  await page.locator('#map-catch-ratio[aria-invalid=true]').waitFor();
  await page.locator('#map-catch-ratio').fill('0.6');
  await page.locator('#map-catch-ratio').blur();
  await whole(page);
  // Its scene goes on in the tab with the catch.
  await page.locator('#map-box').focus();
  await page.keyboard.press('ArrowRight');
  await page.click('#map-catch');
  await page.locator('#catch-ratio').waitFor();
  assert.equal(await page.inputValue('#catch-ratio'), '0.6');
  clean(/422/);
});

test('the time to rest has a scale, and cells that do not come to rest have none', async () => {
  const { page, clean } = await open(
    '?preset=case-1&map.x.parameter=release.theta&map.x.from=-1.2&map.x.to=1.2&map.y.parameter=release.theta_dot&map.y.from=-8&map.y.to=8&map.columns=48&map.quantity=rest_time',
  );
  await whole(page);
  assert.match(await page.locator('#map-told').innerText(), /at rest within .* of the release/);
  assert.match(await page.locator('.map-legend').innerText(), /not at rest/);
  clean();
});
