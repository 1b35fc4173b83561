// A fit under way: its progress, the curve of its residual, and its cancelling.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { RIG, drop, fit, openRig, text } from './rig-steps.js';
import { Stage } from './stage.js';

const stage = await Stage.open();
const open = (query = '?preset=case-1') => openRig(stage, `${query}#measurements`);

/** From now on the page hears of each fit as many lines as it is given by `give`; `lines` are those to come. */
const holdLines = (page) =>
  page.evaluate(() => {
    const real = globalThis.fetch;
    globalThis.fetch = async (input, init) => {
      const response = await real(input, init);
      if (!String(input).includes('v1/fits')) return response;
      globalThis.lines = (await response.text()).trim().split('\n');
      const body = new ReadableStream({
        start: (control) => {
          init.signal.addEventListener('abort', () => control.error(init.signal.reason));
          globalThis.give = (count) => {
            for (const line of globalThis.lines.splice(0, count))
              control.enqueue(new TextEncoder().encode(`${line}\n`));
            if (globalThis.lines.length === 0) control.close();
          };
        },
      });
      return new Response(body, { headers: response.headers });
    };
  });

test('a fit under way can be cancelled', async () => {
  const { page, clean } = await open();
  await drop(page, RIG);
  let letGo = () => {};
  const held = new Promise((resolve) => {
    letGo = resolve;
  });
  await page.route('**/v1/fits?*', async (route) => {
    await held;
    await route.continue().catch(() => {});
  });
  await page.focus('#fit-start');
  await page.keyboard.press('Enter');
  await page.locator('#fit-told progress').waitFor();
  await page.locator('#fit-told', { hasText: 'Fitting…' }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-cancel');
  await page.keyboard.press('Enter');
  await page.locator('#fit-told', { hasText: 'Cancelled.' }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), 'fit-start');
  assert.ok(await page.locator('#fit-sheet').isHidden());
  letGo();
  await page.unroute('**/v1/fits?*');
  await fit(page);
  await page.locator('#fit-use').waitFor();
  // An answer that comes after a change is not offered.
  await page.route('**/v1/fits?*', async (route) => {
    await page.fill('#fit-sd-t', '0.002');
    await page.locator('#fit-sd-t').blur();
    await route.continue();
  });
  await page.click('#fit-start');
  await page.locator('#fit-used', { hasText: 'The data or the settings have changed since' }).waitFor();
  assert.ok(await page.locator('#fit-use').isHidden());
  clean();
});

test('the curve of the residual grows while it fits, and is kept after it', async () => {
  const { page, clean } = await open('?preset=case-1&fit.unknown=table.tilt_gain,body.radius_of_gyration');
  await drop(page, RIG);
  await holdLines(page);
  const curve = page.locator('#fit-convergence');
  const points = () =>
    curve
      .locator('svg :is(.way, .best)')
      .evaluateAll((all) => all.reduce((sum, one) => sum + one.getAttribute('d').split('L').length, 0));
  const begin = async (count) => {
    await page.evaluate(() => {
      globalThis.lines = undefined;
    });
    await page.click('#fit-start');
    await page.waitForFunction(() => globalThis.lines?.at(-1)?.startsWith('{"end"'));
    // A fit that is over at once shows no curve.
    await page.waitForTimeout(400);
    const steps = await page.evaluate(() => globalThis.lines.map((line) => JSON.parse(line).progress));
    await page.evaluate((lines) => globalThis.give(lines), count);
    await curve.locator('svg').waitFor();
    return steps;
  };
  const steps = await begin(30);
  const residuals = (count) => steps.slice(0, count).filter((step) => typeof step?.residual === 'number').length;
  assert.equal(await points(), residuals(30));
  assert.match(await text(page, '#fit-told'), /^Fitting… [a-z ]+\d?, iteration \d+, residual [\d.]+/);
  const bar = page.locator('#fit-told progress');
  const share = () => bar.evaluate(({ value, max }) => value / max);
  assert.ok(Math.abs((await share()) - steps[29].done / steps[29].of) < 1e-12);
  await page.evaluate(() => globalThis.give(20));
  await page.waitForFunction(
    ([count]) =>
      [...document.querySelectorAll('#fit-convergence svg :is(.way, .best)')].reduce(
        (sum, one) => sum + one.getAttribute('d').split('L').length,
        0,
      ) === count,
    [residuals(50)],
  );
  assert.ok((await share()) >= steps[29].done / steps[29].of);
  // A fit that is given up leaves no curve.
  await page.click('#fit-cancel');
  await page.locator('#fit-told', { hasText: 'Cancelled.' }).waitFor();
  await curve.waitFor({ state: 'hidden' });
  await begin(30);
  await page.evaluate(() => globalThis.give(1000));
  await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
  assert.ok(await curve.evaluate(({ open }) => !open), 'the curve is kept, and folded');
  const told = steps.filter((step) => typeof step?.residual === 'number');
  const rounded = (value) => Number(value.toPrecision(3));
  const [, first, last, iterations] =
    /residual ([\d.]+) at first, ([\d.]+) after (\d+) iterations/.exec(await text(page, '#fit-convergence summary')) ??
    [];
  assert.deepEqual([first, last, iterations].map(Number), [
    rounded(told[0].residual),
    rounded(told.at(-1).residual),
    told.at(-1).iterations,
  ]);
  await page.click('#fit-convergence summary');
  await curve.locator('svg').waitFor();
  assert.equal(await points(), told.length);
  await page.focus('#fit-convergence-box');
  await page.keyboard.press('Home');
  assert.match(await text(page, '#fit-convergence-readout'), /^numbers of the bounces, iteration 0, residual [\d.]+/);
  await page.keyboard.press('End');
  assert.match(
    await text(page, '#fit-convergence-readout'),
    new RegExp(`^outliers, iteration ${iterations}, residual ${last}`),
  );
  // A fit without an answer leaves the curve of the answer that is shown.
  await drop(page, 't,theta\n0,0.1\n0.2,0\n0.4,-0.1\n', 'short.csv');
  await page.click('#fit-start');
  await page.waitForFunction(() => globalThis.lines?.at(-1)?.startsWith('{"problem"'));
  await page.evaluate(() => globalThis.give(1000));
  await page.locator('#fit-data-error', { hasText: 'There are 6 values' }).waitFor();
  assert.equal(await points(), told.length);
  clean();
});
