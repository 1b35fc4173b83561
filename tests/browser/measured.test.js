// A lab's own impacts over the simulated ones: read as labs write them, compared impact by impact, and never sent anywhere.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, ink, openTab, reachImpact, reachPhase, speedUp } from './stage.js';

const stage = await Stage.open();
const COUNT = 12;
const csv = async (query = 'preset=case-1') =>
  (await fetch(`${stage.url}v1/trajectories?${query}&bounces=${COUNT}&format=csv`)).text();

const drop = (page, name, text) =>
  page.locator('#plane-angle').evaluate(
    (element, [file, content]) => {
      const carried = new DataTransfer();
      carried.items.add(new File([content], file, { type: 'text/csv' }));
      element.dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: carried }));
    },
    [name, text],
  );
const told = (page, words) => page.locator('#measured-told', { hasText: words }).waitFor();

/** A run of case 1 that has more impacts than are measured, and stands still. */
async function paused(options) {
  const opened = await stage.page('?preset=case-1', options);
  const { page } = opened;
  await speedUp(page);
  await page.click('#run');
  await reachImpact(page, COUNT + 1);
  await page.click('#run');
  await reachPhase(page, 'paused');
  await page.locator('#measured-load').waitFor({ state: 'attached' });
  return opened;
}

const value = (text) =>
  text === '–'
    ? NaN
    : Number(
        text
          .replace('\u2212', '-')
          .replace(
            /\u202f×\u202f10(.*)/,
            (_, power) => `e${[...power].map((digit) => (digit === '⁻' ? '-' : '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(digit))).join('')}`,
          ),
      );

/** The residuals in sum: RMS, largest and where, by name. */
async function sums(page) {
  const rows = await page
    .locator('.measured-sheet table')
    .first()
    .locator('tbody tr')
    .evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  return Object.fromEntries(
    rows.map(([name, rms, largest, at]) => [
      name.split(' / ')[0],
      { rms: value(rms), largest: value(largest), at: value(at) },
    ]),
  );
}

/** The residuals one by one. */
async function residuals(page) {
  if (!(await page.locator('.measured-sheet details').evaluate((details) => details.open)))
    await page.locator('.measured-sheet summary').click();
  await page.locator('.measured-sheet details tbody tr').first().waitFor();
  const rows = await page
    .locator('.measured-sheet details tbody tr')
    .evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  return rows.map((row) => row.map(value));
}

test('what the server computes has no residual, and a file that is dropped goes nowhere', async () => {
  const { page, clean } = await paused();
  const before = await ink(page, '#plane-angle', '--measured');
  const asked = [];
  page.on('request', (request) => asked.push(`${request.method()} ${request.url()} ${request.postData() ?? ''}`));
  await drop(page, 'rig.csv', await csv());
  await told(page, `All ${COUNT} measured impacts are simulated.`);
  assert.deepEqual(
    asked.filter((one) => !/^GET [^?]+\.(js|css|svg) $/.test(one)),
    [],
    'nothing but files of the page are asked for, which nothing is sent with',
  );
  asked.length = 0;
  await drop(page, 'rig-2.csv', await csv());
  await page.locator('#measured-title', { hasText: 'rig-2.csv' }).waitFor();
  await told(page, `All ${COUNT} measured impacts are simulated.`);
  assert.deepEqual(
    asked.filter((one) => !one.includes('icon.svg')),
    [],
  );
  for (const [name, { rms, largest }] of Object.entries(await sums(page)))
    assert.deepEqual([name, rms, largest], [name, 0, 0]);
  const rows = await residuals(page);
  assert.deepEqual(
    rows,
    Array.from({ length: COUNT }, (_, index) => [index + 1, 0, 0, 0, 0, 0]),
  );
  assert.match(await page.locator('#measured-chip').innerText(), /measured \(12\)/);
  for (const id of ['plane-angle', 'plane-velocity', 'energy'])
    assert.ok((await ink(page, `#${id}`, '--measured')) > before + 40, `diamonds in ${id}`);
  assert.equal(await page.locator('#measured-remarks').innerText(), '', 'what is not used is folded');
  await page.locator('#measured-columns summary').click();
  assert.match(await page.locator('#measured-unused').innerText(), /Not used: alpha_rad/);
  await page.locator('#measured-remove').focus();
  await page.keyboard.press('Enter');
  await page.locator('.measured').waitFor({ state: 'hidden' });
  assert.equal(await page.evaluate(() => document.activeElement.id), 'measured-load');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.equal(await ink(page, '#plane-angle', '--measured'), before);
  clean();
});

test('an error put in shows as large as it is, where it is', async () => {
  const { page, clean } = await paused();
  const lines = (await csv())
    .trim()
    .split('\n')
    .map((line) => line.split(','));
  const [theta, time] = ['theta_rad', 't_s'].map((name) => lines[0].indexOf(name));
  lines[5][theta] = String(Number(lines[5][theta]) + 0.01);
  // A clock that began 3 s before, as every clock of its own does; that is no residual.
  for (const line of lines.slice(1)) line[time] = String(Number(line[time]) + 3);
  await page.setInputFiles('#measured-file', {
    name: 'rig.csv',
    mimeType: 'text/csv',
    buffer: Buffer.from(lines.map((line) => line.join(',')).join('\n')),
  });
  await told(page, /All 12/);
  const found = await sums(page);
  assert.equal(found.θ.at, 5);
  assert.ok(Math.abs(found.θ.largest - 0.01) < 1e-12);
  assert.ok(Math.abs(found.θ.rms - 0.01 / Math.sqrt(COUNT)) < 1e-6, `${found.θ.rms}`);
  assert.ok(found.t.rms < 1e-14);
  for (const name of ['ẋ', 'ẏ', 'θ̇']) assert.equal(found[name].rms, 0);
  // Taken for later ones than they are, they are all off.
  await page.fill('#measured-first', '2');
  await page.locator('#measured-first').blur();
  await page.waitForFunction(
    () => Number(document.querySelector('.measured-sheet tbody tr:nth-child(2) td').textContent) > 0.05,
  );
  await page.fill('#measured-first', '0');
  await page.locator('#measured-first').blur();
  assert.match(await page.locator('#measured-first-error').innerText(), /whole number/);
  clean();
});

test('impacts that were missed and rows too many are told, and the clocks are set, without any numbers in the file', async () => {
  const { page, clean } = await paused();
  const { t, theta, theta_dot } = (
    await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${COUNT}`)).json()
  ).impacts;
  const rows = t.map((time, place) => [time - 2.5, theta[place] + (place % 2 ? 0.002 : -0.002), theta_dot[place]]);
  // The fifth and the ninth are missed; the seventh row of the file is a contact that was taken for two.
  const kept = rows.filter((_, place) => place !== 4 && place !== 8);
  kept.splice(6, 0, [kept[5][0] + 0.006, kept[5][1], 0]);
  await drop(page, 'camera.csv', ['time (s),angle,spin', ...kept.map((row) => row.join(','))].join('\n'));
  await told(page, '10 of 11 measured impacts are simulated ones.');
  const words = (await page.locator('#measured-matched').innerText()).replaceAll('\u202f', ' ');
  assert.equal(
    words,
    'Matched by time: the measured clock is 2500.0 ms behind the simulated one. 2 impacts missed (n = 5, 9), 1 row extra (line 8).',
  );
  const found = await sums(page);
  assert.ok(Math.abs(found.θ.rms - 0.002) < 1e-9, JSON.stringify(found));
  assert.ok(found.t.rms < 1e-12 && found.θ̇.rms < 1e-12, JSON.stringify(found));
  await residuals(page);
  const list = await page
    .locator('.measured-sheet details tbody tr')
    .evaluateAll((all) => all.map((row) => `${row.cells[0].textContent} ${row.cells[1].textContent}`));
  assert.equal(list.length, 13);
  assert.deepEqual(
    list.filter((row) => row.includes(':')),
    ['5 missed: simulated, not measured', 'line 8 extra: measured, not simulated', '9 missed: simulated, not measured'],
  );
  // A ring for each that was missed, and a cross.
  const marks = await page
    .locator('.measured-box .unpaired')
    .evaluateAll((all) => all.map((path) => path.getAttribute('d').split('M').length - 1));
  assert.deepEqual(marks, [2, 1]);
  // The page had paired by number, which is still there.
  await page.selectOption('#measured-by', 'number');
  await page.locator('#measured-matched', { hasText: 'Matched by number' }).waitFor();
  assert.ok((await sums(page)).θ.rms > 0.1);
  assert.equal(await page.locator('#measured-first-hint').isVisible(), false);
  await page.selectOption('#measured-by', 'time');
  await page.locator('#measured-matched', { hasText: '2 impacts missed' }).waitFor();
  // A typed first impact is taken; cleared, it is found again.
  await page.fill('#measured-first', '2');
  await page.locator('#measured-first').blur();
  await page.waitForFunction(() => !document.querySelector('#measured-matched').textContent.includes('2500.0'));
  await page.fill('#measured-first', '');
  await page.locator('#measured-first').blur();
  await page.locator('#measured-matched', { hasText: '2500.0' }).waitFor();
  await page.waitForFunction(() => document.querySelector('#measured-first').value === '1');
  clean();
});

test('a file of another rig is told as such', async () => {
  const { page, clean } = await paused();
  // Flights almost three times as long as those of the run.
  await drop(page, 'other.csv', ['t', ...Array.from({ length: 5 }, (_, index) => 0.12 + 0.55 * index)].join('\n'));
  await page.locator('#measured-matched', { hasText: 'of another scene or release' }).waitFor();
  await page.selectOption('#measured-by', 'number');
  await told(page, /All 5/);
  clean();
});

test('a file without times is matched by number, and rows without a time are counted', async () => {
  const { page, clean } = await paused();
  const { theta } = (await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${COUNT}`)).json()).impacts;
  await drop(page, 'angles.csv', ['n,theta', ...theta.map((value, place) => `${place + 1},${value}`)].join('\n'));
  await told(page, /All 12/);
  assert.equal(await page.locator('#measured-matched').innerText(), 'Matched by number. None missed, none extra.');
  assert.ok(await page.locator('#measured-by').isDisabled());
  assert.equal((await sums(page)).θ.rms, 0);
  await drop(page, 'some.csv', (await csv()).replace(/^(3,)[^,]*/m, '$1'));
  await told(page, 'All 11 measured impacts are simulated. 1 row without t left out.');
  assert.ok(!(await page.locator('#measured-by').isDisabled()));
  clean();
});

test('units, decimal commas, other names and missing columns are understood', async () => {
  const { page, clean } = await paused();
  const answer = (await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${COUNT}`)).json()).impacts;
  const german = (number) => String(number).replace('.', ',');
  const text = [
    '# Prüfstand 2',
    '"Impact";"time (ms)";angle [deg];θ̇ / rad s⁻¹;remark',
    ...answer.n
      .slice(2)
      .map((n, index) =>
        [
          n,
          german(answer.t[index + 2] * 1e3),
          german((answer.theta[index + 2] * 180) / Math.PI),
          german(answer.theta_dot[index + 2]),
          '"ok; more or less"',
        ].join(';'),
      ),
  ].join('\r\n');
  await drop(page, 'labor.csv', `\ufeff${text}`);
  await told(page, /All 10/);
  const found = await sums(page);
  assert.deepEqual(Object.keys(found), ['t', 'θ', 'θ̇']);
  for (const { rms } of Object.values(found)) assert.ok(rms < 1e-12, JSON.stringify(found));
  assert.equal(await page.inputValue('#measured-first'), '3');
  assert.equal(await ink(page, '#plane-velocity', '--measured'), 0, 'where a column is missing nothing is drawn');
  assert.ok((await ink(page, '#plane-angle', '--measured')) > 40);
  clean();
});

test('columns that are not known by their names are picked, with their units', async () => {
  const { page, clean } = await paused();
  const answer = (await (await fetch(`${stage.url}v1/trajectories?preset=case-1&bounces=${COUNT}`)).json()).impacts;
  const rows = answer.t.map((t, index) =>
    [index, t * 1e3, (answer.theta[index] * 180) / Math.PI, answer.y_dot[index]].join(','),
  );
  await drop(page, 'odd.csv', ['row,camera,lean,fall', ...rows].join('\n'));
  await told(page, /names none of the columns/);
  assert.ok(await page.locator('#measured-columns').evaluate(({ open }) => open), 'the picker is offered');
  const pick = (name, value) => page.getByLabel(name, { exact: true }).selectOption(value);
  await pick('lean: is', 'theta');
  await told(page, /All 12/);
  assert.ok((await sums(page)).θ.rms > 1, 'degrees taken for radians');
  await page.getByLabel('lean: unit').focus();
  await pick('lean: unit', 'deg');
  await page.waitForFunction(() => document.activeElement.getAttribute('aria-label') === 'lean: unit');
  await pick('camera: is', 't');
  await pick('camera: unit', 'ms');
  await pick('fall: is', 'y_dot');
  await page.waitForFunction(() => document.querySelectorAll('.measured-sheet table tbody tr').length >= 3);
  const found = await sums(page);
  assert.deepEqual(Object.keys(found), ['t', 'θ', 'ẏ']);
  for (const { rms } of Object.values(found)) assert.ok(rms < 1e-12, JSON.stringify(found));
  assert.match(await page.locator('#measured-columns summary').innerText(), /3 used, 1 not used/);
  await pick('fall: is', '');
  await page.waitForFunction(() => !document.querySelector('.measured-sheet table').textContent.includes('ẏ'));
  clean();
});

test('an example is a click away', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await openTab(page, 'measured');
  await page.click('#measured-example');
  await told(page, /Nothing is simulated yet/);
  await speedUp(page);
  await page.click('#run');
  await told(page, /All 24 measured impacts are simulated/);
  const found = await sums(page);
  assert.deepEqual(Object.keys(found), ['t', 'θ', 'ẋ', 'ẏ', 'θ̇']);
  // As large as the errors that were put in: a camera's.
  assert.ok(found.θ.rms > 1e-4 && found.θ.rms < 0.01, JSON.stringify(found));
  assert.ok(found.t.rms > 1e-5 && found.t.rms < 0.002, JSON.stringify(found));
  clean();
});

test('a run that is not there yet is said, and the comparison follows it', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.locator('#measured-load').waitFor({ state: 'attached' });
  await drop(page, 'rig.csv', await csv());
  await told(page, /Nothing is simulated yet/);
  await speedUp(page);
  await page.click('#run');
  await told(page, /All 12 measured impacts are simulated/);
  assert.equal((await sums(page)).θ.rms, 0);
  clean();
});

const HEAD = 't,theta,theta_dot';
for (const [name, text, words] of [
  ['an empty file', '', /empty\.|is empty/],
  ['other columns', 'a,b\n1,2\n', /names none of the columns/],
  ['no impacts', `${HEAD}\n`, /No line after the first/],
  ['a picture', `\u0089PNG\r\n\u001a\n${'\u0000\u0001\ufffd'.repeat(400)}`, /names none of the columns/],
  ['an unknown unit', 'theta (furlong),theta_dot\n1,2\n', /“furlong” is not known as a unit of theta/],
  [
    'bad lines',
    `${HEAD}\n0,0.1,0\nsoon,0.1,0\n0.2,"0,3",1\n,,\n`,
    /Line 3 is left out: t is “soon”, which is not a number/,
  ],
  ['the same twice', 'theta,angle\n0.1,0.1\n', /“angle” is left out: there is one of theta/],
  ['too many', `${HEAD}\n${'0,0,0\n'.repeat(20_001)}`, /Impacts from line 20002 on are left out: at most 20000/],
  ['too large', `${HEAD}\n${'x'.repeat(4_000_001)}`, /4 MB; at most 4 MB are read/],
  [
    'a quote without end',
    `${HEAD}\n0,"0.1,0\n0,1,2\n`,
    /No line after the first has an impact in it. Line 2 is left out/,
  ],
  ['markup', '<img src=x onerror=alert(1)>,theta\n1,0.1', /Not used: <img src=x/],
]) {
  test(`a file with ${name} is answered in words`, async () => {
    const { page, clean } = await stage.page('?preset=case-1');
    await page.locator('#measured-load').waitFor({ state: 'attached' });
    await drop(page, 'odd.csv', text);
    await page.locator('.measured').waitFor();
    await page.waitForFunction(() => /\w/.test(document.querySelector('#measured-told').textContent));
    for (const summary of await page.locator('#measured-columns:not([open]):not([hidden]) > summary').all())
      await summary.click();
    assert.match(await page.locator('.measured').innerText(), words);
    clean();
  });
}

for (const width of [1280, 320]) {
  test(`with a selection and measured impacts axe finds nothing and nothing is too wide at ${width} px`, async () => {
    const { page, clean } = await paused({ viewport: { width, height: 800 } });
    await openTab(page, 'measured');
    await drop(
      page,
      'a-very-long-name-of-a-file-from-the-rig-of-the-laboratory-on-the-third-floor.csv',
      (await csv()).replace('0.3,0.0', 'much,0.0'),
    );
    await told(page, /All 11/);
    await page.locator('#plane-angle .canvas-box').focus();
    await page.keyboard.press('End');
    await page.keyboard.press('Shift+ArrowLeft');
    await page.locator('#brush-told', { hasText: '2 of' }).waitFor({ state: 'attached' });
    await page.locator('.measured-sheet summary').click();
    await page.fill('#measured-first', 'x');
    await page.locator('#measured-first').blur();
    assert.deepEqual(await violations(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
    clean();
  });
}
