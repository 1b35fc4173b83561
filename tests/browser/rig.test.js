// My rig: from measured bounces to what to mend first, with the owner's own errors, files, links and the way back.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { violations } from './axe.js';
import { RIG, drop, fit, limits, openRig, text, verdict } from './rig-steps.js';
import { Stage, enter, slide, plain } from './stage.js';

const stage = await Stage.open();
const open = (address, options) => openRig(stage, address, options);
const ANGLE = '#have-table-errors-angle_bias';
const fields = (page) => page.locator('#budget .limit').evaluateAll((all) => all.map((line) => line.dataset.field));

test('a lab goes from a CSV to what to mend first in five steps', async () => {
  const { page, clean } = await open();
  // Its bounces, its values, its verdict, its errors, the answer.
  await drop(page, RIG);
  await page.check('#fit-unknown-body-radius_of_gyration');
  await fit(page);
  assert.match(await text(page, '#fit-estimates'), /Tilt gain\s+1\.137 ± 0\.016/);
  await page.click('#fit-use');
  assert.match(await verdict(page), /^● Yes: it circles upright/);
  // Over the measured bounces stands the fit with its first state, not a run from the release.
  assert.match(await text(page, '#overlay'), /^Over the fit/);
  await page.focus('#overlay-box');
  await page.keyboard.press('Home');
  assert.match(await text(page, '#overlay-readout'), /^bounce 1\s+t -?[\d.]+ s\s+θ -?[\d.]+ rad$/);
  assert.match(
    await text(page, '#verdict .range'),
    /^κ may be 1\.0\d+ to 1\.2\d? for this release · 1 to 1\.6 for small swings$/,
  );
  assert.match(await limits(page), /^Check the /);
  await enter(page, ANGLE, '3 mrad');
  assert.match(await limits(page), /^Mend the angle sensor first: [\d.]+ µrad too (much|little) ends it\.$/);
  assert.equal(await text(page, `.limit[data-field="table.errors.angle_bias"] .limit-act`), 'mend this');
  assert.equal((await fields(page))[0], 'table.errors.angle_bias', 'the headline names the first line');
  const link = new URL(page.url()).searchParams;
  assert.equal(Number(link.get('have.table.errors.angle_bias')), 0.003);
  assert.ok(Math.abs(Number(link.get('scene.table.tilt_gain')) - 1.137) < 0.001);
  await page.click('#measurements summary >> nth=0');
  assert.match(await text(page, '#measurements .result'), /^● rig\.csv: the fitted values are in use/);
  clean();
});

test('the limits are the server’s, against what the owner has, the worst first', async () => {
  const { page, clean } = await open('?preset=rough-feedback');
  await limits(page);
  const { budget } = await (
    await fetch(`${stage.url}v1/stability?preset=rough-feedback&budget=true&bounces=500`)
  ).json();
  const told = new Map(budget.errors.map((error) => [error.field, error]));
  await page.locator('#other-limits').evaluate((rest) => {
    rest.open = true;
  });
  const line = await text(page, '.limit[data-field="table.delay"]');
  assert.match(line, new RegExp(`^Table is late by ${(told.get('table.delay').above.value * 1000).toPrecision(3)} ms`));
  assert.match(await text(page, '.limit[data-field="contact.friction"]'), /^Friction is 0\.0799 less/);
  const before = await fields(page);
  assert.ok(before.indexOf('table.delay') > 5);
  await enter(page, '#have-table-delay', '4 s');
  assert.match(await limits(page), /^Mend the delay of the table first: 32\.3 ms ends it/);
  assert.equal((await fields(page))[0], 'table.delay');
  assert.match(await page.locator('.limit[data-field="table.delay"] .scale').getAttribute('aria-label'), /^0\.0081 of/);
  // A small one is fine, and one of none at all as well.
  for (const size of ['1 ms', '0']) {
    await enter(page, '#have-table-delay', size);
    assert.equal(await text(page, '.limit[data-field="table.delay"] .limit-act'), 'fine');
  }
  // Emptied, it is that of a usual lab again.
  await enter(page, '#have-table-delay', '');
  assert.deepEqual(await fields(page), before);
  // Noise of the scene itself is what its owner has.
  await page.selectOption('#case', 'rough-noise');
  await page.locator('.limit[data-field="noise.timing_sd"] .limit-act', { hasText: 'as in your values' }).waitFor();
  assert.match(await text(page, '#budget'), /may all grow to 2\d\d %/);
  clean();
});

test('a refused entry puts back what stood there, and half a number changes nothing', async () => {
  const { page, clean } = await open();
  await limits(page);
  const address = page.url();
  await page.fill('#field-table-tilt_gain', '1.');
  assert.equal(page.url(), address, 'typing changes nothing');
  await page.press('#field-table-tilt_gain', 'Escape');
  for (const wrong of ['-1', 'much', '3 kg']) {
    await enter(page, ANGLE, wrong);
    assert.match(await text(page, `${ANGLE}-error`), /put back/);
    assert.equal(await page.inputValue(ANGLE), '');
  }
  await enter(page, '#field-table-tilt_gain', '1,2');
  await enter(page, '#field-body-contact_distance', '130 mm');
  assert.equal(new URL(page.url()).searchParams.get('scene.body.contact_distance'), '0.13');
  await enter(page, '#field-body-contact_distance', '200 kg');
  assert.equal(await page.inputValue('#field-body-contact_distance'), '0.13');
  assert.equal(new URL(page.url()).searchParams.get('scene.table.tilt_gain'), '1.2');
  clean();
});

test('values that do not go together have no verdict, and the reason stands at the field', async () => {
  const { page, clean } = await open();
  await enter(page, '#field-release-height', '0.1');
  await page.locator('#field-release-height-error:not(:empty)').waitFor();
  assert.match(await text(page, '#verdict .headline'), /^– No verdict: these values do not go together/);
  assert.equal(await page.locator('.stable:visible, .range').count(), 0, 'nothing is green');
  await page.locator('#controller > details > summary').click();
  await page.locator('.laws td', { hasText: '–' }).first().waitFor();
  assert.equal(await page.locator('.stable:visible, .range').count(), 0, 'nor in a step that is opened then');
  await page.goBack();
  assert.match(await verdict(page), /^● Yes/);
  assert.equal(await page.inputValue('#field-release-height'), '0.2');
  assert.equal(await text(page, '#field-release-height-error'), '');
  clean(/422/);
});

test('a fall is said with its bounce, and what would hold is a press away', async () => {
  const { page, clean } = await open('?preset=case-1');
  await enter(page, '#field-contact-friction', '0.2');
  await page.locator('#verdict .headline .told.unstable').waitFor();
  assert.match(await verdict(page), /^▲ No: at bounce 3 its foot was leaving the table already$/);
  assert.match(await limits(page), /^It falls without any error/);
  await enter(page, ANGLE, '3 mrad');
  await page.waitForFunction(() => /have\.table\.errors\.angle_bias=0\.003/.test(location.search));
  await page.locator('.other button').click();
  await page.locator('#verdict .headline .told.stable').waitFor();
  assert.match(page.url(), /slide=matched/);
  assert.equal(await page.locator('#field-table-slide').inputValue(), 'matched');
  assert.match(await text(page, '#values .step-body'), /The table slides along with the foot/);
  await page.goBack();
  await page.locator('#verdict .headline .told.unstable').waitFor();
  clean();
});

test('the verdict follows a slider, and one drag is one step back', async () => {
  const { page, clean } = await open();
  const before = page.url();
  const slider = page.locator('#field-table-tilt_gain-slider');
  for (const value of [1.2, 1.3, 1.45])
    await slider.evaluate((element, to) => {
      element.value = String(to);
      element.dispatchEvent(new Event('input', { bubbles: true }));
    }, value);
  await page.locator('#verdict .headline .told.unstable').waitFor();
  await slide(page, '#field-table-tilt_gain-slider', 1.5);
  await page.waitForFunction(() => /tilt_gain=1\.5/.test(location.search));
  assert.match(
    plain(await page.locator('.drawing [role=img]').getAttribute('aria-label')),
    /the table tilts 0\.45 rad/,
  );
  await page.goBack();
  await page.waitForFunction((url) => location.href === url, before);
  assert.match(await verdict(page), /^● Yes/);
  clean();
});

test('a law is chosen from those compared, designed by other weights, and taken back', async () => {
  const { page, clean } = await open('?preset=case-1&scene.release.theta=0.05#controller');
  await page.locator('.laws tr', { hasText: 'designed' }).locator('.told.stable').waitFor();
  assert.match(await text(page, '.laws'), /Tilt gain, as it is[\s\S]*goes on[\s\S]*in use/);
  await page.locator('.laws tr', { hasText: 'designed' }).getByText('Friction above 0').waitFor();
  await page.getByRole('button', { name: 'Use it: State feedback, designed' }).click();
  assert.match(await verdict(page), /^● Yes: it comes to bounce in place/);
  const { gain } = await (await fetch(`${stage.url}v1/controllers?preset=case-1&scene.release.theta=0.05`)).json();
  assert.equal(Number(new URL(page.url()).searchParams.get('scene.table.feedback.theta')), gain.theta);
  await page.locator('.laws tr', { hasText: 'designed' }).getByText('in use').waitFor();
  await page.getByText('Design it by other weights').click();
  await page.locator('#design-sheet svg').waitFor();
  await enter(page, '#design-weights-theta', '40');
  await page.waitForFunction(() => /design\.weights\.theta=40/.test(location.search));
  await page.waitForFunction(
    (one) => !document.querySelector('#design-gains').textContent.includes(one),
    Math.abs(gain.theta).toPrecision(5),
  );
  await page.click('#design-run');
  await page.waitForFunction(
    (one) => Number(new URLSearchParams(location.search).get('scene.table.feedback.theta')) !== one,
    gain.theta,
  );
  await page.getByRole('button', { name: 'Use it: Tilt gain alone' }).click();
  assert.match(await verdict(page), /circles upright/);
  assert.doesNotMatch(page.url(), /feedback/);
  clean();
});

test('a body without an angle has no state feedback, and it is said', async () => {
  const { page } = await open('?preset=point-mass#controller');
  await page.locator('#controller', { hasText: 'angle of its own' }).waitFor();
});

test('a scene is taken from a file and given as one, and what is wrong in it is said', async () => {
  const { page, clean } = await open();
  await drop(page, JSON.stringify({ preset: 'case-4', scene: { table: { tilt_gain: 1.2 } } }), 'own.json');
  await page.waitForFunction(() => location.search === '?preset=case-4&scene.table.tilt_gain=1.2');
  await drop(
    page,
    JSON.stringify({ scene: { body: { point: true }, release: { height: 0.3 }, table: { tilt_gain: 0.4, kappa: 1 } } }),
    'other.json',
  );
  await page.locator('.notice', { hasText: 'table.kappa' }).waitFor();
  assert.equal(await page.inputValue('#case'), '');
  for (const [content, words] of [
    ['{', 'not JSON'],
    ['[1]', 'no scene'],
    ['{}', 'no scene'],
  ]) {
    await drop(page, content, 'wrong.json');
    await page.locator('.notice', { hasText: words }).waitFor();
  }
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '0.4', 'the rig is left as it was');
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#export')]);
  const scene = JSON.parse(await readFile(await saved.path(), 'utf8'));
  assert.equal(scene.table.tilt_gain, 0.4);
  await page.selectOption('#case', 'case-1');
  await page.setInputFiles('#scene-file', {
    name: 'rig.json',
    mimeType: 'application/json',
    buffer: Buffer.from(JSON.stringify(scene)),
  });
  await page.waitForFunction(() => /body\.point=true/.test(location.search));
  clean();
});

test('a link restores values, errors and parts of panels, and names what it drops', async () => {
  const { page } = await open(
    '?preset=case-1&scene.table.tilt_gain=1.15&have.table.delay=0.001&survival.runs=40&fit.unknown=gravity#noise',
  );
  await page.locator('#survival-told', { hasText: 'of 40 runs outlast' }).waitFor();
  assert.equal(await page.inputValue('#survival-runs'), '40');
  await limits(page);
  await page.waitForFunction(() => {
    const { top } = document.querySelector('#noise').getBoundingClientRect();
    return top >= 0 && top < innerHeight / 2;
  });
  assert.equal(await page.inputValue('#have-table-delay'), '1');
  await page.click('#save-link');
  const link = new URL(await page.evaluate(() => navigator.clipboard.readText()));
  assert.equal(link.searchParams.get('survival.runs'), '40');
  assert.equal(link.searchParams.get('fit.unknown'), 'gravity', 'also of a step that is not open');
  assert.match(await page.locator('#play').getAttribute('href'), /^\.\/\?preset=case-1&scene\.table\.tilt_gain=1\.15$/);
  const broken = await open('?preset=case-1&scene.table.kappa=2&have.table.delay=long#budget');
  assert.equal(await broken.page.locator('.notice li').count(), 2);
});

test('angles are in degrees where the reader wants them', async () => {
  const { page, clean } = await open();
  await limits(page);
  await page.click('#units');
  assert.equal(await page.inputValue('#field-release-theta'), '17.19');
  assert.match(await text(page, '.limit[data-field="table.errors.angle_bias"]'), /^Angle sensor reads 0\.000798° too/);
  await enter(page, ANGLE, '0.1');
  const has = Number(new URL(page.url()).searchParams.get('have.table.errors.angle_bias'));
  assert.ok(Math.abs(has - (0.1 * Math.PI) / 180) < 1e-12);
  await page.click('#units');
  assert.equal(await page.inputValue(ANGLE), '1.74533');
  clean();
});

test('a folded step tells its result, and a server that is gone is said until it is back', async () => {
  const { page } = await open();
  await limits(page);
  for (const id of ['values', 'verdict', 'budget']) await page.locator(`#${id} > details > summary`).click();
  assert.match(await text(page, '#values .result'), /Case 1: dropped at an angle: l 0\.133 m, e 1, μ 0, κ 1\.1$/);
  assert.match(await text(page, '#verdict .result'), /^● Yes: it circles upright/);
  assert.match(await text(page, '#budget .result'), /^◆ Check the friction first/);
  await stage.stopServer();
  await page.locator('#values > details > summary').click();
  await enter(page, '#field-table-tilt_gain', '1.2');
  await page.locator('#verdict .result', { hasText: 'the server does not answer' }).waitFor();
  await page.locator('#verdict > details > summary').click();
  assert.match(await text(page, '#verdict'), /It has not since .* and is asked again every 3 s/);
  assert.equal(await page.locator('#verdict .stable').count(), 0);
  await stage.startServer();
  assert.match(await page.locator('#verdict .headline .told.stable').innerText(), /Yes/);
});

test('each rig has its link, its frame, its job and its commands, and they answer', async () => {
  const { page, clean } = await open('?preset=case-1&scene.table.tilt_gain=1.2#watch');
  await page.locator('#calls-body code').first().waitFor();
  const codes = await page.locator('#watch code').allInnerTexts();
  assert.match(codes[1], /<iframe src="http.*embed\/scene\?preset=case-1&amp;scene\.table\.tilt_gain=1\.2"/);
  const [, target] = /targets: \['(.*)'\]/.exec(codes[2]);
  const gauges = await (await fetch(`${stage.url}v1/probe?target=${encodeURIComponent(target)}`)).text();
  assert.match(gauges, /equipoise_stability_verdict\{verdict_code="elliptic"\} 1/);
  for (const href of await page.locator('#calls-body a').evaluateAll((all) => all.map((link) => link.href)))
    assert.ok((await fetch(href)).ok, href);
  await page.getByLabel('Python').check();
  await page.waitForFunction(() => location.search.includes('calls.language=python'));
  assert.match(await text(page, '#calls-body'), /"scene\.table\.tilt_gain": "1\.2"/);
  await page.getByLabel('JavaScript').check();
  // It runs as it is, outside of the page.
  const code = await page.locator('#calls-body code').first().innerText();
  const AsyncFunction = Object.getPrototypeOf(async () => {}).constructor;
  const answer = await new AsyncFunction(code.replace(/console\.log\((.*)\);$/, 'return $1;'))();
  assert.equal(answer.scene.table.tilt_gain, 1.2);
  clean();
});

for (const [width, scheme] of [
  [1280, {}],
  [390, {}],
  [1280, { forcedColors: 'active' }],
]) {
  test(`axe finds nothing at ${width} px${scheme.forcedColors ? ' in forced colours' : ''}, nothing is cut off, and all text can be read`, async () => {
    const { page, clean } = await open('?preset=case-1-noise', { viewport: { width, height: 800 }, ...scheme });
    await limits(page);
    for (const id of ['controller', 'measurements', 'noise', 'watch'])
      await page.evaluate((step) => {
        location.hash = step;
      }, id);
    await page.locator('#survival-told', { hasText: 'outlast' }).waitFor();
    await page.locator('#calls-body code').first().waitFor();
    await page.locator('#fit-start').waitFor();
    await page.locator('details').evaluateAll((all) => {
      for (const one of all) one.open = true;
    });
    await page.locator('#design-sheet svg').waitFor();
    await drop(page, RIG);
    await page.locator('#overlay svg').first().waitFor();
    assert.deepEqual(await violations(page, 'main'), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
    const small = await page.evaluate(() =>
      [...document.querySelectorAll('main :not(sub, sup, tspan, svg *)')]
        .filter((one) => one.checkVisibility() && !one.closest('.unseen'))
        .filter((one) =>
          [...one.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim()),
        )
        .filter((one) => Number.parseFloat(getComputedStyle(one).fontSize) < 13)
        .map((one) => `${one.localName}.${one.className} ${one.textContent.slice(0, 30)}`),
    );
    assert.deepEqual(small, []);
    clean();
  });
}

test('links to the tabs that were lead to the steps', async () => {
  for (const [old, wanted] of [
    ['?preset=case-1-noise&tab=noise&survival.runs=40', 'rig?preset=case-1-noise&survival.runs=40#noise'],
    ['?preset=case-1&tab=control', 'rig?preset=case-1#controller'],
    ['?preset=case-1&fit.unknown=gravity', 'rig?preset=case-1&fit.unknown=gravity#measurements'],
    ['?tab=api&calls.language=python', 'rig?calls.language=python#watch'],
  ]) {
    const { page } = await open();
    await page.evaluate((search) => import('/paper/moved.js').then(({ go }) => void go(search)), old);
    await page.waitForURL(stage.url + wanted);
    await page.locator(`${wanted.slice(wanted.indexOf('#'))} > details[open]`).waitFor();
    assert.equal(await page.locator('#notices').innerText(), '');
  }
});
