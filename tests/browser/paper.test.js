// The paper as a page: its chapters, what is printed beside what is computed, the failures, links into it, and a scan that stays in the browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import { Stage, reachPhase } from './stage.js';

const stage = await Stage.open();

/** @param {string} address after `paper` */
const open = (address = '', options = {}) =>
  stage.page(address, { path: 'paper', sign: '#reading article', ...options });

const { items } = await (await fetch(`${stage.url}v1/paper`)).json();
const { items: failures } = await (await fetch(`${stage.url}v1/failures`)).json();
const { items: scenes } = await (await fetch(`${stage.url}v1/scenes`)).json();
/** Symbols are set as such, so only the letters and digits are compared. */
const letters = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '');

/** All chapters are there. */
async function whole(page) {
  for (const chapter of ['paper', 'gallery', 'precision', 'ladder'])
    await page.locator(`#${chapter}`).evaluate((element) => element.scrollIntoView());
  await page.locator('#gallery article').first().waitFor();
  await page.locator('#ladder .rungs td').first().waitFor();
  await page.locator('#precision-start').waitFor();
}

test('each item of the paper is there, in its section, with what is printed and computed', async () => {
  const { page, clean } = await open();
  assert.equal(await page.locator('#reading article').count(), items.length);
  for (const [id, { section }] of items.map((item) => [item.id, item]))
    assert.equal(letters(await page.locator(`section:has(> #${id}) > h2`).innerText()), letters(section), id);
  const text = await page.locator('#eigenvalues').innerText();
  assert.match(text, /0\.33409[\s\S]*0\.8[\s\S]*≠/);
  assert.match(text, /needs 2ẏ\*√l/);
  assert.equal(await page.locator('#reading h3 .chip.differs').count(), items.filter(({ agrees }) => !agrees).length);
  await page.locator('#paper').evaluate((element) => element.scrollIntoView());
  for (const { name, computed } of scenes.filter((one) => one.computed.length > 0)) {
    const told = letters(await page.locator(`#case-${name}`).innerText());
    for (const { why } of computed) assert.ok(told.includes(letters(why ?? '')), `${name}: ${why}`);
  }
  clean();
});

test('an item runs in the place of play, and asks the server', async () => {
  const { page, clean } = await open();
  for (const href of await page
    .getByRole('link', { name: /^Ask the server/ })
    .evaluateAll((all) => all.map((a) => a.href)))
    assert.ok((await fetch(href)).ok, href);
  // Pictures that come in move the links, so the keys are surer than the pointer.
  await page.getByRole('link', { name: 'Run it: Case 3: the swings grow until it falls' }).press('Enter');
  await page.locator('#field-table-tilt_gain').waitFor({ state: 'attached' });
  assert.equal(Number(new URL(page.url()).searchParams.get('scene.table.tilt_gain')), 1.55);
  await page.click('#run');
  await reachPhase(page, 'running');
  clean();
});

test('a figure is drawn when it comes near, and for print', async () => {
  const { page, clean } = await open();
  const figure = page.locator('#figure-12 svg.figure');
  assert.equal(await figure.count(), 0);
  await page.locator('#figure-12').scrollIntoViewIfNeeded();
  await figure.waitFor();
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  const pictures = items.filter(({ picture }) => picture).length;
  await page.waitForFunction((count) => document.querySelectorAll('#reading svg.figure').length === count, pictures);
  clean();
});

test('the contents lead to every chapter, and a link to its place', async () => {
  const { page, clean } = await open('#failure-zeno');
  const inView = (id) =>
    page.waitForFunction((name) => {
      const { top } = document.getElementById(name)?.getBoundingClientRect() ?? { top: -1 };
      return top >= 0 && top < innerHeight;
    }, id);
  await inView('failure-zeno');
  for (const anchor of await page.locator('#contents a').evaluateAll((all) => all.map((a) => a.hash.slice(1))))
    assert.equal(await page.locator(`[id="${anchor}"]`).count(), 1, anchor);
  for (const [old, place] of [
    ['?preset=case-1&tab=paper&reading.item=eigenvalues', 'eigenvalues'],
    ['?preset=case-1&gallery.case=chaos', 'failure-chaos'],
    ['?preset=case-1&tab=limits', 'gallery'],
    ['?preset=case-1&tab=models', 'ladder'],
    ['?preset=case-2&tab=accuracy&precision.axis=steps', 'precision'],
  ]) {
    await page.goto(stage.url + old);
    await page.waitForURL(/\/paper/);
    assert.equal(new URL(page.url()).hash, `#${place}`);
    await inView(place);
  }
  assert.equal(await page.inputValue('#scene'), 'case-2');
  assert.equal(await page.inputValue('#precision-axis'), 'steps');
  clean();
});

test('every failure has right and wrong in words, with its picture', async () => {
  const { page, clean } = await open('#gallery');
  const cards = page.locator('#gallery article');
  await cards.first().waitFor();
  assert.equal(await cards.count(), failures.length);
  for (const [index, { title, why, says, truth }] of failures.entries()) {
    const card = cards.nth(index);
    const text = letters(await card.innerText());
    const claims = says.flatMap(({ method, text, detail, right }) => [method, text, right ? 'right' : 'wrong', detail]);
    for (const words of [title, why, truth.text, truth.detail, ...claims])
      assert.ok(text.includes(letters(words)), `${title}: ${words}`);
  }
  for (const image of await page.locator('#gallery img').all()) {
    await image.scrollIntoViewIfNeeded();
    await image.evaluate((element) => element.decode());
    assert.ok(await image.evaluate((element) => element.naturalWidth > 300));
  }
  clean();
});

test('a scan lies beside the computed figure or over it, moves by keys, and leaves the browser never', async () => {
  const { page, clean } = await open('#figure-5');
  const figure = page.locator('#figure-5');
  await figure.locator('svg.figure').waitFor();
  const bytes = await page.evaluate(async () => {
    const canvas = Object.assign(document.createElement('canvas'), { width: 40, height: 20 });
    const context = canvas.getContext('2d');
    context.fillStyle = '#ff0000';
    context.fillRect(0, 0, 40, 20);
    const blob = await new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
    return [...new Uint8Array(await blob.arrayBuffer())];
  });
  const sent = [];
  page.on('request', (request) => {
    if (request.method() !== 'GET') sent.push(request.url());
  });
  await figure.locator('summary', { hasText: 'scan' }).click();
  const file = figure.locator('input[type=file]');
  await file.setInputFiles({ name: 'fig5.png', mimeType: 'image/png', buffer: Buffer.from(bytes) });
  const scan = figure.locator('canvas.scan');
  await scan.waitFor();
  const red = () => scan.evaluate((canvas) => [...canvas.getContext('2d').getImageData(5, 5, 1, 1).data]);
  assert.deepEqual(await red(), [255, 0, 0, 255]);
  assert.ok(await figure.locator('.scan-beside canvas').isVisible());
  await figure.getByLabel('Over the computed picture').check();
  assert.ok(await figure.locator('.scan-layer canvas').isVisible());
  const place = () => scan.evaluate((canvas) => canvas.getBoundingClientRect().x);
  const before = await place();
  await scan.focus();
  await page.keyboard.press('Shift+ArrowRight');
  assert.ok((await place()) > before + 1);
  await file.setInputFiles({ name: 'text.png', mimeType: 'image/png', buffer: Buffer.from('no picture') });
  await figure.locator('[role=status]', { hasText: 'not a picture' }).waitFor();
  await figure.getByRole('button', { name: 'Remove the scan' }).click();
  assert.equal(await figure.locator('canvas.scan:visible').count(), 0);
  assert.deepEqual(sent, []);
  clean();
});

test('a chapter that the server does not answer can be asked for again', async () => {
  const { page } = await open('', {
    watch: (page) => page.route(/v1\/failures/, (route) => route.abort()),
  });
  await page.locator('#gallery').evaluate((element) => element.scrollIntoView());
  await page.locator('#gallery', { hasText: 'The server does not answer' }).waitFor();
  await page.unroute(/v1\/failures/);
  await page.locator('#gallery button').click();
  await page.locator('#gallery article').first().waitFor();
});

for (const [width, colorScheme] of [
  [390, 'light'],
  [1280, 'dark'],
])
  test(`axe finds nothing and nothing is too wide: ${width} px, ${colorScheme}`, async () => {
    const { page, clean } = await open('', { viewport: { width, height: 800 }, colorScheme });
    await whole(page);
    assert.deepEqual(await violations(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
    clean();
  });
