// The branch of orbits of period 2: the server’s picture with its numbers, for the scene of the page.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, openPanel, verdict, plain } from './stage.js';

const stage = await Stage.open();

async function open(query) {
  const opened = await stage.page(query);
  await openPanel(opened.page, 'branch');
  return opened;
}

for (const [preset, kind] of [
  ['case-1', 'soft'],
  ['critical-hard', 'hard'],
]) {
  test(`${preset}: picture and changes of a ${kind} boundary`, async () => {
    const { page, clean } = await open(`?preset=${preset}`);
    const figure = page.locator('#branch-body svg.figure');
    await figure.waitFor();
    assert.ok(await figure.evaluate((element) => element.getBoundingClientRect().width > 300));
    const { changes } = await (
      await fetch(await page.locator('#branch-body .actions a', { hasText: 'JSON' }).evaluate((link) => link.href))
    ).json();
    const rows = await page
      .locator('.changes tbody tr')
      .evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.firstChild.textContent)));
    assert.deepEqual(
      rows.map(([name]) => name),
      changes.map((change) => change.kind.replaceAll('_', ' ')),
    );
    for (const [index, [, gain, theta]] of rows.entries()) {
      assert.ok(
        Math.abs(Number(gain) - changes[index].value) < 1e-4 && Math.abs(Number(theta) - changes[index].theta) < 1e-4,
        String(rows[index]),
      );
    }
    assert.match(
      plain(await page.locator('#branch-body').innerText()),
      new RegExp(`a ${kind} boundary \\(C = ${kind === 'hard' ? '-' : ''}0\\.\\d+\\)`),
    );
    clean();
  });
}

test('orbits begin with a sentence', async () => {
  const { page, clean } = await open('?preset=case-1');
  const figure = page.locator('#branch-body svg.figure');
  await figure.waitFor();
  const answer = page.locator('#branch-body .answer');
  assert.match(plain(await answer.innerText()), /^Just beyond its largest tilt gain .* κc = 1\.5 /);
  assert.ok((await answer.boundingBox()).y < (await figure.boundingBox()).y);
  assert.ok(await page.locator('.changes').isHidden(), 'the table is folded');
  // The title of the server's sheet is outside of what the page shows of it.
  const [top, title] = await figure.evaluate((svg) => [
    svg.getBoundingClientRect().top,
    svg.querySelector('text').getBoundingClientRect().bottom,
  ]);
  assert.ok(title <= top, `the title ends at ${title}, the picture begins at ${top}`);
  clean();
});

test('it follows the scene, and a body without an angle has none', async () => {
  const { page, clean } = await open('?preset=case-1');
  const src = () => page.locator('#branch-body .actions a', { hasText: 'SVG' }).getAttribute('href');
  await page.locator('#branch-body svg.figure').waitFor();
  const before = await src();
  await enter(page, '#field-release-height', '0.25');
  await openPanel(page, 'branch');
  await page.waitForFunction(
    (old) => ![old, undefined].includes(document.querySelector('#branch-body .actions a')?.getAttribute('href')),
    before,
  );
  assert.match(await src(), /scene\.release\.height=0\.25/);
  await page.selectOption('#case', 'point-mass');
  await verdict(page);
  await openPanel(page, 'branch');
  await page.locator('#branch-body', { hasText: 'no angle' }).waitFor();
  await page.selectOption('#case', 'still-lossy');
  await openPanel(page, 'branch');
  await page.locator('#branch-body', { hasText: 'no critical gain' }).waitFor();
  clean();
});

test('without a server it says so and asks again by itself', async () => {
  const { page } = await stage.page('?preset=case-1', {
    watch: (page) => page.route(/periodic-orbits/, (route) => route.abort()),
  });
  await openPanel(page, 'branch');
  await page.locator('#branch-body', { hasText: 'The server does not answer' }).waitFor();
  await page.unroute(/periodic-orbits/);
  await page.locator('#branch-body svg.figure').waitFor();
});

test('the diagram is read by pointer and keys, and has the colours of the page', async () => {
  const { page, clean } = await open('?preset=case-1');
  const box = page.locator('#branch-box');
  const readout = page.locator('#branch-readout');
  await box.locator('svg.figure').waitFor();
  const { branch } = await (
    await fetch(await page.locator('#branch-body .actions a', { hasText: 'JSON' }).evaluate((link) => link.href))
  ).json();
  await box.focus();
  await page.keyboard.press('Home');
  assert.match(plain(await readout.innerText()), new RegExp(`^κ ${Number(branch.value[0].toPrecision(6))} `));
  await page.keyboard.press('End');
  const last = plain(await readout.innerText());
  assert.match(last, new RegExp(`^κ ${Number(branch.value.at(-1).toPrecision(6))} `));
  assert.match(last, / (un)?stable$/);
  await page.keyboard.press('ArrowRight');
  assert.equal(plain(await readout.innerText()), last, 'there is no point after the last');
  const ring = await box.locator('.pointed').boundingBox();
  await page.keyboard.press('Escape');
  assert.equal(await readout.innerText(), '');
  await page.mouse.move(ring.x + ring.width / 2, ring.y + ring.height / 2);
  await page.waitForFunction(() => document.querySelector('#branch-readout').textContent !== '');
  assert.equal(plain(await readout.innerText()), last);
  const ink = () =>
    box
      .locator("[fill='#1b1f24']")
      .first()
      .evaluate((text) => getComputedStyle(text).fill);
  const light = await ink();
  await page.emulateMedia({ colorScheme: 'dark' });
  assert.notEqual(await ink(), light);
  clean();
});
