// The map refines itself as far as it may, only while it is seen, and tells its cells in words as well.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openMap, place, whole } from './map-steps.js';
import { gate } from './slow-network.js';
import { Stage, openPanel, openTab, tool, plain, cellsOf } from './stage.js';

// A server with less work for one map than usual, so that a refusal costs no minute.
process.env.EQUIPOISE_REGION_WORK = '30000000';
const stage = await Stage.open();

const open = (query, options) => openMap(stage, query, options);

/** The columns of the maps that the page asks for from now on. */
function passes(page) {
  const asked = [];
  page.on('request', (request) => {
    const query = new URL(request.url()).searchParams;
    if (/v1\/regions/.test(request.url()) && query.get('format') === 'ndjson') asked.push(Number(query.get('x.count')));
  });
  return asked;
}

/** Opens the settings of the map. */
const unfold = (page) =>
  page.locator('#map-options').evaluate((details) => {
    details.open = true;
  });

test('a map is drawn coarse, finer, and as fine as 384 × 256', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values&map.impacts=200');
  const asked = passes(page);
  await openPanel(page, 'map');
  await unfold(page);
  await whole(page);
  assert.deepEqual(asked, [24, 96, 384]);
  assert.match(plain(await page.locator('#map-told').innerText()), /^98 304 cells: .*%.*%/);
  assert.match(await page.locator('#map-links a').first().getAttribute('href'), /x\.count=384/);
  assert.equal(await page.locator('#map-columns').inputValue(), '384');
  clean();
});

test('the columns of a link are the finest asked for', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values&map.columns=48');
  const asked = passes(page);
  await openPanel(page, 'map');
  await unfold(page);
  await whole(page);
  assert.deepEqual(asked, [24, 48]);
  assert.match(new URL(page.url()).search, /map\.columns=48/);
  clean();
});

test('when its tab is closed the map stops, and goes on when it is opened again', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values&map.columns=96', { prepare: gate });
  const asked = passes(page);
  await page.evaluate(() => {
    globalThis.linesLet = 20;
  });
  await openPanel(page, 'map');
  await unfold(page);
  await page.locator('.map-progress', { hasText: '20 / 64 rows of 96 × 64' }).waitFor();
  await openTab(page, 'values');
  await page.waitForFunction(() => globalThis.aborted > 0);
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await openPanel(page, 'map');
  await unfold(page);
  await whole(page);
  assert.deepEqual(asked, [24, 96, 96], 'a pass that was whole is kept');
  clean();
});

test('a price too high leaves the finest map that is allowed, and says so', async () => {
  const { page } = await open('?preset=case-1');
  await whole(page);
  const told = plain(await page.locator('#map-told').innerText());
  assert.match(told, /^24 576 cells: .*Finer than that the server refuses: .*limit is \d+ bounces/, told);
  assert.match(await page.locator('#map-links a').first().getAttribute('href'), /x\.count=192/);
});

test('cells are told in words: shares, some of them in a table, and the one pointed at in the unit of angles', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=48');
  await whole(page);
  const href = await page.locator('#map-links a', { hasText: 'JSON' }).getAttribute('href');
  const { values } = await (await fetch(stage.url + href)).json();
  const lasting = values.flat().filter((bounces) => bounces === 1000).length / values.flat().length;
  const legend = plain(await page.locator('.map-legend').innerText());
  assert.ok(Math.abs(Number(/survives (\d+\.?\d*) %/.exec(legend)[1]) - 100 * lasting) <= 0.5, legend);
  assert.match(legend, /falls \d+\.?\d* %/);
  await page.locator('#map-options details summary').click();
  const rows = page.locator('#map-options tbody tr');
  await rows.first().waitFor();
  const cells = await cellsOf(page, '#map-options');
  assert.equal(cells.length, 7);
  assert.ok(cells.every((row) => row.length === 8));
  // Upright it survives up to κ_c, and far from it falls.
  assert.equal(cells.at(-1)[2], 'survives');
  assert.match(cells[0][5], /^falls at \d+$/);
  await page.mouse.move(...(await place(page, 0.2, 0.2)));
  assert.match(plain(await page.locator('#map-readout').innerText()), /rad .*survived 1000 bounces/);
  await page.keyboard.press('Escape');
  await tool(page, 'units');
  await page.mouse.move(...(await place(page, 0.2, 0.2)));
  assert.match(plain(await page.locator('#map-readout').innerText()), /°/);
  clean();
});
