// The address of the page: it restores what it can and says what it dropped.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, changedRun, enter, numbers, reachImpact, reachPhase, stepTo, verdict, releaseTo } from './stage.js';

const stage = await Stage.open();

test('a link joins the run, or replays it from the release, with kicks and changes at their bounces', async () => {
  const first = await changedRun(stage);
  const { page } = first;
  const copied = async (id) => {
    if (await page.locator('#share-menu').isHidden()) await page.click('#share-open');
    await page.click(id);
    return page.evaluate(() => navigator.clipboard.readText());
  };
  const rows = async (one) =>
    new Map((await numbers(one, 'plane-angle')).map(([n, , theta, spin]) => [n, [theta, spin]]));
  const query = (one) => one.evaluate(() => Object.fromEntries(new URLSearchParams(location.search)));
  const deeds = (told) => Object.entries(told).filter(([key]) => key.startsWith('interventions.'));
  const told = await query(page);
  assert.ok(deeds(told).length >= 4);
  const [live, replay] = [await copied('#share-live'), await copied('#share')];
  assert.equal(live, page.url());
  assert.doesNotMatch(replay, /epoch|clock/);

  const second = await stage.page(new URL(live).search);
  await reachPhase(second.page, 'paused');
  await reachImpact(second.page, 12);
  for (const id of ['plane-angle', 'plane-velocity', 'energy'])
    assert.deepEqual(await numbers(second.page, id), await numbers(page, id));
  assert.equal(await second.page.inputValue('#field-release-theta'), '0.2');
  assert.equal(await second.page.inputValue('#field-table-tilt_gain'), '1.2');

  // Slowly: the table of its numbers has the last 50 bounces.
  const third = await stage.page(`${new URL(replay).search}&speed=0.1`);
  await reachPhase(third.page, 'running');
  await stepTo(third.page, 12);
  await third.page.waitForFunction(() => /epoch/.test(location.search));
  const replayed = await query(third.page);
  assert.notEqual(replayed.epoch_ms, told.epoch_ms, 'it is released now');
  assert.deepEqual(deeds(replayed), deeds(told));
  const [one, other] = [await rows(page), await rows(third.page)];
  for (let n = 1; n <= 12; n += 1) assert.deepEqual(other.get(String(n)), one.get(String(n)), `bounce ${n}`);
  for (const opened of [first, second, third]) {
    assert.equal(await opened.page.locator('#notices').innerText(), '');
    opened.clean();
  }
});

test('going back restores the case before', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.selectOption('#case', 'case-3');
  assert.match(page.url(), /preset=case-3/);
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.55');
  await page.goBack();
  await page.waitForFunction(() => document.querySelector('#case').value === 'case-1');
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.1');
  clean();
});

test('what is changed of a case is named, and one goes back to it', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await enter(page, '#field-contact-friction', '0.5');
  await enter(page, '#field-release-theta', '0');
  const shows = page.locator('#case-shows');
  await shows.filter({ hasText: 'Changed from the case: friction, angle.' }).waitFor();
  assert.match(await page.title(), /, changed/);
  await page.click('#case-back');
  await shows.filter({ hasText: 'keeps a bouncing rod upright' }).waitFor();
  assert.equal(await page.inputValue('#field-release-theta'), '0.3');
  clean();
});

test('going back after a click in a plane restores the run before', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  await releaseTo(page, 4);
  await page.click('#kick');
  await page.waitForFunction(() => /kick/.test(location.search));
  const epoch = await page.evaluate(() => new URLSearchParams(location.search).get('epoch_ms'));
  const box = page.locator('#plane-angle .canvas-box');
  await box.scrollIntoViewIfNeeded();
  const { width, height } = await box.boundingBox();
  await box.click({ position: { x: width * 0.6, y: height * 0.45 } });
  await page.getByRole('button', { name: 'Release here' }).click();
  await page.waitForFunction((before) => {
    const now = new URLSearchParams(location.search);
    return now.get('epoch_ms') && now.get('epoch_ms') !== before && !/kick/.test(location.search);
  }, epoch);
  await page.goBack();
  await page.waitForFunction(
    (before) => new URLSearchParams(location.search).get('epoch_ms') === before && /kick/.test(location.search),
    epoch,
  );
  await reachImpact(page, 5);
  clean();
});

test('what does not load after the first look is said, and asked for again', async () => {
  const { page } = await stage.page('?preset=case-1');
  await page.route('**/panels/panels.js', (route) => route.abort());
  await page.reload();
  await page.locator('.notice', { hasText: 'Part of the page did not load' }).waitFor();
  await page.unroute('**/panels/panels.js');
  await page.getByRole('button', { name: 'Load it again' }).click();
  await page.locator('#tab-map').waitFor();
});

const BROKEN = [
  ['preset=case-99', /case “case-99”/],
  ['preset=case-1&scene.table.tilt_gain=5000', /tilt gain.*5000.*−100 to 100/i],
  ['preset=case-1&scene.table.tilt_gain=steep', /“steep”.*not a number/],
  ['preset=case-1&scene.table.wobble=3', /“scene.table.wobble”/],
  ['preset=case-1&colour=blue', /“colour”/],
  ['preset=case-1&speed=900', /speed “900”/],
  ['preset=case-1&epoch_ms=yesterday', /“yesterday”/],
  ['preset=case-1&interventions.0.impact=3', /interventions/],
  ['preset=case-1&scene.body.point=perhaps', /“perhaps”/],
  [`preset=${encodeURIComponent('<img src=x onerror=alert(1)>')}`, /<img src=x/],
];

test('a link says what it dropped of itself and goes on', async () => {
  const { page, clean } = await stage.page(`?${BROKEN[0][0]}`);
  for (const [query, words] of BROKEN) {
    await page.evaluate((search) => {
      history.pushState(null, '', search);
      dispatchEvent(new PopStateEvent('popstate'));
    }, `?${query}`);
    assert.match(await page.locator('.notice').innerText(), words);
    await page.locator('#run:enabled').waitFor();
  }
  clean();
});

test('interventions that are not whole are dropped from a run that is joined', async () => {
  const { page, clean } = await stage.page(
    `?preset=case-1&epoch_ms=${Date.now() - 2000}&interventions.0.set.table.tilt_gain=1.2&interventions.7.impact=2&interventions.7.kick.theta_dot=0.1&clock.3.wall_ms=5`,
  );
  assert.match(await page.locator('.notice').innerText(), /1 of 2 interventions[\s\S]*pause/);
  await reachImpact(page, 2);
  await page.waitForFunction(
    () =>
      /interventions\.0\.kick\.theta_dot=0\.1/.test(location.search) && !/clock|interventions\.7/.test(location.search),
  );
  clean();
});

test('a run too old to be told whole is shown where it is by now', async () => {
  const { page, wrongs } = await stage.page('?preset=case-2&scene.table.tilt_gain=1.15&epoch_ms=1000&tab=why');
  await reachPhase(page, 'ended');
  await page.locator('#outcome', { hasText: '10000000' }).waitFor();
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.15');
  await releaseTo(page, 2);
  assert.ok(!wrongs.some((wrong) => wrong.startsWith('exception')), wrongs.join('\n'));
});

/** Two hundred links, each with something wrong in it: every field in every way there is to be wrong, and what is no field at all. */
async function brokenLinks() {
  const { items: fields } = await (await fetch(`${stage.url}v1/fields`)).json();
  const links = fields.flatMap(({ field: path, kind, minimum, maximum }) => {
    if (kind === 'choice') return [`scene.${path}=none-such`, `scene.${path}=`];
    if (kind === 'boolean') return [`scene.${path}=perhaps`];
    return [
      `scene.${path}=steep`,
      `scene.${path}=`,
      `scene.${path}=1e999`,
      ...(maximum === null ? [] : [`scene.${path}=${maximum + 1 + Math.abs(maximum)}`]),
      ...(minimum === null ? [] : [`scene.${path}=${minimum - 1 - Math.abs(minimum)}`]),
    ];
  });
  const parts = [
    'speed',
    'epoch_ms',
    'colour',
    'scene',
    'scene.',
    'scene.body',
    '__proto__',
    'scene.__proto__.x',
    'scene.constructor',
    'interventions.0.impact',
    'interventions.x.impact',
    'interventions.0.kick.spin',
    'clock.0.wall_ms',
    'clock.0',
    'map.z.parameter',
    'map',
    'survival.rums',
    'brush.mass.from',
    'toString',
    'preset',
  ];
  const values = ['', '-1', 'NaN', '[object Object]', '%00', '9'.repeat(300), '<script>alert(1)</script>'];
  for (const part of parts)
    for (const value of values) links.push(`${part}=${value.startsWith('%') ? value : encodeURIComponent(value)}`);
  return links.filter((link) => !/^epoch_ms=9+$/.test(link)).slice(0, 200);
}

test('of 200 broken links none throws, and each is told', async () => {
  const links = await brokenLinks();
  assert.equal(links.length, 200);
  const { page, wrongs } = await stage.page('?preset=case-1');
  await verdict(page);
  const silent = await page.evaluate(
    (all) =>
      all.filter((link) => {
        history.pushState(null, '', '?preset=case-1');
        dispatchEvent(new PopStateEvent('popstate'));
        if (document.querySelector('#notices .notice')) return true;
        history.pushState(null, '', `?preset=case-1&${link}`);
        dispatchEvent(new PopStateEvent('popstate'));
        return !document.querySelector('#notices .notice li');
      }),
    links,
  );
  assert.deepEqual(silent, []);
  assert.deepEqual(wrongs, []);
  await page.locator('#run:enabled').waitFor();
});

test('no mangled link throws', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  // A fixed generator: the same links every time.
  let seed = 7;
  const random = (below) => {
    seed = (seed * 48271) % 2147483647;
    return seed % below;
  };
  const whole = 'preset=case-1&scene.table.tilt_gain=1.2&scene.release.theta=0.1&speed=2';
  const letters = '&=.-0eE%<>"[]{}';
  const links = Array.from({ length: 100 }, () => {
    let query = whole;
    for (let k = 0; k <= random(4); k += 1) {
      const at = random(query.length);
      query = query.slice(0, at) + letters[random(letters.length)] + query.slice(at + random(3));
    }
    return query.replace(/%(?![0-9a-f]{2})/gi, '%25');
  });
  for (const link of links)
    await page.evaluate((search) => {
      history.pushState(null, '', search);
      dispatchEvent(new PopStateEvent('popstate'));
    }, `?${link}`);
  // One as a browser opens it.
  await page.goto(`${stage.url}?${links.at(-1)}`);
  await page.locator('#verdict .headline', { hasText: /\w/ }).waitFor();
  clean(/^(?!exception)/);
});
