// Studies answer first: a number or a sentence before the picture, old answers dimmed, calls for three languages.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, answersOf, enter, openPanel, verdict } from './stage.js';

const stage = await Stage.open();
const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');

async function open(id, query = '?preset=case-1') {
  const opened = await stage.page(query);
  await verdict(opened.page);
  await openPanel(opened.page, id);
  return opened;
}

test('noise begins with the number, and dims it when the scene is another one', async () => {
  const { page, clean } = await open('survival', '?preset=case-1-noise&survival.runs=40&survival.impacts=120');
  const answers = await answersOf(page, 'v1/ensembles?');
  await page.click('#survival-start');
  await page.locator('#survival-told', { hasText: 'outlast' }).waitFor();
  const { survived } = (await answers())[0];
  const [share, lower, upper] = [survived.share, survived.lower, survived.upper].map((value) =>
    Math.round(100 * value),
  );
  const words = plain(await page.locator('#survival-headline').innerText());
  assert.equal(words, `${share} % last 120 bounces, ${lower} to ${upper} % with 95 % confidence.`);
  const opacity = () => page.locator('#survival-box svg').evaluate((svg) => Number(getComputedStyle(svg).opacity));
  assert.equal(await opacity(), 1);
  await enter(page, '#field-release-theta', '0.1');
  await page.locator('#survival-start', { hasText: 'Run again' }).waitFor();
  assert.ok((await opacity()) < 0.5, 'the old curve is dimmed');
  await page.click('#survival-start');
  await page.locator('#survival-start', { hasText: 'Run them all' }).waitFor();
  await page.waitForFunction(() => !document.querySelector('.survival-sheet').classList.contains('stale'));
  assert.equal(await opacity(), 1);
  clean();
});

test('a law of another scene is dimmed and not offered to run', async () => {
  const { page, clean } = await open('design');
  assert.ok(await page.locator('#design-run').isHidden());
  await page.click('#design-start');
  await page.locator('#design-sheet svg.figure').waitFor();
  const [run, figure, card] = await Promise.all(
    ['#design-run', '#design-sheet svg.figure', '#design'].map((one) => page.locator(one).boundingBox()),
  );
  assert.ok(run.y < figure.y, 'what to press stands above the picture');
  assert.ok(figure.width > 0.9 * card.width, 'the picture is as wide as its card');
  await enter(page, '#field-release-height', '0.25');
  await page.locator('#design-run').waitFor({ state: 'hidden' });
  assert.ok(await page.locator('#design-sheet').evaluate((sheet) => sheet.classList.contains('stale')));
  await page.click('#design-start');
  await page.locator('#design-run').waitFor();
  clean();
});

test('orbits begin with a sentence', async () => {
  const { page, clean } = await open('branch');
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

test('calls are told for a shell, Python and JavaScript, and the choice is in the address', async () => {
  const { page, clean } = await open('calls');
  const call = page.locator('.call').first();
  assert.match(await call.locator('code').innerText(), /^curl 'http/);
  await page.getByLabel('Python').check();
  assert.match(await call.locator('code').innerText(), /^from urllib\.parse import urlencode/);
  await page.waitForFunction(() => location.search.includes('calls.language=python'));
  await page.getByLabel('JavaScript', { exact: true }).check();
  await call.getByRole('button', { name: /^Copy JavaScript/ }).click();
  const text = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(text, (await call.locator('code').innerText()).trim());
  // It runs as it is, outside of the page, and gives what the page shows.
  const AsyncFunction = Object.getPrototypeOf(async () => {}).constructor;
  const answer = await new AsyncFunction(text.replace(/console\.log\((.*)\);$/, 'return $1;'))();
  assert.deepEqual(answer, await (await fetch(`${stage.url}v1/stability?preset=case-1`)).json());
  await page.waitForFunction(() => location.search.includes('calls.language=javascript'));
  const second = await stage.page(new URL(page.url()).search);
  await second.page.locator('.call code', { hasText: 'URLSearchParams' }).first().waitFor();
  second.clean();
  clean();
});
