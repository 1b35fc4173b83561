// The steps of My rig that ask by themselves, noise and controller: the server's numbers, read by pointer and keys, cancelled, and in the address.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { openRig, text } from './rig-steps.js';
import { Stage, answersOf, enter, free, plain, cellsOf } from './stage.js';

const stage = await Stage.open();

/** The step on noise with its first answer. */
async function open(query) {
  const opened = await openRig(stage, `${query}#noise`);
  await opened.page.locator('#survival-told', { hasText: 'outlast' }).waitFor();
  return { ...opened, answers: await answersOf(opened.page, 'v1/ensembles?') };
}

/** Types how many runs and bounces, and waits for their answer. */
async function run(page, runs, bounces) {
  await enter(page, '#survival-runs', String(runs));
  await enter(page, '#survival-impacts', String(bounces));
  await page.locator('#survival-told', { hasText: new RegExp(`of ${runs} runs outlast ${bounces} bounces`) }).waitFor();
}

test('curve, numbers and table are the server’s, for noise of the scene and for noise that is tried', async () => {
  const { page, answers, clean } = await open('?preset=case-1-noise');
  assert.ok(await page.locator('#survival-offer').isHidden());
  assert.match(await text(page, '#survival-noise'), /10 ms/);
  await run(page, 80, 300);
  const { survival, quantiles, survived, runs, bounces } = (await answers()).at(-1);
  assert.ok(survived.runs > 0 && survived.runs < runs, 'a curve that falls, but not to the ground');
  assert.match(
    await text(page, '#survival-headline'),
    new RegExp(`^${Math.round(100 * survived.share)} % last 300 bounces`),
  );
  const risk = await page.locator('#survival-box [data-row=at-risk] text').allTextContents();
  assert.deepEqual([risk[0], risk.at(-1)], [String(runs), String(survival.at_risk[bounces - 1])]);
  const rows = await cellsOf(page, '.survival-sheet');
  assert.equal(rows.length, quantiles.n.length);
  for (const [index, row] of rows.entries()) {
    const at = quantiles.n[index] - 1;
    assert.deepEqual(row.slice(0, 3).map(Number), [quantiles.n[index], survival.at_risk[at], survival.ended[at]]);
  }
  await page.focus('#survival-box');
  await page.keyboard.press('End');
  assert.match(await text(page, '#survival-readout'), new RegExp(`^bounce 300.*at risk ${survival.at_risk[299]}`));
  await page.locator('#noise > details > summary').click();
  assert.match(await text(page, '#noise .result'), /% of 80 runs last 300 bounces$/);
  await page.locator('#noise > details > summary').click();
  // A scene without noise is tried with some, and left as it is.
  await page.selectOption('#case', 'case-1');
  await page.locator('#survival-offer').waitFor();
  await page.selectOption('#survival-model', 'plan');
  await enter(page, '#survival-timing_sd', '5');
  await page.waitForFunction(() =>
    /timing_sd=0\.005.*noise\.model=plan/.test(document.querySelector('#survival-links a').href),
  );
  const last = (await answers()).at(-1);
  assert.deepEqual([last.scene.noise.timing_sd, last.scene.noise.model], [0.005, 'plan']);
  assert.equal(await page.inputValue('#field-noise-timing_sd'), '');
  clean();
});

test('many runs tell how far they are, and Cancel frees the server', async () => {
  const { page, clean } = await open('?preset=case-1&scene.release.theta=0.05&survival.runs=40');
  const curve = () => page.locator('#survival-box [data-curve=survival]').getAttribute('d');
  await run(page, 40, 5000);
  const before = await curve();
  await enter(page, '#survival-runs', '20000');
  await page.waitForFunction(() => {
    const bar = document.querySelector('#survival-told progress');
    return !bar.hidden && bar.max === 20000 && bar.value > 0;
  });
  assert.match(await text(page, '#survival-told'), /^Running… [\d ]+ of 20 000 runs$/);
  assert.notEqual(await stage.running(), 0);
  await page.click('#survival-cancel');
  await page.locator('#survival-told', { hasText: 'Cancelled. What is shown is from before.' }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'survival-start');
  await free(stage);
  assert.equal(await curve(), before);
  await run(page, 30, 50);
  clean();
});

test('its settings are in the address, and what is broken of them is dropped in words', async () => {
  const link = 'survival.runs=300&survival.impacts=50&survival.timing_sd=0.0025&survival.model=plan';
  const { page, clean } = await open(`?preset=case-1&${link}`);
  const shown = (one) =>
    Promise.all(['runs', 'impacts', 'timing_sd', 'model'].map((name) => one.inputValue(`#survival-${name}`)));
  assert.deepEqual(await shown(page), ['300', '50', '2.5', 'plan']);
  await enter(page, '#survival-timing_sd', '12,5');
  await page.waitForFunction(() => /survival\.timing_sd=0\.0125/.test(location.search));
  await enter(page, '#survival-runs', '20001');
  assert.match(await text(page, '#survival-runs-error'), /1 to 20 000/);
  assert.equal(await page.inputValue('#survival-runs'), '300');
  clean();
  const broken = await open('?preset=case-1&survival.runs=20001&survival.impacts=1.5&survival.model=toString');
  const words = plain(await broken.page.locator('#notices').innerText());
  for (const said of ['runs “20001”', 'impacts “1.5”', 'model “toString”: it must be strike or plan'])
    assert.ok(words.includes(`survival.${said}`), words);
  assert.deepEqual(await shown(broken.page), ['200', '400', '10', 'strike']);
  broken.clean();
});

for (const preset of ['case-1', 'triangle-polygon']) {
  test(`${preset}: gains, eigenvalues and picture of a law are the server’s`, async () => {
    const { page, clean } = await openRig(stage, `?preset=${preset}&design.weights.theta=20#controller`);
    await page.getByText('Design it by other weights').click();
    await page.locator('#design-links a').first().waitFor();
    const href = await page.locator('#design-links a', { hasText: 'JSON' }).evaluate((link) => link.href);
    const answer = await (await fetch(href)).json();
    assert.equal(answer.weights.state.theta, 20);
    const shown = await page.locator('#design-gains > div > dd:nth-child(2)').allInnerTexts();
    for (const [index, name] of ['x', 'theta', 'x_dot', 'theta_dot'].entries())
      assert.ok(Math.abs(Number.parseFloat(plain(shown[index])) / answer.gain[name] - 1) < 1e-4, shown[index]);
    const moduli = await page
      .locator('.eigenvalues tbody tr')
      .evaluateAll((all) => all.map((row) => Number(row.children[1].textContent)));
    for (const [index, { modulus }] of answer.eigenvalues.entries())
      assert.ok(Math.abs(moduli[index] - modulus) < 1e-3);
    await page.locator('#design-box').focus();
    await page.keyboard.press('End');
    assert.match(await text(page, '#design-readout'), /^gain × [\d.]+\s+max \|λ\| [\d.]+$/);
    await enter(page, '#design-weights-input', '0');
    assert.match(await text(page, '#design-weights-input-error'), /above 0/);
    assert.equal(await page.inputValue('#design-weights-input'), '10');
    clean();
  });
}
