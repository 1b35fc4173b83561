// The map refines itself, tells its classes without colours alone, and shows the run of a cell before it is released.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openMap, place, whole } from './map-steps.js';
import { gate } from './slow-network.js';
import { Stage, openPanel, openTab } from './stage.js';

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

const plain = (text) => text.replaceAll(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');

test('a map is drawn coarse, finer, and as fine as 384 × 256', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=run&map.impacts=200');
  const asked = passes(page);
  await openPanel(page, 'map');
  await whole(page);
  assert.deepEqual(asked, [24, 96, 384]);
  assert.match(plain(await page.locator('#map-told').innerText()), /^98 304 cells: .*%.*%/);
  assert.match(await page.locator('#map-links a').first().getAttribute('href'), /x\.count=384/);
  assert.equal(await page.locator('#map-columns').inputValue(), '384');
  clean();
});

test('the columns of a link are the finest asked for', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=run&map.columns=48');
  const asked = passes(page);
  await openPanel(page, 'map');
  await whole(page);
  assert.deepEqual(asked, [24, 48]);
  assert.match(new URL(page.url()).search, /map\.columns=48/);
  clean();
});

test('a pass under way can be cancelled, and what was there stays', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=run&map.columns=192', { prepare: gate });
  await page.evaluate(() => {
    globalThis.linesLet = 70;
  });
  await openPanel(page, 'map');
  await page.locator('.map-progress', { hasText: '70 / 128 rows of 192 × 128' }).waitFor();
  await page.click('#map-cancel');
  assert.equal(await page.locator('#map-told').innerText(), 'Cancelled.');
  assert.equal(await page.locator('#map-box').getAttribute('aria-busy'), 'false');
  await page.mouse.move(...(await place(page, 0.3, 0.2)));
  assert.match(plain(await page.locator('#map-readout').innerText()), /survived 1000 bounces/);
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await page.click('#map-compute');
  await whole(page);
  clean();
});

test('when its tab is closed the map stops, and goes on when it is opened again', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=run&map.columns=96', { prepare: gate });
  const asked = passes(page);
  await page.evaluate(() => {
    globalThis.linesLet = 20;
  });
  await openPanel(page, 'map');
  await page.locator('.map-progress', { hasText: '20 / 64 rows of 96 × 64' }).waitFor();
  await openTab(page, 'run');
  await page.waitForFunction(() => globalThis.aborted > 0);
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await openPanel(page, 'map');
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

test('a map of two values has classes with hatching, another quantity a scale', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=48');
  await whole(page);
  // Hatched: more than one shade where runs fall, one where they last.
  const shades = (across, upwards) =>
    page
      .locator('#map-box canvas')
      .first()
      .evaluate(
        (canvas, [right, up]) => {
          const copy = Object.assign(document.createElement('canvas'), {
            width: canvas.width,
            height: canvas.height,
          }).getContext('2d', { willReadFrequently: true });
          copy.drawImage(canvas, 0, 0);
          const { data } = copy.getImageData(
            Math.round(52 + (canvas.width - 70) * right),
            Math.round(24 + (canvas.height - 120) * (1 - up)),
            12,
            12,
          );
          return new Set(new Uint32Array(data.buffer)).size;
        },
        [across, upwards],
      );
  assert.ok((await shades(0.1, 0.9)) > 3);
  assert.equal(await shades(0.3, 0.2), 1);
  const bar = () => shades(0.4, -62 / 300);
  await page.selectOption('#map-quantity', 'max_theta');
  await page.waitForFunction(() => /max_theta/.test(document.querySelector('#map-links a').href));
  await whole(page);
  assert.ok((await bar()) >= 1);
  assert.ok((await shades(0.3, 0.2)) > 0);
  clean();
});

test('a click shows the run of a cell, rounded to the cell, and releases nothing', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=96');
  await whole(page);
  const before = page.url();
  const answered = page.waitForResponse(/trajectories.*tilt_gain=/);
  await page.mouse.click(...(await place(page, 0.7, 0.8)));
  await page.locator('#map-inset').waitFor();
  const { outcome } = await (await answered).json();
  const heading = plain(await page.locator('#map-inset h3').innerText());
  // A cell is 0.0063 wide and 0.0079 rad high.
  assert.match(heading, /^κ 1\.\d{1,3}\s+θ₀ 0\.\d{1,3} rad$/);
  assert.match(
    plain(await page.locator('.map-inset-words').innerText()),
    new RegExp(`^Fell at bounce ${outcome.bounces}: `),
  );
  await page.locator('#map-inset', { hasText: 'after its release' }).waitFor();
  assert.match(await page.locator('.map-inset-plane').getAttribute('aria-label'), /plane with its \d+ impacts/);
  assert.equal(page.url(), before);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  // Another cell takes its place, Escape closes it, and its button releases.
  await page.mouse.click(...(await place(page, 0.2, 0.2)));
  await page.locator('.map-inset-words', { hasText: 'Survived 1000 bounces' }).waitFor();
  await page.locator('#map-inset', { hasText: 'first 400 bounces' }).waitFor();
  await page.keyboard.press('Escape');
  await page.locator('#map-inset').waitFor({ state: 'hidden' });
  await page.mouse.click(...(await place(page, 0.2, 0.2)));
  await page.click('#map-release');
  await page.waitForFunction(() => /epoch_ms=/.test(location.search));
  assert.ok(await page.locator('#map-inset').isHidden());
  clean();
});

test('the inset and the readout follow the unit of angles', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=48');
  await whole(page);
  await page.evaluate(async () => {
    const { chooseAngles } = await import('./dom/units.js');
    chooseAngles('deg');
  });
  await page.mouse.click(...(await place(page, 0.2, 0.2)));
  assert.match(plain(await page.locator('#map-inset h3').innerText()), /θ₀ \d\.?\d*°$/);
  assert.match(plain(await page.locator('#map-readout').innerText()), /°/);
  clean();
});

test('some cells stand in a table, for those who do not see the map', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=48');
  await whole(page);
  await page.locator('.map-sheet details summary').click();
  await page.locator('.map-sheet tbody tr').first().waitFor();
  const cells = await page
    .locator('.map-sheet tbody tr')
    .evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.equal(cells.length, 7);
  assert.ok(cells.every((row) => row.length === 8));
  // Upright it survives up to κ_c, and far from it falls.
  assert.equal(cells.at(-1)[2], 'survives');
  assert.match(cells[0][5], /^falls at \d+$/);
  clean();
});
