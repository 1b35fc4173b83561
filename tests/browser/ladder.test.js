// Which model a scene needs, a chapter of the paper's page: the rungs as the server tells them, following the scene; and what the run asks of the table.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, plain, cellsOf } from './stage.js';

const stage = await Stage.open();
function open(query) {
  return stage.page(`${query}#ladder`, { path: 'paper', sign: '.rungs td' });
}

const asked = async (page) =>
  (await fetch(await page.locator('#ladder-links a', { hasText: 'JSON' }).evaluate((link) => link.href))).json();
const rows = (page) => cellsOf(page, '.rungs');

for (const preset of ['triangle-polygon', 'case-4', 'point-mass']) {
  test(`${preset}: every rung with what forced it, what it changed and whether it was needed`, async () => {
    const { page, clean } = await open(`?preset=${preset}`);
    const { rungs, enough } = await asked(page);
    const { items: fields } = await (await fetch(`${stage.url}v1/fields`)).json();
    const shown = await rows(page);
    assert.equal(shown.length, rungs.length);
    for (const [index, { name, forced, outcome, change, needed, cost_ns_per_bounce: cost }] of rungs.entries()) {
      const [model, field, time, end, , most, verdictOf] = shown[index].map(plain);
      assert.equal(model, name.replaceAll('_', ' ') + (name === enough ? ' enough' : ''));
      const title = fields.find(({ field }) => field === forced?.field)?.title ?? 'Vertices';
      assert.ok(forced ? field.startsWith(plain(title)) : field === '–', field);
      assert.equal(Number(time), cost);
      assert.ok(!outcome || end === `${outcome.kind.replaceAll('_', ' ')}, ${outcome.bounces}`, end);
      if (change?.state.difference != null)
        assert.ok(Math.abs(Number.parseFloat(most) - change.state.difference) <= 0.01 * change.state.difference, most);
      assert.equal(verdictOf, needed === null ? '–' : needed ? 'needed' : 'not needed');
    }
    assert.equal(await page.locator('.rungs .enough').count(), 1);
    for (const href of await page.locator('#ladder-links a').evaluateAll((links) => links.map((link) => link.href)))
      assert.ok((await fetch(href)).ok, href);
    clean();
  });
}

test('it follows the scene and its own two numbers', async () => {
  const { page } = await open('?preset=case-1');
  assert.equal((await rows(page)).length, 2);
  await page.selectOption('#scene', 'rough-matched');
  await page.locator('.rungs tbody th', { hasText: 'friction' }).waitFor();
  await page.fill('#ladder-tolerance', '10');
  await page.locator('#ladder-tolerance').blur();
  await page.waitForFunction(() => /tolerance=10$|tolerance=10&/.test(document.querySelector('#ladder-links a').href));
  assert.equal((await asked(page)).tolerance, 10);
  await page.fill('#ladder-tolerance', '2 mm/s');
  await page.locator('#ladder-tolerance').blur();
  assert.equal(await page.inputValue('#ladder-tolerance'), '0.002');
  await page.fill('#ladder-impacts', '0');
  await page.locator('#ladder-impacts').blur();
  assert.match(plain(await page.locator('#ladder-impacts-error').innerText()), /1 to 100 000/);
  assert.equal(await page.inputValue('#ladder-impacts'), '100', 'put back');
});

test('the verdict tells what the run asks of the table', async () => {
  const { page, clean } = await stage.page('?preset=case-4&tab=why');
  const {
    nonlinear: { demand },
  } = await (await fetch(`${stage.url}v1/stability?preset=case-4`)).json();
  await page.locator('.verdict-numbers summary').click();
  const text = plain(await page.locator('.verdict-numbers .numbers').innerText());
  for (const [value, unit] of [
    [demand.tilt, 'rad'],
    [demand.tilt_rate, 'rad/s'],
    [demand.speed, 'm/s'],
    [demand.stroke, 'm'],
  ]) {
    assert.ok(text.includes(`${Number(value.toPrecision(3))} ${unit}`), `${value} ${unit} in ${text}`);
  }
  clean();
});
