// The maps behind the sliders of κ and θ₀: the same outcomes as the server's, told apart without colour, and not in the way.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, slide, verdict } from './stage.js';

const stage = await Stage.open();
const GAIN = '#field-table-tilt_gain-slider';
const ANGLE = '#field-release-theta-slider';

const known = (page, slider) => page.locator(`.track.known:has(${slider})`).waitFor();
/** Cells of a track: true where a run survives. */
const cells = (page, slider) =>
  page
    .locator(`.track:has(${slider}) .track-map > *`)
    .evaluateAll((runs) =>
      runs.flatMap((run) => Array(Number(run.style.flexGrow)).fill(run.classList.contains('survives'))),
    );

/** Requests for one-row maps of this page. */
function asked(page) {
  const found = [];
  page.on('request', (request) => {
    if (/v1\/regions.*y\.count=1\b/.test(request.url())) found.push(new URL(request.url()).searchParams);
  });
  return found;
}

async function outcomes(query, parameter, from, to) {
  const answer = await (
    await fetch(
      `${stage.url}v1/regions?${query}&x.field=${parameter}&x.from=${from}&x.to=${to}&x.count=96&y.field=gravity&y.from=9.81&y.to=9.81&y.count=1&bounces=500`,
    )
  ).json();
  return answer.values[0].map((contacts) => contacts >= 500);
}

test('the tracks of κ and θ₀ show the outcomes of 96 runs', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2&tab=values');
  for (const slider of [GAIN, ANGLE]) await known(page, slider);
  const gain = await outcomes('preset=case-1&scene.release.theta=0.2', 'table.tilt_gain', 0.8, 2);
  assert.ok(gain.includes(true) && gain.includes(false));
  assert.deepEqual(await cells(page, GAIN), gain);
  assert.deepEqual(await cells(page, ANGLE), await outcomes('preset=case-1', 'release.theta', -0.6, 0.6));
  // Told apart by hatching, and in words.
  const pattern = (kind) =>
    page
      .locator(`${'.track-map'} .${kind}`)
      .first()
      .evaluate((run) => getComputedStyle(run).backgroundImage);
  assert.match(await pattern('falls'), /repeating-linear-gradient/);
  assert.equal(await pattern('survives'), 'none');
  assert.match(
    await page.locator(`${GAIN}-track`).textContent(),
    /last 500 bounces with tilt gain 1\.0\d* to .*hatched/,
  );
  clean();
});

test('a map comes after the first plot, once for a change of the scene, and not for its own value', async () => {
  const { page, clean } = await stage.page('?tab=values');
  const requests = asked(page);
  await known(page, GAIN);
  await known(page, ANGLE);
  const [first, begin] = await page.evaluate(() => [
    performance.getEntriesByName('first plot')[0].startTime,
    Math.min(
      ...performance
        .getEntriesByType('resource')
        .filter(({ name }) => /v1\/regions/.test(name))
        .map(({ startTime }) => startTime),
    ),
  ]);
  assert.ok(begin > first);
  const before = requests.length;
  const asking = page.waitForRequest((request) => /x\.field=release\.theta/.test(request.url()));
  await slide(page, GAIN, 1.2);
  await page.waitForFunction(() => /tilt_gain=1\.2/.test(location.search));
  const answer = await asking;
  assert.equal(new URL(answer.url()).searchParams.get('scene.table.tilt_gain'), '1.2');
  await verdict(page);
  await page.waitForTimeout(600);
  assert.deepEqual(
    requests.slice(before).map((query) => query.get('x.field')),
    ['release.theta'],
  );
  assert.ok(requests.every((query) => Number(query.get('bounces')) <= 500 && query.get('x.count') === '96'));
  clean();
});

test('a scene without such runs has no map, and one that is back has it again', async () => {
  const { page } = await stage.page('?preset=point-mass&tab=values');
  await known(page, GAIN);
  await page.waitForTimeout(600);
  assert.equal(await page.locator(`.track.known:has(${ANGLE})`).count(), 0, 'a point has no angle');
  await page.selectOption('#case', 'case-1');
  await known(page, ANGLE);
});

test('in degrees the map of θ₀ is that of the degrees on the track', async () => {
  const { page, clean } = await stage.page('?preset=case-1&angles=deg&tab=values');
  await known(page, ANGLE);
  assert.equal(await page.locator(ANGLE).getAttribute('max'), '35');
  assert.deepEqual(
    await cells(page, ANGLE),
    await outcomes('preset=case-1', 'release.theta', -35 / (180 / Math.PI), 35 / (180 / Math.PI)),
  );
  clean();
});
