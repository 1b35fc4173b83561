// Fields for numbers: typing changes nothing, Enter and leaving commit, a field takes its unit, a refused entry puts back what was there.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, changeUnderWay, enter, openPanel, verdict, releaseTo } from './stage.js';

const stage = await Stage.open();

/** Texts to type for a value in SI, by unit. */
const SIZES = {
  m: [
    ['mm', 1e3],
    ['cm', 100],
    ['m', 1],
  ],
  s: [
    ['ms', 1e3],
    ['s', 1],
  ],
  rad: [
    ['°', 180 / Math.PI],
    ['deg', 180 / Math.PI],
    ['mrad', 1e3],
  ],
  1: [['%', 100]],
};

/** The units to try for one of SI: of “m/s”, “mm/s” and others. */
function unitsOf(unit) {
  const first = unit === '1' ? '1' : /rad|[ms]/.exec(unit)[0];
  if (unit !== '1' && unit.startsWith('1/')) return [[unit.replace('s', 'ms'), 1e-3]];
  if (/^s²/.test(unit)) return [[unit.replace('s²', 'ms²'), 1e6]];
  return SIZES[first].map(([name, factor]) => [unit === '1' ? name : unit.replace(first, name), factor]);
}

/** A value inside the limits of a field, unlike its default. */
function valueFor({ minimum, maximum, default: usual }) {
  const [low, high] = [Math.max(minimum, -0.5), Math.min(maximum, 0.5)];
  const value = Number((low + 0.64 * (high - low)).toPrecision(3));
  return value === usual ? Number((low + 0.3 * (high - low)).toPrecision(3)) : value;
}

/** A length typed as a time, and anything else as a length. */
const otherUnit = (unit) => (unit === 'm' ? 'ms' : 'mm');

const valueAt = (page, path) =>
  page.evaluate((key) => new URLSearchParams(location.search).get(key), `scene.${path}`).then((text) => Number(text));

test('every field of the settings takes its unit and refuses another kind', async () => {
  const { page } = await stage.page('?preset=case-1&tab=values');
  await verdict(page);
  const { items: fields } = await (await fetch(`${stage.url}v1/fields`)).json();
  const numbers = fields.filter(({ kind }) => kind === 'number');
  assert.ok(numbers.length > 40);
  const table = [];
  for (const field of numbers) {
    const { field: path, unit } = field;
    const selector = `#field-${path.replaceAll('.', '-')}`;
    const input = page.locator(selector);
    const set = page.getByRole('button', { name: `Set ${field.title}`, exact: true });
    if (await set.isVisible()) await set.click();
    const value = valueFor(field);
    // Every other unit of some, one of each of the rest.
    const others = unitsOf(unit);
    for (const [name, factor] of /^release\.(height|theta|theta_dot)$|delay/.test(path) ? others : others.slice(0, 1)) {
      const typed = `${Number((value * factor).toPrecision(12))} ${name}`;
      await enter(page, input, typed);
      // The server may refuse the scene, which changes field by field here.
      assert.doesNotMatch(await page.locator(`${selector}-error`).innerText(), /put back/, `${path}: ${typed}`);
      const shown = Number(await input.inputValue());
      assert.ok(Math.abs(shown - value) <= 1e-11 * Math.abs(value), `${path}: ${typed} gave ${shown}`);
      table.push([path, typed, `${shown} ${unit === '1' ? '' : unit}`.trim()]);
    }
    const wrong = `200 ${otherUnit(unit)}`;
    const before = await input.inputValue();
    await enter(page, input, wrong);
    assert.equal(await input.inputValue(), before, `${path} after ${wrong}`);
    assert.match(await page.locator(`${selector}-error`).innerText(), /put back: “200 m[ms]” has another unit: type /);
  }
  if (process.env.FIELDS) for (const row of table) console.log(row.join('\t'));
});

test('while a value is typed nothing changes: not the run, not the address, not undo', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&speed=4&tab=values');
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  const height = page.locator('#field-release-height');
  for (const [text, value] of [
    ['200 mm', '0.2'],
    ['120 mm', '0.12'],
  ]) {
    await height.focus();
    await page.keyboard.press('Control+a');
    for (const letter of text) {
      await page.keyboard.type(letter);
      assert.doesNotMatch(page.url(), /height/);
    }
    await page.keyboard.press('Escape');
    assert.equal(await height.inputValue(), '0.2', `${value} is given up`);
  }
  assert.deepEqual(
    asked.filter((url) => /v1\/(live|(stability|trajectories).*scene\.)/.test(url)),
    [],
  );
  assert.ok(await page.locator('#undo').isDisabled());
  await enter(page, height, '300 mm');
  await page.waitForFunction(() => new URLSearchParams(location.search).get('scene.release.height') === '0.3');
  assert.equal(await height.inputValue(), '0.3');
  // A live run hears of the whole number only.
  await changeUnderWay(page);
  await releaseTo(page, 3);
  const gain = page.locator('#field-table-tilt_gain');
  await gain.focus();
  await page.keyboard.press('Control+a');
  await page.keyboard.type('1e6', { delay: 150 });
  assert.doesNotMatch(page.url(), /interventions/);
  await page.keyboard.press('Enter');
  await page.locator('#field-table-tilt_gain-error', { hasText: 'outside its limits' }).waitFor();
  assert.equal(await gain.inputValue(), '1.1');
  await page.waitForTimeout(300);
  assert.doesNotMatch(page.url(), /interventions/);
  await enter(page, gain, '115 %');
  await page.waitForFunction(() => /interventions\.0\.set\.table\.tilt_gain=1\.15/.test(location.search));
  clean();
});

test('a comma that may part thousands is not guessed at, and a decimal one is taken', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  const gravity = page.locator('#field-gravity');
  await enter(page, gravity, '1,625');
  assert.match(
    await page.locator('#field-gravity-error').innerText(),
    /“1,625” may be 1\.625 or 1625: type one of them/,
  );
  assert.equal(await gravity.inputValue(), '', 'as before');
  await enter(page, gravity, '1,62');
  await page.waitForFunction(() => /gravity=1\.62(&|$)/.test(location.search));
  assert.equal(await valueAt(page, 'gravity'), 1.62);
  await enter(page, gravity, '981 cm/s²');
  assert.equal(await gravity.inputValue(), '9.81');
  clean();
});

test('fields of the panels and of a kick take units and put back as well', async () => {
  const { page, clean } = await stage.judged('?preset=case-1');
  const panels = [
    ['map', '#map-y-to', '20°', String(Number((Math.PI / 9).toPrecision(12)))],
    ['catch', '#catch-hold', '500 ms', '0.5'],
    ['catch', '#catch-height', '40 cm', '0.4'],
  ];
  for (const [panel, selector, typed, value] of panels) {
    await openPanel(page, panel);
    const input = page.locator(selector);
    await input.evaluate((element) => {
      const folded = element.closest('details');
      if (folded) folded.open = true;
    });
    for (const [text, words] of [
      [typed, value],
      ['3 kg', value],
    ]) {
      await input.fill(text);
      await input.blur();
      assert.equal(await input.inputValue(), words, `${selector}: ${text}`);
    }
  }
  await enter(page, '#exact input', '0.3 rad/s');
  assert.equal(await page.inputValue('#exact input'), '0.3');
  clean();
});

test('an address of a case that there is not has no verdict', async () => {
  const { page } = await stage.page('?preset=nonsense', { autorun: true });
  await page
    .locator('#verdict', { hasText: /No verdict\s*There is no case “nonsense”; the page shows another/ })
    .waitFor();
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  await page.click('#verdict .held button');
  await page.locator('#verdict .headline.stable').waitFor();
});

test('a lost connection takes the verdict away, and says what is known', async () => {
  const { page } = await stage.page('?preset=case-1');
  assert.match(await verdict(page), /Stays up/);
  await releaseTo(page, 3);
  await stage.stopServer();
  await page.locator('.notice', { hasText: /Connection lost at .*\d/ }).waitFor();
  assert.doesNotMatch(await page.locator('#notices').innerText(), /goes on/);
  await page.locator('#verdict', { hasText: 'The connection to the server is lost.' }).waitFor();
  assert.equal(await page.locator('#verdict .stable').count(), 0);
  assert.match(await page.locator('#this-run .headline').innerText(), /^The connection was lost after bounce \d+$/);
  await stage.startServer();
  await page.locator('#verdict .headline.stable').waitFor();
});
