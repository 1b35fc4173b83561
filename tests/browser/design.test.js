// A law designed on the page: the server's gains, its picture, and the scene that runs with it, in the form and in the link.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, openPanel, reachImpact, verdict } from './stage.js';

const stage = await Stage.open();
const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');

async function open(query, options) {
  const opened = await stage.page(query, options);
  await verdict(opened.page);
  await openPanel(opened.page, 'design');
  await opened.page.locator('#design-start').waitFor();
  return opened;
}

async function design(page) {
  await page.click('#design-start');
  await page.locator('#design-links a').first().waitFor();
  return (await fetch(await page.locator('#design-links a', { hasText: 'JSON' }).evaluate((link) => link.href))).json();
}

test('gains, eigenvalues and picture are the server’s', async () => {
  const { page, clean } = await open('?preset=case-1');
  await page.fill('#design-theta', '20');
  await page.fill('#design-input', '5');
  const answer = await design(page);
  assert.equal(answer.weights.state.theta, 20);
  assert.equal(answer.weights.input, 5);
  const shown = await page.locator('#design-gains > div > dd:nth-child(2)').allInnerTexts();
  for (const [index, name] of ['x', 'theta', 'x_dot', 'theta_dot'].entries()) {
    assert.ok(
      Math.abs(Number.parseFloat(plain(shown[index])) / answer.gain[name] - 1) < 1e-4,
      `${shown[index]} ${answer.gain[name]}`,
    );
  }
  const moduli = await page
    .locator('.eigenvalues tbody tr')
    .evaluateAll((all) => all.map((row) => [row.children[1].textContent, row.children[3].textContent].map(Number)));
  assert.equal(moduli.length, 4);
  for (const [index, [closed, loose]] of moduli.entries()) {
    assert.ok(
      Math.abs(closed - answer.eigenvalues[index].modulus) < 1e-3 &&
        Math.abs(loose / answer.open_loop[index].modulus - 1) < 1e-3,
    );
  }
  const figure = page.locator('#design-sheet svg.figure');
  assert.ok(await figure.evaluate((element) => element.getBoundingClientRect().width > 300));
  await page.locator('#design-box').focus();
  await page.keyboard.press('End');
  assert.match(await page.locator('#design-readout').innerText(), /^gain\s×\s[\d.]+\s+max\s\|λ\|\s[\d.]+$/);
  for (const href of await page
    .locator('#design-links a, #design-regions a')
    .evaluateAll((links) => links.map((link) => link.href)))
    assert.ok((await fetch(href)).ok, href);
  assert.equal(await page.locator('#design-regions a').count(), 2);
  clean();
});

for (const preset of ['case-1', 'triangle-polygon']) {
  test(`${preset}: the law goes into the scene, runs without a tilt gain, and its link restores it`, async () => {
    const { page, clean } = await open(`?preset=${preset}&scene.release.theta=0.05`);
    const { gain } = await design(page);
    await page.click('#design-run');
    await reachImpact(page, 3);
    assert.equal(await page.inputValue('#field-table-tilt_gain'), '');
    // The whole number is there for whoever is in the field.
    await page.focus('#field-table-feedback-theta');
    assert.equal(Number(await page.inputValue('#field-table-feedback-theta')), gain.theta);
    assert.equal(await page.locator('#field-table-tilt_gain-error').innerText(), '');
    assert.doesNotMatch(await verdict(page), /No verdict/);
    await page.click('#share');
    const link = new URL(await page.evaluate(() => navigator.clipboard.readText()));
    assert.equal(Number(link.searchParams.get('scene.table.feedback.theta')), gain.theta);
    const second = await stage.page(link.search, { autorun: true });
    await reachImpact(second.page, 3);
    assert.equal(await second.page.locator('#notices').innerText(), '');
    assert.equal(await second.page.inputValue('#field-table-tilt_gain'), '');
    assert.equal(
      await second.page.inputValue('#field-table-feedback-x_dot'),
      await page.inputValue('#field-table-feedback-x_dot'),
    );
    second.clean();
    clean();
  });
}

test('a link keeps noise and limits, and the form wants one law or the other', async () => {
  const { page, wrongs } = await stage.page('?preset=case-1');
  for (const [path, text] of [
    ['noise-timing_sd', '0.002'],
    ['table-limits-tilt', '0.6'],
    ['table-limits-stroke', '0.1'],
    ['table-feedback-theta', '-1.1'],
  ]) {
    await enter(page, `#field-${path}`, text);
  }
  await enter(page, '#field-table-tilt_gain', '');
  await page.selectOption('#field-noise-model', 'plan');
  await page.waitForFunction(() => /tilt_gain=null/.test(location.search) && /noise\.model=plan/.test(location.search));
  await verdict(page);
  assert.match(await page.locator('#verdict-more .reason').innerText(), /noise/, 'the server took it');
  assert.equal(await page.locator('.field .error:not(:empty)').count(), 0);
  const second = await stage.page(new URL(page.url()).search);
  for (const [path, text] of [
    ['noise-timing_sd', '0.002'],
    ['noise-model', 'plan'],
    ['table-limits-tilt', '0.6'],
    ['table-limits-stroke', '0.1'],
    ['table-feedback-theta', '-1.1'],
    ['table-tilt_gain', ''],
  ]) {
    assert.equal(await second.page.inputValue(`#field-${path}`), text, path);
  }
  assert.equal(await second.page.locator('#notices').innerText(), '');
  await enter(page, '#field-table-feedback-theta', '');
  await page.click('#run');
  await page.locator('#field-table-tilt_gain-error', { hasText: 'needed' }).waitFor();
  second.clean();
  // Between two fields both laws are there, which the server refuses.
  assert.deepEqual(
    wrongs.filter((wrong) => !/422/.test(wrong)),
    [],
  );
});

test('what is wrong is said, and a body without an angle has no law', async () => {
  const { page } = await open('?preset=point-mass');
  await page.click('#design-start');
  await page.locator('#design-told', { hasText: 'angle of its own' }).waitFor();
  assert.ok(await page.locator('#design-sheet').isHidden());
  await page.fill('#design-input', '0');
  await page.click('#design-start');
  assert.match(await page.locator('#design-error').innerText(), /above 0/);
  assert.equal(await page.evaluate(() => document.activeElement.id), 'design-input');
});
