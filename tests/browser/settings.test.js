// The settings: groups that fold, what differs from the case, a search, and every way to change a number.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter } from './stage.js';

const stage = await Stage.open();

const open = (page, group) => page.locator(`details.group:has(#group-${group})`).evaluate((details) => details.open);
const value = (page, path) => page.evaluate((name) => new URLSearchParams(location.search).get(`scene.${name}`), path);
const reachValue = (page, path, wanted) =>
  page.waitForFunction(
    ([name, text]) => new URLSearchParams(location.search).get(`scene.${name}`) === text,
    [path, wanted],
  );
const field = (page, path) => page.locator(`.field:has(#field-${path.replaceAll('.', '-')})`);
/** Full number of a field, as the page keeps it. */
async function whole(page, path) {
  await page.focus(`#field-${path.replaceAll('.', '-')}`);
  return Number(await page.inputValue(`#field-${path.replaceAll('.', '-')}`));
}

test('what matters most stands first, the rest is folded, and what is opened stays so on the next visit', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values', { folded: true });
  await page.locator('#field-table-tilt_gain').waitFor();
  const first = await page.locator('.first .field :is(input[type=text])').evaluateAll((all) => all.map(({ id }) => id));
  assert.deepEqual(first, [
    'field-table-tilt_gain',
    'field-release-theta',
    'field-contact-restitution',
    'field-contact-friction',
    'field-noise-timing_sd',
  ]);
  assert.equal(await page.locator('details.group[open]').count(), 0);
  await page.click('#group-body');
  await page.locator('#field-body-contact_distance').waitFor();
  await page.reload();
  await page.locator('#field-body-contact_distance').waitFor();
  assert.equal(await page.locator('details.group[open]').count(), 1);
  clean();
});

test('a field that differs has a dot and opens its group; one or all go back to the case', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&scene.table.limits.tilt=0.6&scene.table.limits.speed=1&scene.gravity=5&tab=values',
    { folded: true },
  );
  await page.locator('#group-limits', { hasText: '(2•)' }).waitFor();
  assert.ok((await open(page, 'limits')) && (await open(page, 'world')) && !(await open(page, 'body')));
  assert.equal(await page.locator('.field.differs').count(), 3);
  await field(page, 'table.limits.tilt').getByRole('button', { name: 'Reset Tilt limit to not set' }).click();
  await reachValue(page, 'table.limits.tilt', null);
  await page.locator('#group-limits', { hasText: '(1•)' }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'field-table-limits-tilt');
  await page.locator('#settings-reset', { hasText: 'Reset all (2)' }).click();
  await reachValue(page, 'gravity', null);
  assert.equal(new URL(page.url()).search, '?preset=case-1&tab=values');
  assert.equal(await page.locator('.field.differs').count(), 0);
  assert.ok(await page.locator('#settings-reset').isHidden());
  // A text makes a difference too, and a case of its own has none.
  await enter(page, '#field-release-theta', '0.2');
  await page.locator('.field.differs').waitFor();
  await page.selectOption('#case', 'case-2');
  await page.waitForFunction(() => document.querySelectorAll('.field.differs').length === 0);
  clean();
});

test('a double click on the label or the slider goes back to the case', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2&tab=values');
  await page.locator('label[for=field-release-theta]').dblclick();
  await reachValue(page, 'release.theta', null);
  await enter(page, '#field-release-theta', '0.2');
  await reachValue(page, 'release.theta', '0.2');
  await field(page, 'release.theta').locator('.track').dblclick();
  await reachValue(page, 'release.theta', null);
  assert.equal(await whole(page, 'release.theta'), 0.3);
  clean();
});

test('the search finds fields by title, symbol, path and prose, in folded groups too', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values', { folded: true });
  const shown = () =>
    page
      .locator('.field')
      .evaluateAll((all) =>
        all.filter((one) => one.checkVisibility()).map((one) => one.querySelector('label').textContent.trim()),
      );
  await page.fill('#settings-search', 'stroke');
  assert.deepEqual(await shown(), ['Stroke limit smax']);
  await page.fill('#settings-search', 'topple_angle');
  assert.deepEqual(await shown(), ['Topple angle θmax']);
  await page.fill('#settings-search', 'μ');
  assert.deepEqual(await shown(), ['Friction μ']);
  await page.fill('#settings-search', 'missing energy');
  assert.deepEqual(await shown(), ['Energy gain κE']);
  await page.fill('#settings-search', 'no such thing');
  assert.equal(await page.locator('.found').innerText(), 'No setting has these words.');
  await page.press('#settings-search', 'Escape');
  assert.equal((await shown()).length, 5, 'the first ones, and folded groups');
  clean();
});

test('arrows step a number, with Shift by ten, and go on from the exact value', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  await page.focus('#field-table-tilt_gain');
  await page.keyboard.press('ArrowUp');
  await reachValue(page, 'table.tilt_gain', '1.11');
  await page.keyboard.press('Shift+ArrowDown');
  await reachValue(page, 'table.tilt_gain', '1.01');
  // The usual value is where an open field begins.
  await page.focus('#field-gravity');
  await page.keyboard.press('ArrowDown');
  await reachValue(page, 'gravity', '9.71');
  // A limit holds.
  await page.focus('#field-contact-restitution');
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('Shift+ArrowDown');
  await reachValue(page, 'contact.restitution', '0.95');
  clean();
});

test('a label is dragged to change its number, and a finger that scrolls leaves it', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values', { hasTouch: true });
  const label = page.locator('label[for=field-contact-restitution]');
  await label.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await label.boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 - 60, y + height / 2, { steps: 6 });
  await reachValue(page, 'contact.restitution', '0.9');
  await page.mouse.up();
  assert.notEqual(await page.evaluate(() => document.activeElement.id), 'field-contact-restitution', 'no click');
  const fingers = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => fingers.send('Input.dispatchTouchEvent', { type, touchPoints });
  const box = await label.boundingBox();
  const [left, top] = [box.x + box.width / 2, box.y + box.height / 2];
  await touch('touchStart', { x: left, y: top, id: 1 });
  for (let k = 1; k <= 10; k += 1) await touch('touchMove', { x: left + k, y: top - 20 * k, id: 1 });
  await touch('touchEnd');
  await page.waitForTimeout(300);
  assert.equal(await value(page, 'contact.restitution'), '0.9');
  clean();
});

test('a field that is not set has a hollow track and a button; it can be unset again', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  const noise = field(page, 'noise.timing_sd');
  await noise.locator('.track.hollow').waitFor();
  assert.ok(await noise.locator('input[type=range]').isDisabled());
  await noise.getByRole('button', { name: 'Set Timing noise' }).click();
  await reachValue(page, 'noise.timing_sd', '0.025');
  assert.equal(await noise.locator('.track.hollow').count(), 0);
  assert.ok(await noise.locator('input[type=range]').isEnabled());
  await noise.getByRole('button', { name: 'Unset Timing noise' }).click();
  await reachValue(page, 'noise.timing_sd', null);
  await noise.locator('.track.hollow').waitFor();
  assert.equal(await page.inputValue('#field-noise-timing_sd'), '');
  // A field with a usual value is never hollow.
  assert.equal(await field(page, 'gravity').locator('.track.hollow').count(), 0);
  clean();
});

test('the help has the range of the slider, the limits with their unit, and how to type an angle', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  const theta = field(page, 'release.theta');
  await theta.getByRole('button', { name: 'About Angle' }).click();
  const help = await theta.locator('.field-help').innerText();
  assert.match(help, /Slider: −0\.6 to 0\.6\srad/);
  assert.match(help, /Allowed: −3\.142 to 3\.142\srad/);
  assert.match(help, /“20°”/);
  assert.doesNotMatch(await page.locator('#parameters').innerText(), /no unit|_dot|tilt_gain/);
  clean();
});

test('κ_c of the verdict is marked on the track of κ', async () => {
  const { page, clean } = await stage.judged('?preset=case-1&tab=values');
  const { margins } = await (await fetch(`${stage.url}v1/stability?preset=case-1`)).json();
  const slider = '#field-table-tilt_gain-slider';
  const mark = page.locator(`.track:has(${slider}) .track-mark`);
  await mark.waitFor();
  const [at, from, to] = await page.locator(slider).evaluate((input) => {
    const { left, width } = input.getBoundingClientRect();
    const line = input.parentElement.querySelector('.track-mark').getBoundingClientRect();
    const thumb = 15;
    return [(line.left + line.width / 2 - left - thumb / 2) / (width - thumb), Number(input.min), Number(input.max)];
  });
  assert.ok(Math.abs(from + at * (to - from) - margins[0].above.limit) < 0.02, slider);
  const words = await page.locator(`${slider}-track`).textContent();
  assert.ok(words.startsWith(`The critical gain is ${Number(margins[0].above.limit.toPrecision(4))}.`), words);
  // Where the verdict knows none, there is no mark.
  await page.selectOption('#case', 'still-lossy');
  await page.waitForFunction(() => [...document.querySelectorAll('.track-mark')].every(({ hidden }) => hidden));
  clean();
});

test('a long number is short, and whole for whoever is in the field', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  const length = page.locator('#field-body-contact_distance');
  assert.equal(await length.inputValue(), '0.1333');
  assert.equal(await length.getAttribute('title'), '0.13333333333333333');
  await length.focus();
  assert.equal(await length.inputValue(), '0.13333333333333333');
  await length.blur();
  assert.equal(await length.inputValue(), '0.1333');
  assert.equal(new URL(page.url()).search, '?preset=case-1&tab=values');
  clean();
});
