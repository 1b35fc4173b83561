// The planes beside the run's own dots: impacts to come as rings, runs to compare with, a release that is offered before it runs.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, enter, ink, inkOf, reachImpact, reachPhase, speedUp, runTo, boxOf, releaseTo } from './stage.js';

const stage = await Stage.open();
const spoken = (page, words) => page.locator('#impacts-spoken', { hasText: words }).waitFor({ state: 'attached' });

/** How many pixels of a plot's upper canvas have a colour of the style sheet, within the frame of its axes. */
async function above(page, id, property) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return inkOf(page.locator(`#${id} canvas`).nth(1), property, { margins: [45, 25, 54, 62], opacity: 90 });
}

/** The page with its plots reachable, as the parts of the page reach them. */
async function open(query = '?preset=case-1', options = {}) {
  const opened = await stage.page(`${query}&tab=why`, options);
  await opened.page.locator('#plane-angle .canvas-box[aria-describedby]').waitFor();
  return opened;
}

/** Two planes of impacts of their own, beside those of the page. */
async function bench(page) {
  await page.evaluate(async () => {
    const [{ Impacts, COLUMNS }, { anglePlane }] = await Promise.all([
      import('./run/impacts.js'),
      import('./charts/impacts/plots.js'),
    ]);
    const impacts = new Impacts();
    const plot = anglePlane(impacts);
    plot.figure.element.id = 'own';
    document.querySelector('#charts').append(plot.figure.element);
    const columns = { n: [], theta: [], theta_dot: [] };
    for (let n = 1; n <= 200; n += 1) {
      columns.n.push(n);
      columns.theta.push(0.3 * Math.cos(n));
      columns.theta_dot.push(1.1 * Math.sin(n));
    }
    const rowOf = (values) => ({ ...Object.fromEntries(COLUMNS.map((name) => [name, 0])), ...values });
    Object.assign(globalThis, {
      plot,
      /** A run of these impacts, with another angle. */
      runOf: (factor = 1) => {
        const own = new Impacts(columns.n.length);
        for (const [row, n] of columns.n.entries())
          own.append(rowOf({ n, theta: columns.theta[row] * factor, theta_dot: columns.theta_dot[row] }));
        return { impacts: own };
      },
      strike: (count, aside = 0) => {
        for (let k = 0; k < count; k += 1) {
          const n = impacts.end + 1;
          impacts.append(rowOf({ n, theta: 0.3 * Math.cos(n) + aside, theta_dot: 1.1 * Math.sin(n) }));
        }
        plot.draw(performance.now());
      },
    });
  });
  await page.locator('#own').scrollIntoViewIfNeeded();
  await page.waitForFunction(() => globalThis.plot.layers[0].width > 0);
}

const scales = (page) => page.evaluate(() => [globalThis.plot.frame.x, globalThis.plot.frame.y]);
const settled = (page) => page.waitForTimeout(150);

test('impacts to come are rings with a legend, and give way to the dots of the same run only', async () => {
  const { page, clean } = await open();
  await bench(page);
  assert.equal(await above(page, 'own', '--muted'), 0);
  await page.evaluate(() => globalThis.plot.preview(globalThis.runOf()));
  await settled(page);
  const rings = await above(page, 'own', '--muted');
  assert.ok(rings > 400, `rings: ${rings}`);
  assert.equal(await ink(page, '#own', '--series-0'), 0, 'no ring is a dot');
  const before = await scales(page);
  // The same run: each dot takes the place of its ring.
  await page.evaluate(() => globalThis.strike(100));
  const half = await above(page, 'own', '--muted');
  assert.ok(half < 0.65 * rings && half > 0.35 * rings, `${half} of ${rings}`);
  assert.ok((await ink(page, '#own', '--series-0')) > 300);
  assert.deepEqual(await scales(page), before, 'the axes stay');
  // Another run leaves the rest as it is.
  await page.evaluate(() => globalThis.strike(60, 0.01));
  const other = await above(page, 'own', '--muted');
  assert.ok(other > 0.9 * half, `${other} of ${half}`);
  await page.evaluate(() => globalThis.plot.preview(null));
  await settled(page);
  assert.ok((await above(page, 'own', '--muted')) < 60);
  clean();
});

test('the axes hold rings and dots, and do not jump while a slider moves', async () => {
  const { page, clean } = await open();
  await bench(page);
  const seen = new Set();
  for (let step = 0; step <= 20; step += 1) {
    await page.evaluate((factor) => globalThis.plot.preview(globalThis.runOf(factor)), 1 - step * 0.02);
    await page.waitForTimeout(20);
    seen.add(JSON.stringify(await scales(page)));
  }
  assert.ok(seen.size <= 2, [...seen].join('\n'));
  const wide = JSON.parse([...seen].at(-1));
  await page.evaluate(() => globalThis.plot.preview(globalThis.runOf(4)));
  await settled(page);
  const [x] = await scales(page);
  assert.ok(x.high >= 1.2 && x.high > wide[0].high, 'a larger orbit is held at once');
  await page.evaluate(() => globalThis.plot.preview(globalThis.runOf(0.1)));
  await settled(page);
  assert.ok((await scales(page))[0].high < 0.2, 'a far smaller one does not stay a speck');
  clean();
});

test('runs to compare with have their own symbols and colours, and a legend', async () => {
  const { page, clean } = await open();
  await bench(page);
  await page.evaluate(() => {
    const { plot, runOf } = globalThis;
    plot.references([
      { run: runOf(), symbol: '■', colour: 'series-1', label: 'B' },
      { run: runOf(-0.5), symbol: '▲', colour: 'series-2', label: 'C' },
    ]);
  });
  await settled(page);
  assert.ok((await scales(page))[0].high >= 0.3);
  for (const colour of ['--series-1', '--series-2']) {
    const far = await inkOf(page.locator('#own canvas').first(), colour, { opacity: 120, off: 20 });
    assert.ok(far > 300, `${colour}: ${far}`);
  }
  // Its name is spoken anew once a second.
  await page.waitForTimeout(1100);
  await page.evaluate(() => globalThis.plot.redraw());
  await page.locator('#own .canvas-box[aria-label*="dots of B"]').waitFor();
  await page.evaluate(() => {
    globalThis.plot.references([]);
  });
  await settled(page);
  assert.equal(await ink(page, '#own', '--series-1'), 0);
  clean();
});

test('before a run the planes show the impacts to come of what is typed; the run puts its dots in their place', async () => {
  const { page, clean } = await open();
  const rings = () => above(page, 'plane-angle', '--muted');
  await page.locator('#plane-angle .canvas-box[aria-label*="Rings"]').waitFor();
  assert.equal(await ink(page, '#plane-angle', '--series-0'), 0);
  const all = await rings();
  await speedUp(page);
  await runTo(page, 90);
  const left = await rings();
  assert.ok(left < 0.75 * all, `${left} of ${all}`);
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > 200);
  clean();
});

test('dots are larger while they are presented', async () => {
  const { page, clean } = await open();
  await bench(page);
  await page.evaluate(() => globalThis.strike(60));
  const before = await ink(page, '#own', '--series-0');
  await page.evaluate(() => document.documentElement.classList.add('presenting'));
  await settled(page);
  assert.ok((await ink(page, '#own', '--series-0')) > 1.8 * before);
  clean();
});

test('a click offers a release with its values and impacts; its button, Enter and a second click release it', async () => {
  const { page, clean } = await open();
  const state = () => page.locator('#run-state').getAttribute('data-phase');
  const { x, y, width, height } = await boxOf(page, 'plane-angle');
  const place = [x + width * 0.6, y + height * 0.42];
  const before = page.url();
  for (const release of [
    () => page.click('#ghost-release'),
    () => page.keyboard.press('Enter'),
    () => page.mouse.click(...place),
  ]) {
    const asked = page.waitForResponse((response) => /trajectories.*theta=/.test(response.url()));
    await page.mouse.click(...place);
    await spoken(page, /^θ₀ .*Enter releases there/);
    assert.match(await page.locator('.ghost').innerText(), /θ₀.*rad.*θ̇₀.*rad\/s/s);
    assert.equal((await (await asked).json()).impacts.n.length, 200);
    await page.waitForFunction(() => {
      const canvas = document.querySelectorAll('#plane-velocity canvas')[1];
      const copy = Object.assign(document.createElement('canvas'), {
        width: canvas.width,
        height: canvas.height,
      }).getContext('2d', { willReadFrequently: true });
      copy.drawImage(canvas, 0, 0);
      return copy.getImageData(0, 0, canvas.width, canvas.height).data.some((value) => value > 0);
    });
    assert.equal(await state(), 'idle', 'nothing runs yet');
    assert.equal(page.url(), before, 'nor is the address another one');
    await release();
    await spoken(page, /Released anew/);
    await reachImpact(page, 1);
    assert.equal(await page.locator('.ghost').count(), 0);
    await page.goBack();
    await reachPhase(page, 'idle');
  }
  clean();
});

test('Escape, the cross, a click elsewhere and an edit drop what is offered', async () => {
  const { page, clean } = await open();
  const click = async (across, down) => {
    const { x, y, width, height } = await boxOf(page, 'plane-velocity');
    await page.mouse.click(x + width * across, y + height * down);
    await page.locator('.ghost', { hasText: 'Release here' }).waitFor();
  };
  for (const drop of [
    () => page.keyboard.press('Escape'),
    () => page.click('.ghost-drop'),
    () => page.click('#plane-velocity h3'),
    () => enter(page, '#field-release-theta', '0.21'),
  ]) {
    await click(0.6, 0.6);
    await drop();
    await page.locator('.ghost').waitFor({ state: 'detached' });
  }
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  // Another click moves it instead.
  await click(0.6, 0.6);
  const first = await page.locator('.ghost p').innerText();
  await click(0.4, 0.75);
  assert.notEqual(await page.locator('.ghost p').innerText(), first);
  assert.equal(await page.locator('.ghost').count(), 1);
  clean();
});

test('a release is offered with keys alone, beside a run that goes on', async () => {
  const { page, clean } = await open();
  await speedUp(page);
  await releaseTo(page, 5);
  await page.locator('#plane-angle .canvas-box').focus();
  await page.keyboard.press('Home');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  await spoken(page, /Enter releases there/);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'running');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'ghost-release');
  await page.keyboard.press('Escape');
  assert.equal(await page.evaluate(() => document.activeElement.className), 'canvas-box');
  await page.keyboard.press('Enter');
  await page.keyboard.press('Enter');
  await spoken(page, /Released anew/);
  await page.waitForFunction(() => /scene\.release\.theta=/.test(location.search));
  clean();
});
