// The paper item by item: filters, what unfolds, running an item, links to one, and a scan that stays in the browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, reachPhase, verdict } from './stage.js';

const stage = await Stage.open();

/** A picture of one colour, as PNG. */
const picture = (page, colour) =>
  page.evaluate(async (fill) => {
    const canvas = Object.assign(document.createElement('canvas'), { width: 40, height: 20 });
    const context = canvas.getContext('2d');
    context.fillStyle = fill;
    context.fillRect(0, 0, 40, 20);
    const blob = await new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
    return [...new Uint8Array(await blob.arrayBuffer())];
  }, colour);

test('each item of the paper is there with what is printed and computed', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=paper');
  const { items } = await (await fetch(`${stage.url}v1/paper`)).json();
  await page.locator('.reading-items > li').first().waitFor();
  const shown = () => page.locator('.reading-items > li:visible').count();
  assert.equal(await shown(), items.length);
  await page.getByLabel(/^Differs/).check();
  assert.equal(await shown(), items.filter(({ agrees }) => !agrees).length);
  await page.locator('#reading-eigenvalues > summary').click();
  const text = await page.locator('#reading-eigenvalues').innerText();
  const { checks } = items.find(({ id }) => id === 'eigenvalues');
  assert.equal(checks[1].computed.toFixed(1), '0.8');
  assert.match(text, /0\.33409[\s\S]*0\.8[\s\S]*≠/);
  assert.match(text, /needs 2ẏ\*√l/);
  await page.waitForFunction(() => /reading\.item=eigenvalues/.test(location.search));
  await page.getByRole('button', { name: 'Run it: The eigenvalues of the angle' }).click();
  await reachPhase(page, 'running');
  clean();
});

test('a link opens its item, and one to no item is told of', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=paper&reading.item=figure-7');
  await page.locator('#reading-figure-7[open] svg.figure').waitFor();
  clean();
  const other = await stage.page('?preset=case-1&tab=paper&reading.item=eq-99');
  await other.page.locator('#reading-body', { hasText: 'no item of the paper' }).waitFor();
  other.clean();
});

test('a scan lies beside the computed figure or over it, moves by keys, and leaves the browser never', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=paper&reading.item=figure-5');
  await verdict(page);
  const figure = page.locator('#reading-figure-5');
  await figure.locator('svg.figure').waitFor();
  const bytes = await picture(page, '#ff0000');
  const sent = [];
  page.on('request', (request) => {
    if (request.method() !== 'GET') sent.push(request.url());
  });
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
