// Downloads from a panel match the panel and the server's answer.

import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFile } from 'node:fs/promises';
import { promisify } from 'node:util';
import { test } from 'node:test';
import { Stage, changedRun, impacts, loadAll, numbers, showChart } from './stage.js';

const stage = await Stage.open();
const shell = promisify(execFile);

async function saved(page, name) {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    // The server's files are links, those that the page draws are buttons.
    page.locator('dialog.large').getByLabel(`Save as ${name}`).click(),
  ]);
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

const open = async (page, id) => {
  await showChart(page, id);
  await page.click(`#${id} .enlarge`);
};

/** Impacts that the table of a plot lists. */
const LISTED = 50;

test('the CSV of a plot is the API’s, bit for bit, and curl asks for the same: both have the impacts that the plot shows', async () => {
  const { page, clean } = await changedRun(stage);
  const last = await impacts(page);
  const shown = await numbers(page, 'plane-angle', Math.min(last, LISTED));
  await open(page, 'plane-angle');
  const { name, bytes } = await saved(page, 'CSV');
  assert.equal(name, 'equipoise-plane-angle.csv');
  const href = await page.locator('dialog.large').getByRole('link', { name: 'Save as CSV' }).getAttribute('href');
  assert.deepEqual(bytes, Buffer.from(await (await fetch(stage.url + href)).arrayBuffer()));
  const [head, ...rows] = bytes
    .toString()
    .trim()
    .split('\r\n')
    .map((line) => line.split(','));
  assert.equal(rows.length, last);
  const cell = (row, column, digits) => {
    const text = Number(row[head.indexOf(column)]).toFixed(digits);
    return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
  };
  assert.deepEqual(
    rows
      .toReversed()
      .slice(0, LISTED)
      .map((row) => [
        row[0],
        cell(row, 't_s', 4),
        cell(row, 'theta_rad', 6),
        cell(row, 'theta_dot_rad_per_s', 6),
        cell(row, 'alpha_rad', 6),
      ]),
    shown,
  );
  await page.keyboard.press('Escape');
  // The copied curl runs, and gives the data of the plots with all that was done to the run.
  const velocities = await numbers(page, 'plane-velocity', last);
  await open(page, 'plane-velocity');
  await page.locator('dialog.large').getByRole('button', { name: 'Copy curl' }).click();
  const command = await page.evaluate(() => navigator.clipboard.readText());
  assert.match(command, /^curl 'http/);
  const { stdout } = await shell('sh', ['-c', `${command} -s`]);
  const answer = JSON.parse(stdout);
  assert.equal(answer.impacts.n.length, last);
  assert.deepEqual(
    answer.impacts.x_dot.toReversed().map((value) => value.toFixed(6).replace('-', '−')),
    velocities.map((row) => row[2]),
  );
  clean();
});

/** The share of the pixels that differ between a drawing and a picture, smoothed letters and edges aside. */
function differing(page, svg, png) {
  return page.evaluate(
    async ([text, pixels]) => {
      const load = async (source) => {
        const image = new Image();
        image.src = source;
        await image.decode();
        return image;
      };
      const [drawn, seen] = [
        await load(`data:image/svg+xml;base64,${btoa(unescape(encodeURIComponent(text)))}`),
        await load(`data:image/png;base64,${pixels}`),
      ];
      const { width, height } = seen;
      const [one, other] = [drawn, seen].map((image) => {
        const canvas = Object.assign(document.createElement('canvas'), { width, height });
        const paper = canvas.getContext('2d');
        paper.drawImage(image, 0, 0, width, height);
        return paper.getImageData(0, 0, width, height).data;
      });
      let count = 0;
      for (let k = 0; k < one.length; k += 4)
        if (
          Math.abs(one[k] - other[k]) + Math.abs(one[k + 1] - other[k + 1]) + Math.abs(one[k + 2] - other[k + 2]) >
          120
        )
          count += 1;
      return count / (width * height);
    },
    [svg, png.toString('base64')],
  );
}

test('every plot is saved as SVG, with a mark for every impact, and as PNG, which looks the same', async () => {
  const { page, context, clean } = await changedRun(stage);
  const count = await impacts(page);
  for (const id of ['plane-angle', 'plane-velocity', 'energy', 'circle']) {
    await open(page, id);
    const svg = (await saved(page, 'SVG')).bytes.toString();
    const found = await page.evaluate((text) => {
      const file = new DOMParser().parseFromString(text, 'image/svg+xml');
      return {
        error: file.querySelector('parsererror')?.textContent ?? null,
        title: file.querySelector('title')?.textContent,
        texts: [...file.querySelectorAll('text')].map((one) => one.textContent),
        arcs: (text.match(/A[\d.]+ /g) ?? []).length,
        // Rings of impacts to come are not filled.
        dots: [...file.querySelectorAll('path[fill]:not([fill=none])')]
          .map((one) => (one.getAttribute('d').match(/A[\d.]+ /g) ?? []).length)
          .reduce((sum, some) => sum + some, 0),
        wild: /NaN|undefined|Infinity/.test(text),
      };
    }, svg);
    assert.deepEqual([found.error, found.wild], [null, false], id);
    assert.ok(found.title && found.texts.length > 6, `${id} has its axes`);
    // A dot is two arcs; changed values make dots of other shapes.
    if (id === 'energy') assert.ok(found.texts.includes('bounce'));
    // The eigenvalues are the server's picture: the unit circle, and a mark for each of them.
    if (id === 'circle') assert.ok((svg.match(/<circle /g) ?? []).length >= 4);
    else assert.ok(found.dots >= 6 && found.dots <= 2 * (count + 1), `${found.dots} arcs of dots`);
    const { name, bytes } = await saved(page, 'PNG');
    assert.equal(name, `equipoise-${id}.png`);
    assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
    if (id === 'circle') {
      await page.keyboard.press('Escape');
      continue;
    }
    const canvas = await page
      .locator(`#${id} canvas`)
      .first()
      .evaluate(({ width, height }) => [width, height]);
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], canvas);
    // On a page of its own policy.
    const sheet = await context.newPage();
    const share = await differing(sheet, svg, bytes);
    assert.ok(share < 0.01, `${share} of the pixels of ${id} differ`);
    await sheet.close();
    await page.keyboard.press('Escape');
  }
  clean();
});

test('panels open large, come back to their place and size with the focus where it was, and have all that they name to be saved', async () => {
  const { page, clean } = await stage.judged('?preset=case-1');
  const place = (id) =>
    page.evaluate((name) => {
      const { left, top, width, height } = document.getElementById(name).getBoundingClientRect();
      return [left, top + scrollY, width, height].map(Math.round);
    }, id);
  const comesBack = async (id) => {
    await showChart(page, id);
    const before = await place(id);
    await page.locator(`#${id} .enlarge`).focus();
    await page.keyboard.press('Enter');
    const dialog = page.locator('dialog.large');
    await dialog.waitFor();
    assert.ok((await dialog.boundingBox()).width > 1200, id);
    assert.equal(await dialog.locator(`#${id}`).count(), 1);
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'detached' });
    assert.deepEqual(await place(id), before, id);
    assert.equal(await page.evaluate(() => document.activeElement.className), 'enlarge');
  };
  await comesBack('plane-angle');
  await comesBack('circle');
  // The map fills its tab as it is.
  await loadAll(page, async (id) => {
    if (id !== 'map') await comesBack(id);
  });
  // All that they name to be saved is there.
  const paths = await page
    .locator('.lazy a[download]')
    .evaluateAll((links) => links.map((link) => link.getAttribute('href')));
  assert.ok(paths.length >= 15, `${paths.length}`);
  for (const path of paths) {
    const response = await fetch(stage.url + path);
    assert.equal(response.status, 200, path);
    assert.ok((await response.arrayBuffer()).byteLength > 100);
  }
  clean();
});
