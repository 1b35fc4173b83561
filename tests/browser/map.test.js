// The stability map: drawn as it arrives, cancelled, pressed, looked into, kept in the link.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { endedAs, reasonOf } from '../../web/panels/verdict/words.js';
import { SURVIVES, FALLS, anew, colourAt, isColour, openMap, place, shows, whole } from './map-steps.js';
import { gate } from './slow-network.js';
import { PATIENCE_MS, Stage, enter, openPanel, openTab } from './stage.js';

const stage = await Stage.open();

const open = (query = '?preset=case-1&map.columns=96', options = {}) => openMap(stage, query, options);

const readout = async (page) => (await page.locator('#map-readout').innerText()).replaceAll('\u2212', '-');

/** Selects a rectangle. */
async function drag(page, from, to) {
  const [x0, y0] = await place(page, ...from);
  const [x1, y1] = await place(page, ...to);
  await page.keyboard.down('Shift');
  await page.mouse.move(x0, y0);
  await page.mouse.down();
  await page.mouse.move((x0 + x1) / 2, (y0 + y1) / 2, { steps: 3 });
  await page.mouse.move(x1, y1);
  await page.mouse.up();
  await page.keyboard.up('Shift');
}

const inputs = (page) =>
  page.evaluate(() =>
    ['map-x-from', 'map-x-to', 'map-y-from', 'map-y-to'].map((id) => Number(document.getElementById(id).value)),
  );

test('what is drawn is what the server computes, with the linear boundary over it', async () => {
  const { page, clean } = await open();
  await whole(page);
  const href = await page.locator('#map-links a', { hasText: 'JSON' }).getAttribute('href');
  const answer = await (await fetch(stage.url + href)).json();
  assert.equal(answer.x.length * answer.y.length, 6144);
  for (const [column, row] of [
    [10, 10],
    [60, 20],
    [90, 60],
    [30, 50],
    [48, 1],
  ]) {
    const [across, upwards] = [(column + 0.5) / 96, (row + 0.5) / 64];
    const value = answer.values[row][column];
    if (value === 1000) assert.ok(isColour(await colourAt(page, across, upwards), SURVIVES), `${column} ${row}`);
    if (value < 5) assert.ok(await shows(page, across, upwards, FALLS), `${column} ${row}`);
    const kind = answer.outcome_names[answer.outcomes[row][column]];
    await page.mouse.move(...(await place(page, across, upwards)));
    await page.waitForFunction(
      (wanted) => document.querySelector('#map-readout').textContent.replaceAll('\u00a0', ' ').endsWith(wanted),
      `${endedAs(kind, value)}${kind === 'completed' ? '' : `   ${reasonOf(kind)}`}`,
    );
  }
  const curves = answer.limit_curves.filter(({ residue }) => residue === 1);
  assert.ok(curves.length > 10 && curves.every(({ x }) => Math.abs(x[0] - 1.5) < 1e-9));
  const half = 0.6 / 95 / 2;
  const around = await Promise.all(
    [-0.002, -0.001, 0, 0.001, 0.002].map((aside) => colourAt(page, (1.5 - 1 + half) / (0.6 + 2 * half) + aside, 0.8)),
  );
  assert.ok(
    around.some((colour) => isColour(colour, [0x9c, 0x42, 0x00])),
    `a line at κ_c: ${around}`,
  );
  clean();
});

test('rows are drawn as they arrive, with their count', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values&map.columns=96', { prepare: gate });
  await page.evaluate(() => {
    globalThis.linesLet = 20;
  });
  await openPanel(page, 'map');
  await page.click('#map-options > summary');
  await page.locator('.map-progress', { hasText: '20 / 64 rows' }).waitFor();
  assert.equal(await page.locator('#map-progress').evaluate((bar) => bar.value / bar.max), 20 / 64);
  assert.ok(isColour(await colourAt(page, 0.4, 0.1), SURVIVES), 'the rows that are there');
  assert.ok(await shows(page, 0.97, 0.6, FALLS), 'and those of the coarser map before');
  assert.ok(await page.locator('#map-cancel').isEnabled());
  await page.mouse.move(...(await place(page, 0.4, 0.6)));
  assert.match(await readout(page), /not.computed.yet/);
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await whole(page);
  assert.ok(await shows(page, 0.97, 0.6, FALLS));
  assert.doesNotMatch(await readout(page), /not.computed.yet/);
  assert.ok(await page.locator('#map-cancel').isDisabled());
  clean();
});

test('cancel keeps what is there and frees the server', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=96', { prepare: gate });
  await whole(page);
  // A first row may come before the cancel, and would take the place of the map before.
  await page.evaluate(() => {
    globalThis.linesLet = 0;
  });
  const running = async () =>
    Number(/^equipoise_jobs_running (\d+)/m.exec(await (await fetch(`${stage.url}metrics`)).text())[1]);
  const aborted = page.waitForEvent('requestfailed', (request) =>
    request.url().includes('bounces=100000&format=ndjson'),
  );
  await page.fill('#map-impacts', '100000');
  await page.locator('#map-impacts').blur();
  while ((await running()) === 0) await new Promise((done) => setTimeout(done, 5));
  await page.click('#map-cancel');
  await aborted;
  while ((await running()) > 0) await new Promise((done) => setTimeout(done, 5));
  assert.equal(await page.locator('#map-told').innerText(), 'Cancelled.');
  assert.ok(await page.locator('#map-cancel').isDisabled());
  assert.ok(isColour(await colourAt(page, 0.4, 0.1), SURVIVES), 'the map before is still there');
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await page.fill('#map-impacts', '500');
  await page.locator('#map-impacts').blur();
  await whole(page);
  clean();
});

test('of questions in quick succession only the last is answered', async () => {
  const { page, clean } = await open('?preset=case-1&map.columns=96', { prepare: gate });
  await whole(page);
  await page.evaluate(() => {
    globalThis.linesLet = 3;
  });
  for (const impacts of [200, 300, 400]) {
    await page.fill('#map-impacts', String(impacts));
    await page.locator('#map-impacts').blur();
    await page.locator('.map-progress', { hasText: /^3 \/ 16/ }).waitFor();
  }
  assert.equal(await page.evaluate(() => globalThis.aborted), 2);
  await page.evaluate(() => {
    globalThis.linesLet = Infinity;
  });
  await whole(page);
  assert.match(await page.locator('#map-links a').first().getAttribute('href'), /bounces=400/);
  assert.match((await readout(page)).replaceAll('\u00a0', ' '), /survives here/);
  clean();
});

test('a press drops the scene of its cell, and the run ends as the map says', async () => {
  const { page, clean } = await open();
  await whole(page);
  await page.mouse.click(...(await place(page, 0.7, 0.8)));
  await page.mouse.move(0, 0);
  await page.waitForFunction(() => /epoch_ms=/.test(location.search));
  const words = (await readout(page)).replaceAll('\u00a0', ' ');
  const survived = Number(/fell at bounce (\d+)/.exec(words)[1]);
  assert.ok(survived < 20, words);
  const query = new URLSearchParams(new URL(page.url()).search);
  const scene = new URLSearchParams([...query].filter(([key]) => key === 'preset' || key.startsWith('scene.')));
  const { outcome } = await (await fetch(`${stage.url}v1/trajectories?${scene}&bounces=1000`)).json();
  assert.equal(outcome.bounces, survived);
  await page.locator('.ending', { hasText: `Fell at bounce ${survived}` }).waitFor();
  clean();
});

test('a rectangle is looked into, and Back and Escape return', async () => {
  const { page, clean } = await open();
  await whole(page);
  const first = await inputs(page);
  assert.ok(await page.locator('#map-back').isDisabled());
  await anew(page, () => drag(page, [0.5, 0.2], [0.8, 0.6]));
  const second = await inputs(page);
  assert.ok(second[0] > 1.29 && second[0] < 1.31 && second[1] > 1.47 && second[1] < 1.49, String(second));
  assert.ok(second[2] > 0.08 && second[2] < 0.11 && second[3] > 0.28 && second[3] < 0.32, String(second));
  await page.waitForFunction(() => /map\.x\.from=1\.3/.test(location.search));
  await anew(page, () => drag(page, [0.6, 0.9], [0.3, 0.4]));
  const third = await inputs(page);
  assert.ok(third[0] > second[0] && third[3] < second[3]);
  await anew(page, () => page.click('#map-back'));
  assert.deepEqual(await inputs(page), second);
  await page.locator('#map-box').focus();
  await anew(page, () => page.keyboard.press('Escape'));
  assert.deepEqual(await inputs(page), first);
  await page.waitForFunction(() => !/map\.[xy]/.test(location.search));
  assert.ok(await page.locator('#map-back').isDisabled());
  clean();
});

test('a selection that ends with Escape, or is too thin, does nothing', async () => {
  const { page, clean } = await open();
  await whole(page);
  const before = await inputs(page);
  await page.locator('#map-box').focus();
  await page.keyboard.down('Shift');
  await page.mouse.move(...(await place(page, 0.3, 0.3)));
  await page.mouse.down();
  await page.mouse.move(...(await place(page, 0.6, 0.6)), { steps: 4 });
  await page.keyboard.press('Escape');
  await page.mouse.up();
  await page.keyboard.up('Shift');
  await drag(page, [0.3, 0.3], [0.6, 0.301]);
  assert.deepEqual(await inputs(page), before);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  clean();
});

test('keys move the point, tell its cell, and look closer around it', async () => {
  const { page, clean } = await open();
  await whole(page);
  await page.locator('#map-box').focus();
  const spoken = () => page.locator('#map-spoken').innerText();
  await page.keyboard.press('ArrowRight');
  const first = await spoken();
  assert.match(first, /κ 1\.1\d*\s+θ₀ 0\.30\d*\srad\s+survived 1000 bounces/);
  await page.keyboard.press('ArrowRight');
  assert.notEqual(await spoken(), first);
  for (let far = 0; far < 10; far += 1) await page.keyboard.press('Shift+ArrowRight');
  assert.match(await spoken(), /κ 1\.6\s/);
  await anew(page, () => page.keyboard.press('+'));
  assert.ok((await inputs(page))[0] > 1.29);
  await anew(page, () => page.keyboard.press('Escape'));
  await page.waitForFunction(() => /epoch_ms=/.test(location.search));
  clean();
});

test('the mark follows the scene, and the map the rest of it', async () => {
  const { page, clean } = await open();
  await whole(page);
  const href = () => page.locator('#map-links a').first().getAttribute('href');
  const before = await href();
  const set = async (id, value) => {
    await openTab(page, 'values');
    await enter(page, id, value);
    await openTab(page, 'map');
  };
  await set('#field-table-tilt_gain', '1.25');
  await page.waitForFunction(() => /κ.1\.2[45]\d*/.test(document.querySelector('#map-readout').textContent));
  await page.waitForTimeout(500);
  assert.equal(await href(), before, 'a field of the map itself changes nothing of it');
  // Beyond its end the map reaches as far as the scene.
  await anew(page, () => set('#field-table-tilt_gain', '1.9'));
  assert.equal((await inputs(page))[1], 1.92);
  await anew(page, () => set('#field-release-height', '0.25'));
  assert.match(await href(), /scene\.release\.height=0\.25/);
  clean();
});

test('a link restores the map', async () => {
  const first = await open();
  await whole(first.page);
  await anew(first.page, () => first.page.selectOption('#map-y', 'release.theta_dot'));
  await anew(first.page, () => first.page.selectOption('#map-quantity', 'max_theta'));
  await anew(first.page, () => first.page.selectOption('#map-columns', '48'));
  await anew(first.page, async () => {
    await first.page.fill('#map-x-to', '1,3');
    await first.page.locator('#map-x-to').blur();
  });
  await first.page.waitForFunction(() => /map\.x\.to=1\.3/.test(location.search));
  const second = await open(new URL(first.page.url()).search);
  await whole(second.page);
  assert.equal(
    await second.page.locator('#map-links a').first().getAttribute('href'),
    await first.page.locator('#map-links a').first().getAttribute('href'),
  );
  assert.equal(await second.page.locator('#map-told').innerText(), await first.page.locator('#map-told').innerText());
  assert.equal(await second.page.locator('#notices').innerText(), '');
  first.clean();
  second.clean();
});

test('what a link says wrongly of the map is dropped and told', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&map.x.parameter=body.colour&map.x.from=1&map.x.to=2&map.quantity=beauty&map.impacts=-3&map.columns=7',
  );
  await openPanel(page, 'map');
  await page.locator('#map-links a').first().waitFor({ state: 'attached' });
  const told = await page.locator('#notices').innerText();
  for (const word of ['body.colour', 'beauty', 'bounces', 'resolution']) assert.ok(told.includes(word), told);
  assert.equal(await page.inputValue('#map-x'), 'table.tilt_gain');
  clean();
});

test('errors stand beside what they are about, and a refused entry puts back what was there', async () => {
  const { page } = await open();
  await whole(page);
  const type = async (id, text) => {
    await page.fill(`#${id}`, text);
    await page.locator(`#${id}`).blur();
  };
  await type('map-x-from', '2');
  assert.match(await page.locator('#map-x-from-error').innerText(), /below 1\.6/);
  assert.equal(await page.inputValue('#map-x-from'), '1');
  await type('map-x-from', 'steep');
  assert.match(await page.locator('#map-x-from-error').innerText(), /“steep” is not a number/);
  await type('map-x-from', '1.05');
  assert.equal(await page.locator('#map-x-from-error').innerText(), '');
  await type('map-y-to', '50');
  await page.locator('#map-y-to-error', { hasText: /50.*rad/ }).waitFor();
  assert.equal(await page.inputValue('#map-y-to'), '0.5');
  await type('map-impacts', '1.5');
  assert.match(await page.locator('#map-impacts-error').innerText(), /whole number/);
  await type('map-impacts', '100000');
  await page.selectOption('#map-columns', '384');
  // The coarser passes that the limit allows are computed first.
  await page.locator('#map-told', { hasText: /limit is [\d\s]+bounces/ }).waitFor({ timeout: 4 * PATIENCE_MS });
  await type('map-impacts', '100');
  await whole(page);
});

test('without a server the map says so and can be asked for again', async () => {
  const { page } = await open();
  await whole(page);
  await stage.stopServer();
  await page.selectOption('#map-columns', '48');
  await page.locator('#map-told', { hasText: 'The server does not answer' }).waitFor();
  await stage.startServer();
  await page.click('#map-compute');
  await whole(page);
});

test('an answer that is cut off keeps its rows and says so', async () => {
  const { page } = await stage.page('?preset=case-1&tab=values&map.columns=96', {
    prepare: () => {
      const real = globalThis.fetch;
      globalThis.fetch = async (input, init) => {
        const response = await real(input, init);
        if (!String(input).includes('format=ndjson')) return response;
        return new Response((await response.text()).split('\n').slice(0, 30).join('\n'), { headers: response.headers });
      };
    },
  });
  await openPanel(page, 'map');
  await page.click('#map-options > summary');
  await page.locator('#map-told', { hasText: /cut off\. \d+ of 64 rows/ }).waitFor();
  assert.ok(isColour(await colourAt(page, 0.4, 0.1), SURVIVES));
});

test('a point mass and a quantity without runs have their maps too', async () => {
  const { page, clean } = await open(
    '?preset=point-mass&map.y.parameter=release.x_dot&map.y.from=-0.2&map.y.to=0.2&map.columns=48',
  );
  await whole(page);
  await anew(page, () => page.selectOption('#map-quantity', 'spectral_radius'));
  assert.match(await page.locator('#map-told').innerText(), /1536 cells, from/);
  assert.ok(await page.locator('#map-impacts').isDisabled());
  clean();
});
