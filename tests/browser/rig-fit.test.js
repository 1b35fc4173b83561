// Fitting the rig to measured bounces: what goes to the server and when, what it says, and what is refused.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { RIG, drop, fit, fitExample, fitsOf, openRig, text, verdict } from './rig-steps.js';
import { Stage, enter, plain } from './stage.js';

const stage = await Stage.open();
/** @param {string} [query] */
const open = (query = '?preset=case-1', options) => openRig(stage, `${query}#measurements`, options);
const ROWS = RIG.trim()
  .split('\n')
  .slice(1)
  .map((line) => line.split(',').map(Number));
const id = (path) => `#fit-unknown-${path.replaceAll('.', '-')}`;

test('a dropped file stays in the browser until the button is pressed, and the answer is the server’s', async () => {
  const { page, clean } = await open();
  const asked = [];
  page.on('request', (request) => asked.push(`${request.method()} ${request.url()} ${request.postData() ?? ''}`));
  assert.match(await text(page, '#fit-promise'), /Until you press it, the data stay in this browser/);
  await drop(page, RIG);
  assert.match(await text(page, '#fit-data'), /^rig\.csv: 59 bounces/);
  assert.match(await text(page, '#fit-promise'), /^Sends these 59 bounces/);
  await page.check(id('body.radius_of_gyration'));
  await page.fill(`${id('body.radius_of_gyration')}-first`, '0.1');
  await page.fill('#fit-sd-t', '0.001');
  await page.fill('#fit-sd-theta', '0.002');
  await page.locator('#fit-sd-theta').blur();
  assert.deepEqual(
    asked.filter((one) => !/^GET \S+ $/.test(one) || /\b59\b|4\.3185/.test(one)),
    [],
    'nothing of the file is sent',
  );
  const fits = await fitsOf(page);
  await fit(page);
  assert.equal(asked.filter((one) => one.includes('v1/fits')).length, 1);
  const [{ request }] = fits;
  const answer = await fits[0].answer();
  assert.deepEqual(request.measured, { t: ROWS.map(([t]) => t), theta: ROWS.map(([, theta]) => theta) });
  assert.deepEqual(request.unknown, ['table.tilt_gain', 'body.radius_of_gyration']);
  assert.deepEqual(request.sd, { t: 0.001, theta: 0.002 });
  assert.equal(request.scene.table.tilt_gain, 1.1);
  assert.equal(request.scene.body.radius_of_gyration, 0.1);
  const shown = (await page.locator('#fit-estimates .fit-number').allInnerTexts()).map(plain);
  for (const [index, { value, sd }] of answer.estimates.entries()) {
    const [first, deviation] = shown[index].split(' ± ').map(Number.parseFloat);
    assert.ok(Math.abs(first - value) < 0.06 * sd, `${shown[index]} ${value}`);
    assert.ok(Math.abs(deviation / sd - 1) < 0.06, `${shown[index]} ${sd}`);
  }
  assert.match(await text(page, '.correlation'), /0\.99\d+/);
  const notes = await text(page, '#fit-notes');
  assert.match(notes, /1 impact between rows 23 and 24 .* was missed/);
  assert.match(notes, /θ of row 40 \(line 41 of the file\)/);
  const margins = (await page.locator('#fit-margins .fit-number').allInnerTexts()).map(plain);
  const ends = answer.stability.margins.flatMap(({ below, above }) => [below, above]).filter(Boolean);
  assert.equal(margins.length, ends.length);
  for (const [index, { margin: value, sd }] of ends.entries())
    assert.ok(Math.abs(Number.parseFloat(margins[index]) - value) < 0.06 * sd, `${margins[index]} ${value}`);
  assert.match(await text(page, '#fit-verdict'), /^● Yes: it circles upright/);
  assert.match(await text(page, '#fit-holds'), /^Every scene at the ends of the 95 % region/);
  assert.match(await text(page, '#fit-facts'), new RegExp(`at ${answer.degrees_of_freedom} degrees of freedom`));
  assert.equal(await page.locator('#fit-residuals-box .far').count(), 1);
  assert.equal(await page.locator('#fit-residuals-box .band').count(), 2);
  clean();
});

test('the fitted values take the place of those of the page, and the way back brings those before', async () => {
  const { page, clean } = await open();
  const fits = await fitsOf(page);
  await drop(page, RIG);
  await fit(page);
  const { estimates, scene } = await fits[0].answer();
  await page.click('#fit-use');
  await page.waitForFunction(
    (gain) => new URLSearchParams(location.search).get('scene.table.tilt_gain') === gain,
    String(estimates[0].value),
  );
  await page.focus('#field-table-tilt_gain');
  assert.equal(Number(await page.inputValue('#field-table-tilt_gain')), scene.table.tilt_gain);
  assert.match(await verdict(page), /^● Yes/);
  assert.match(await text(page, '#fit-used'), /^The fitted values are in use/);
  assert.ok(await page.locator('#fit-use').isHidden());
  await page.goBack();
  await page.waitForFunction(() => !location.search.includes('scene.table.tilt_gain'));
  await page.locator('#fit-use').waitFor();
  // Of other values the answer is dimmed, and not offered.
  await enter(page, '#field-release-height', '0.25');
  await page.locator('#fit-used', { hasText: 'The scene has changed since' }).waitFor();
  assert.ok(await page.locator('#fit-sheet').evaluate((sheet) => sheet.classList.contains('stale')));
  assert.ok(await page.locator('#fit-use').isHidden());
  clean();
});

test('an example hides other values of the unknown fields, and the fit finds them', async () => {
  const { page, clean } = await open('?preset=case-1&fit.unknown=table.tilt_gain,gravity');
  const fits = await fitsOf(page);
  await fitExample(page);
  const hidden = /tilt gain ([\d.]+) and gravity ([\d.]+)/
    .exec(await text(page, '#fit-data'))
    .slice(1)
    .map(Number);
  assert.deepEqual(hidden, [1.122, 10.01]);
  const { estimates, quality } = await fits[0].answer();
  assert.equal(quality.kind, 'good');
  for (const [index, { value, sd }] of estimates.entries())
    assert.ok(Math.abs(value - hidden[index]) < 5 * sd, `${value} ${sd} ${hidden[index]}`);
  assert.equal(await page.locator('#fit-estimates .scale-bar').count(), 2);
  clean();
});

test('what the data cannot tell has a reason, and keeps its value', async () => {
  const { page, clean } = await open('?preset=case-1&fit.unknown=contact.restitution');
  await fitExample(page);
  assert.match(await text(page, '#fit-estimates'), /e Restitution\s+not told by the data/);
  assert.match(await text(page, '#fit-estimates'), /drops out of the motion/);
  assert.match(await text(page, '#fit-used'), /The data tell none of the fields/);
  assert.match(await text(page, '#fit-holds'), /a field is not told/);
  assert.ok(await page.locator('#fit-use').isHidden());
  assert.equal(await page.locator('.correlation').count(), 0);
  clean();
});

test('a fit that the data reject shows no estimate to use, and says what may mend it', async () => {
  const { page, clean } = await open('?preset=case-1&fit.sd.t=0.0001&fit.sd.theta=0.0002');
  await fitExample(page);
  assert.match(await text(page, '.fit-head'), /▲ The model does not explain the data/);
  assert.match(await text(page, '#fit-told'), /^The model does not explain the data: do not use the estimates/);
  assert.match(await text(page, '#fit-rejected'), /^No values to use[\s\S]*Add a field/);
  assert.equal(await page.locator('#fit-estimates, #fit-verdict, #measurements .stable').count(), 0);
  assert.ok(await page.locator('#fit-use').isHidden());
  await page.click('#measurements summary >> nth=0');
  assert.match(await text(page, '#measurements .result'), /^▲ Example: The model does not explain the data/);
  clean();
});

test('a refusal stands at the field or the column that it is about', async () => {
  const { page, clean } = await open();
  const fits = await fitsOf(page);
  await page.click('#fit-start');
  assert.match(await text(page, '#fit-data-error'), /no measured bounces yet/);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-load');
  await drop(page, 'lean,fall\n1,2\n', 'odd.csv');
  assert.match(await text(page, '#fit-data'), /names none of the columns/);
  assert.ok(await page.locator('#fit-columns').evaluate(({ open }) => open), 'the picker is offered');
  await page.click('#fit-start');
  // Angles in degrees, by a header without a unit.
  await drop(
    page,
    ['# a remark', 't,theta', ...ROWS.map(([t, theta]) => `${t},${theta * 57.3}`)].join('\n'),
    'degrees.csv',
  );
  for (const [wrong, words] of [
    ['x', 'not a number'],
    ['0', 'above 0'],
    ['-1', 'above 0'],
  ]) {
    await page.fill('#fit-sd-t', wrong);
    await page.click('#fit-start');
    assert.ok((await text(page, '#fit-sd-t-error')).includes(words));
    assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-sd-t');
  }
  await page.fill('#fit-sd-t', '');
  await page.uncheck(id('table.tilt_gain'));
  await page.click('#fit-start');
  assert.match(await text(page, '#fit-unknown-error'), /at least one/);
  await page.check(id('table.tilt_gain'));
  await page.fill(`${id('table.tilt_gain')}-first`, 'much');
  await page.click('#fit-start');
  assert.match(await text(page, `${id('table.tilt_gain')}-first-error`), /“much” is not a number/);
  assert.equal(fits.length, 0, 'the page itself knows what is wrong');
  // The server knows the rest.
  await page.fill(`${id('table.tilt_gain')}-first`, '1000');
  await page.click('#fit-start');
  await page.locator(`${id('table.tilt_gain')}-first-error`, { hasText: '100' }).waitFor();
  assert.ok(await page.locator(`${id('table.tilt_gain')}-first[aria-invalid=true]`).isVisible());
  await page.fill(`${id('table.tilt_gain')}-first`, '');
  await page.click('#fit-start');
  await page.locator('#fit-sd-theta-error', { hasText: 'in degrees' }).waitFor();
  assert.match(await text(page, '#fit-sd-theta-error'), /^row \d+, line \d+ of the file: /);
  const [, row, line] = /row (\d+), line (\d+)/.exec(await text(page, '#fit-sd-theta-error'));
  assert.equal(Number(line), Number(row) + 2, 'the remark and the header come before');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-sd-theta');
  // The reader says that they are degrees.
  await page.getByLabel('theta: unit', { exact: true }).and(page.locator('#fit-columns *')).selectOption('deg');
  assert.match(await text(page, '#fit-columns summary'), /2 used, 0 not used/, 'the remark is no header');
  await fit(page);
  assert.equal(await text(page, '#fit-sd-theta-error'), '');
  await drop(page, 't,theta\n0,0.1\n0.2,0\n0.4,-0.1\n', 'short.csv');
  assert.ok(await page.locator('#fit-sheet').evaluate((sheet) => sheet.classList.contains('stale')));
  await page.click('#fit-start');
  await page.locator('#fit-data-error', { hasText: 'There are 6 values' }).waitFor();
  clean(/422/);
  await drop(page, RIG);
  await stage.stopServer();
  await page.click('#fit-start');
  await page.locator('#fit-told', { hasText: 'The server does not answer.' }).waitFor();
  await stage.startServer();
  await fit(page);
});

test('any number of the scene is found by words, up to eight are chosen, and the link keeps them', async () => {
  const { page, clean } = await open();
  await page.fill('#fit-search', 'tilt offset');
  assert.deepEqual(
    (await page.locator('.fit-unknown li label').allInnerTexts()).map((one) => one.trim()),
    ['κ Tilt gain', 'c Tilt offset'],
  );
  await page.check(id('table.errors.tilt_offset'));
  assert.equal(await page.inputValue(`${id('table.errors.tilt_offset')}-first`), '0');
  await page.fill('#fit-search', 'noise');
  assert.match(await text(page, '.fit-search .found'), /No field/);
  await page.keyboard.press('Escape');
  assert.equal(await page.inputValue('#fit-search'), '');
  for (const path of [
    'body.radius_of_gyration',
    'body.contact_distance',
    'gravity',
    'contact.restitution',
    'contact.friction',
    'table.errors.angle_bias',
  ])
    await page.check(id(path));
  assert.ok(await page.locator(id('table.assumed_restitution')).isDisabled());
  assert.match(await text(page, '#fit-unknown-error'), /at most 8/);
  for (const path of ['body.contact_distance', 'contact.restitution', 'contact.friction', 'table.errors.angle_bias'])
    await page.uncheck(id(path));
  await page.fill(`${id('gravity')}-first`, '9.7');
  await page.locator(`${id('gravity')}-first`).blur();
  await drop(page, RIG);
  await page.fill('#fit-sd-theta', '0.002');
  await page.locator('#fit-sd-theta').blur();
  await page.waitForFunction(
    () => /fit\.sd\.theta=0\.002/.test(location.search) && /fit\.first\.gravity=9\.7/.test(location.search),
  );
  const second = await openRig(stage, `${new URL(page.url()).search}#measurements`);
  const chosen = await second.page.locator('.fit-unknown input:checked').evaluateAll((all) => all.map((one) => one.id));
  assert.deepEqual(
    chosen,
    await page.locator('.fit-unknown input:checked').evaluateAll((all) => all.map((one) => one.id)),
  );
  assert.equal(chosen.length, 4);
  assert.equal(await second.page.inputValue(`${id('gravity')}-first`), '9.7');
  assert.equal(await second.page.inputValue('#fit-sd-theta'), '0.002');
  assert.equal(await second.page.locator('#notices').innerText(), '');
  second.clean();
  const third = await open(
    '?preset=case-1&fit.unknown=table.kappa,gravity&fit.sd.t=-1&fit.sd.height=1&fit.first.gravity=x',
  );
  await third.page.locator('.notice li', { hasText: 'table.kappa' }).waitFor();
  assert.equal(await third.page.locator('.notice li').count(), 4);
  assert.ok(await third.page.locator(id('gravity')).isChecked());
  clean();
});

test('a whole fit needs no pointer, and its residuals are read by keys', async () => {
  const { page, clean } = await open();
  const fits = await fitsOf(page);
  const seen = [];
  await page.focus('#measurements summary');
  for (let k = 0; k < 40 && !seen.includes('fit-start'); k += 1) {
    await page.keyboard.press('Tab');
    seen.push(await page.evaluate(() => document.activeElement?.id ?? ''));
  }
  for (const wanted of [
    'fit-load',
    'fit-example',
    'fit-unknown-table-tilt_gain',
    'fit-unknown-table-tilt_gain-first',
    'fit-search',
    'fit-start',
  ])
    assert.ok(seen.includes(wanted), `${wanted}: ${seen}`);
  await page.focus('#fit-example');
  await page.keyboard.press('Enter');
  await page.locator('#fit-data', { hasText: 'Computed' }).waitFor();
  await page.focus(id('gravity'));
  await page.keyboard.press(' ');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-unknown-gravity-first');
  await page.keyboard.press('Enter');
  await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
  const { residuals } = await fits[0].answer();
  await page.focus('#fit-residuals-box');
  await page.keyboard.press('Home');
  assert.match(await text(page, '#fit-residuals-readout'), /^n 1\s+line 2\s+δt -?[\d.×⁻ 10]+ s\s+δθ/);
  await page.keyboard.press('End');
  assert.match(await text(page, '#fit-residuals-readout'), new RegExp(`^n ${residuals.n.at(-1)}\\s+line 61`));
  await page.keyboard.press('Escape');
  assert.equal(await text(page, '#fit-residuals-readout'), '');
  await page.focus('#fit-use');
  await page.keyboard.press('Enter');
  await page.locator('#fit-used', { hasText: 'The fitted values' }).waitFor();
  clean();
});

test('angles are shown and typed in degrees, and sent in radians', async () => {
  const { page, clean } = await open();
  const fits = await fitsOf(page);
  await drop(page, RIG);
  await page.fill('#fit-sd-theta', '0.002');
  await fit(page);
  await page.click('#units');
  await page.waitForFunction(() => document.querySelector('#fit-sd-theta').value.startsWith('0.1145'));
  await page.locator('#fit-residuals-box', { hasText: 'δθ / °' }).waitFor();
  await page.fill('#fit-sd-theta', '0.1');
  await fit(page);
  await page.locator('#fit-facts', { hasText: '0.1°' }).waitFor();
  assert.ok(Math.abs(fits[1].request.sd.theta - (0.1 * Math.PI) / 180) < 1e-15);
  clean();
});
