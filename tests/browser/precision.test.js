// Speed against accuracy, a chapter of the paper's page: measured when asked, the server's numbers, by pointer and by keys.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, answersOf, free, measure, plain, cellsOf } from './stage.js';

const stage = await Stage.open();

async function open(query, options) {
  const opened = await stage.page(`${query}#precision`, { path: 'paper', sign: '#precision-start', ...options });
  return { ...opened, answers: await answersOf(opened.page, 'v1/precision?') };
}

const marks = (page) => page.locator('#precision-box [data-mark]').count();

test('it is measured when somebody asks, and shows every point that has an error', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  assert.equal((await answers()).length, 0);
  assert.ok(await page.locator('.precision-sheet').isHidden());
  await measure(page, 20);
  assert.equal((await answers()).length, 1);
  const { points, methods, reference } = (await answers())[0];
  assert.equal(reference.outcome.bounces, 20);
  const drawn = (cost) => points.filter((point) => point.error !== null && cost(point) > 0);
  assert.equal(await marks(page), drawn((point) => point.cost_ns_per_bounce).length);
  // Costs rise to the right and errors upwards: the order on the screen is that of the numbers.
  const places = await page.locator('#precision-box [data-mark]').evaluateAll((all) =>
    all.map((one) => {
      const { x, y, width, height } = one.getBBox();
      return [x + width / 2, y + height / 2];
    }),
  );
  const timed = drawn((point) => point.cost_ns_per_bounce);
  const [left, right] = [
    places.findIndex(([x]) => x === Math.min(...places.map(([h]) => h))),
    places.findIndex(([, y]) => y === Math.min(...places.map(([, v]) => v))),
  ];
  assert.equal(timed[right].error, Math.max(...timed.map(({ error }) => error)));
  assert.ok(timed[left].cost_ns_per_bounce <= 1.2 * Math.min(...timed.map((point) => point.cost_ns_per_bounce)));
  assert.equal(await page.locator('#precision-box [data-curve=front]').count(), 1);
  await page.locator('.precision-sheet summary', { hasText: 'Methods' }).click();
  const listed = await page.locator('.methods li').allInnerTexts();
  assert.equal(listed.length, methods.length);
  for (const [index, { title }] of methods.entries()) assert.ok(listed[index].startsWith(title), listed[index]);
  await page.locator('.precision-sheet summary', { hasText: 'Numbers' }).click();
  const rows = await cellsOf(page, '.precision-sheet');
  assert.equal(rows.length, points.length);
  assert.deepEqual(
    rows.map((row) => Number(plain(row[4]).replaceAll(' ', ''))).filter((steps) => steps < 1e6),
    points.map(({ steps }) => steps).filter((steps) => steps < 1e6),
  );
  await page.selectOption('#precision-axis', 'evaluations');
  assert.equal(await marks(page), drawn((point) => point.evaluations).length);
  assert.match(
    await page.locator('#precision-links a', { hasText: 'SVG' }).getAttribute('href'),
    /bounces=20&axis=evaluations&format=svg$/,
  );
  await page.selectOption('#precision-axis', 'steps');
  assert.equal(await marks(page), drawn((point) => point.steps).length);
  assert.equal(await page.locator('#precision-box [data-curve=front]').count(), 0);
  assert.equal((await answers()).length, 1, 'another axis is no other measurement');
  clean();
});

test('pointer and keys read the points', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  await measure(page, 20);
  const { points, methods } = (await answers())[0];
  const readout = async () => plain(await page.locator('#precision-readout').innerText());
  const title = (name) => methods.find((method) => method.name === name).title;
  const timed = points.filter((point) => point.error !== null && point.cost_ns_per_bounce > 0);
  await page.focus('#precision-box');
  await page.keyboard.press('Home');
  assert.ok((await readout()).startsWith(title(timed[0].method)));
  await page.keyboard.press('End');
  const last = timed.at(-1);
  assert.ok(
    (await readout()).startsWith(title(last.method)) && (await readout()).includes(last.setting.name),
    await readout(),
  );
  await page.keyboard.press('ArrowUp');
  assert.ok(!(await page.locator('.precision-sheet .unseen').innerText()).startsWith(title(last.method)));
  await page.keyboard.press('Escape');
  assert.equal(await readout(), '');
  await page.locator('#precision-box').scrollIntoViewIfNeeded();
  const box = await page.locator('#precision-box [data-mark]').first().boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  assert.match(await readout(), /ns a bounce.*steps.*error/);
  assert.ok(await page.locator('#precision-box .pointed').isVisible());
  clean();
});

test('it counts what is done, can be cancelled, and says when the scene is another one', async () => {
  const { page, answers, clean } = await open('?preset=case-1');
  await page.fill('#precision-impacts', '1000');
  await page.click('#precision-start');
  await page.waitForFunction(() => document.querySelector('#precision-told progress').value > 3);
  const [value, most, words] = await page
    .locator('#precision-told')
    .evaluate((told) => [told.querySelector('progress').value, told.querySelector('progress').max, told.innerText]);
  assert.ok(value < most && most > 50);
  assert.match(words, new RegExp(`^Measuring… ${value} of ${most} parts$`));
  await page.click('#precision-cancel');
  await page.locator('#precision-told', { hasText: 'Cancelled.' }).waitFor();
  await free(stage);
  assert.ok(await page.locator('#precision-start').isEnabled());
  await page.fill('#precision-impacts', '1001');
  await page.click('#precision-start');
  assert.match(await page.locator('#precision-impacts-error').innerText(), /from 1 to 1000/);
  await measure(page);
  const before = (await answers()).length;
  await page.selectOption('#scene', 'case-2');
  await page.locator('#precision-told', { hasText: 'has changed' }).waitFor();
  assert.equal((await answers()).length, before);
  clean();
});

test('its settings are in the address, and what is broken of them is dropped in words', async () => {
  const { page, clean } = await open('?preset=case-1&precision.impacts=7&precision.axis=steps');
  assert.deepEqual(
    [await page.inputValue('#precision-impacts'), await page.inputValue('#precision-axis')],
    ['7', 'steps'],
  );
  await page.fill('#precision-impacts', '100');
  await page.press('#precision-impacts', 'Tab');
  await page.selectOption('#precision-axis', 'evaluations');
  await page.waitForFunction(() => location.search.includes('evaluations'));
  assert.equal(new URL(page.url()).search, '?preset=case-1&precision.axis=evaluations');
  clean();
  const broken = await open('?preset=case-1&precision.impacts=0&precision.axis=luck');
  const words = await broken.page.locator('#notices').innerText();
  for (const said of [
    'impacts “0”: it must be a whole number from 1 to 1000',
    'axis “luck”: it must be one of time, evaluations, steps',
  ])
    assert.ok(words.includes(`precision.${said}`), words);
  assert.deepEqual(
    [await broken.page.inputValue('#precision-impacts'), await broken.page.inputValue('#precision-axis')],
    ['100', 'time'],
  );
  broken.clean();
});

test('what the server refuses is told, and it can be asked again', async () => {
  const { page } = await open('?preset=case-1', {
    watch: (page) => page.route(/v1\/precision/, (route) => route.abort()),
  });
  await page.fill('#precision-impacts', '10');
  await page.click('#precision-start');
  await page.locator('#precision-told', { hasText: 'The server does not answer' }).waitFor();
  await page.unroute(/v1\/precision/);
  await measure(page);
});
