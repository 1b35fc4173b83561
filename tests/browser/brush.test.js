// The charts of the impacts as one: a brush selects in all of them, a click says where a run first lands, a hundred thousand dots draw at once.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { angleStart, velocityStart, within } from '../../web/physics/first-impact.js';
import { Stage, ink, numbers, reachImpact, reachPhase, speedUp, runTo, boxOf, releaseTo } from './stage.js';

const stage = await Stage.open();

const spoken = (page, words) => page.locator('#impacts-spoken', { hasText: words }).waitFor({ state: 'attached' });
const told = (page, words) => page.locator('#brush-told', { hasText: words }).waitFor();
const COUNTED = /bounces selected/;
const trajectory = async (query) => (await (await fetch(`${stage.url}v1/trajectories?${query}`)).json()).impacts;

/** Pointer and keys act once their module is there, which comes after the first plot. */
async function wake(page) {
  await page.locator('#plane-angle .canvas-box[aria-describedby]').waitFor();
}

/** A paused run of case 1, and the plot's box on the screen. */
async function paused(query, n, options) {
  const opened = await stage.page(`${query}&tab=why`, options);
  const { page } = opened;
  await speedUp(page);
  await runTo(page, n);
  // Whatever was under way when it was paused has arrived.
  await page.waitForFunction(() => /clock\.\d+\.speed=0/.test(location.search));
  return opened;
}

/** A drag between two places, in shares of the box. */
async function drag(page, id, from, to) {
  const { x, y, width, height } = await boxOf(page, id);
  await page.mouse.move(x + width * from[0], y + height * from[1]);
  await page.mouse.down();
  await page.mouse.move(x + (width * (from[0] + to[0])) / 2, y + (height * (from[1] + to[1])) / 2);
  await page.mouse.move(x + width * to[0], y + height * to[1]);
  await page.mouse.up();
}

const ranges = (url) => {
  const query = new URL(url).searchParams;
  return [...query.keys()]
    .filter((key) => /^brush\..*from$/.test(key))
    .map((key) => {
      const column = key.split('.')[1];
      return { column, low: Number(query.get(key)), high: Number(query.get(`brush.${column}.to`)) };
    });
};
const members = (all, limits, count) =>
  all.n.filter(
    (n, index) =>
      n <= count && limits.every(({ column, low, high }) => all[column][index] >= low && all[column][index] <= high),
  );
const counts = async (page) =>
  /(\d+) of (\d+)/
    .exec(await page.locator('#brush-told').innerText())
    .slice(1)
    .map(Number);

test('a drag over one plot selects the same impacts in all, those to come too, and the link restores it', async () => {
  const { page, clean } = await paused('?preset=case-1', 40);
  await wake(page);
  const before = await Promise.all(
    ['plane-angle', 'plane-velocity', 'energy', 'scene-frame'].map((id) => ink(page, `#${id}`, '--ink')),
  );
  await drag(page, 'plane-angle', [0.25, 0.35], [0.8, 0.8]);
  await told(page, COUNTED);
  await page.waitForFunction(() => /brush\.theta\.from=.*brush\.theta_dot\.to=/.test(location.search));
  const all = await trajectory('preset=case-1&bounces=400');
  const limits = ranges(page.url());
  assert.deepEqual(
    limits.map(({ column }) => column),
    ['theta', 'theta_dot'],
  );
  const [some, of] = await counts(page);
  assert.equal(some, members(all, limits, of).length);
  assert.ok(some > 3 && some < of, `${some} of ${of}`);
  const after = await Promise.all(
    ['plane-angle', 'plane-velocity', 'energy', 'scene-frame'].map((id) => ink(page, `#${id}`, '--ink')),
  );
  for (const [index, count] of after.entries())
    assert.ok(count > before[index] + 8, `rings in picture ${index}: ${before[index]}, ${count}`);
  const link = page.url();
  await releaseTo(page, of + 20);
  await page.waitForFunction(
    (n) => Number(/of (\d+)/.exec(document.querySelector('#brush-told').textContent)[1]) >= n,
    of + 20,
  );
  const [later, ofLater] = await counts(page);
  assert.equal(later, members(all, limits, ofLater).length);
  const second = await stage.page(new URL(link).search);
  await reachPhase(second.page, 'paused');
  await told(second.page, new RegExp(`${some} of ${of} bounces selected`));
  await second.page.click('#brush-clear');
  await told(second.page, /Drag over/);
  await second.page.waitForFunction(() => !/brush/.test(location.search));
  clean();
  second.clean();
});

test('Escape clears, in the velocity plane and for the energy as well', async () => {
  const { page, clean } = await paused('?preset=case-4', 20);
  await wake(page);
  for (const [id, columns] of [
    ['plane-velocity', ['x_dot', 'y_dot']],
    ['energy', ['n', 'energy']],
  ]) {
    await drag(page, id, [0.3, 0.2], [0.9, 0.7]);
    await page.waitForFunction((name) => location.search.includes(`brush.${name}.from`), columns[1]);
    assert.deepEqual(
      ranges(page.url()).map(({ column }) => column),
      columns,
    );
    await page.keyboard.press('Escape');
    await told(page, /Drag over/);
  }
  clean();
});

test('a link whose selection is no range says what it dropped', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&tab=why&brush.wobble.from=1&brush.wobble.to=2&brush.theta.from=2&brush.theta.to=x&brush.n.from=3',
  );
  const words = await page.locator('.notice').innerText();
  assert.match(words, /selection by “wobble”/);
  for (const column of ['theta', 'n']) assert.match(words, new RegExp(`selection by “${column}”, which is no range`));
  await told(page, /Drag over/);
  clean();
});

test('while impacts arrive, a selection does not draw the old ones again', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why', {
    prepare: () => {
      globalThis.cleared = 0;
      const { clearRect } = CanvasRenderingContext2D.prototype;
      CanvasRenderingContext2D.prototype.clearRect = function (...place) {
        if (this.canvas === document.querySelector('#plane-angle canvas')) globalThis.cleared += 1;
        return clearRect.apply(this, place);
      };
    },
  });
  await speedUp(page);
  await releaseTo(page, 30);
  await wake(page);
  await drag(page, 'plane-angle', [0.25, 0.35], [0.8, 0.8]);
  await told(page, COUNTED);
  await page.mouse.move(5, 5);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const before = await page.evaluate(() => globalThis.cleared);
  const [, of] = await counts(page);
  await reachImpact(page, of + 12);
  assert.equal(
    await page.evaluate(() => globalThis.cleared),
    before,
    'the loop of case 1 fits its scales, so that nothing but a selection would clear them',
  );
  clean();
});

test('with keys alone: from impact to impact, a selection of some, and a start at one', async () => {
  const { page, clean } = await paused('?preset=case-1', 12);
  const box = page.locator('#plane-angle .canvas-box');
  await box.focus();
  await page.locator('#plane-angle .canvas-box[aria-describedby]').waitFor();
  await page.keyboard.press('Home');
  await spoken(page, /^n 1 /);
  for (let k = 0; k < 4; k += 1) await page.keyboard.press('ArrowRight');
  await spoken(page, /^n 5 /);
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('Shift+ArrowRight');
  await spoken(page, /^n 7 .*3 of \d+ bounces selected/);
  await told(page, /^3 of/);
  await page.keyboard.press('Escape');
  await page.locator('#brush-clear').waitFor({ state: 'hidden' });
  await page.keyboard.press('Enter');
  await spoken(page, /Enter releases there/);
  await page.keyboard.press('Enter');
  await spoken(page, /Released anew/);
  await page.waitForFunction(() => /scene\.release\.theta=/.test(location.search));
  await reachImpact(page, 1);
  const all = await trajectory('preset=case-1&bounces=12');
  const query = new URL(page.url()).searchParams;
  const release = new URLSearchParams([...query].filter(([key]) => key === 'preset' || key.startsWith('scene.')));
  const fresh = await trajectory(`${release}&bounces=2`);
  assert.ok(Math.abs(fresh.theta[0] - all.theta[6]) < 1e-9, `${fresh.theta[0]}, ${all.theta[6]}`);
  assert.ok(Math.abs(fresh.theta_dot[0] - all.theta_dot[6]) < 1e-9);
  // The other plane releases with ẋ and ẏ of an impact and keeps the angle.
  // A connection that is given up before it is made is an error to the browser.
  await page.locator('#run-state:not([data-phase=connecting])').waitFor();
  await page.selectOption('#case', 'case-2');
  await reachPhase(page, 'running');
  await page.selectOption('#case', 'case-1');
  await reachPhase(page, 'running');
  await reachImpact(page, 4);
  await page.locator('#plane-velocity .canvas-box').focus();
  await page.keyboard.press('Home');
  for (let k = 0; k < 3; k += 1) await page.keyboard.press('ArrowRight');
  await spoken(page, /^n 4 /);
  await page.keyboard.press('Enter');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => /scene\.release\.x_dot=/.test(location.search));
  const moved = new URLSearchParams(
    [...new URL(page.url()).searchParams].filter(([key]) => key === 'preset' || key.startsWith('scene.')),
  );
  const there = await trajectory(`${moved}&bounces=2`);
  assert.ok(
    Math.abs(there.x_dot[0] - all.x_dot[3]) < 1e-9 && Math.abs(there.y_dot[0] - all.y_dot[3]) < 1e-9,
    `${there.x_dot[0]} ${there.y_dot[0]}`,
  );
  clean();
});

test('a click offers a run whose first impact is there, a slip of a pixel is no drag', async () => {
  const { page, clean } = await paused('?preset=case-1', 30);
  await wake(page);
  const { x, y, width, height } = await boxOf(page, 'plane-angle');
  const [px, py] = [width * 0.6, height * 0.42];
  await page.mouse.move(x + px, y + py);
  await page.mouse.down();
  await page.mouse.move(x + px + 2, y + py + 2);
  await page.mouse.up();
  await page.click('#ghost-release');
  await spoken(page, /Released anew/);
  await page.waitForFunction(() => /scene\.release\.theta=/.test(location.search));
  await reachImpact(page, 1);
  // The shortcuts of the page still work after the click.
  await page.keyboard.press(' ');
  await reachPhase(page, 'paused');
  const rows = await numbers(page, 'plane-angle');
  const [theta, spin] = rows
    .at(-1)
    .slice(2, 4)
    .map((text) => Number(text.replace('\u2212', '-')));
  // The scales of the loop of case 1, whose plot was clicked: ±0.4 rad and ±1.5 rad/s.
  const left = 44,
    right = 8,
    top = 24,
    bottom = 36;
  const across = -0.4 + ((px - left) / (width - left - right)) * 0.8;
  const perPixel = { theta: 0.8 / (width - left - right), spin: 3 / (height - top - bottom) };
  const up = -1.5 + ((height - bottom - py) / (height - top - bottom)) * 3;
  assert.ok(Math.abs(theta - across) <= perPixel.theta, `${theta}, ${across}`);
  assert.ok(Math.abs(spin - up) <= perPixel.spin, `${spin}, ${up}`);
  assert.equal(await page.locator('#brush-clear').isHidden(), true, 'nothing was selected');
  clean();
});

test('what cannot be reached is said and starts nothing', async () => {
  // Upright the rod is longer than this height.
  const { page, clean } = await stage.page('?preset=case-1&scene.release.height=0.13&tab=why');
  await wake(page);
  const { x, y, width, height } = await boxOf(page, 'plane-angle');
  await page.mouse.click(x + 44 + (width - 52) / 2, y + height * 0.4);
  await spoken(page, /out of reach: released at 0\.13/);
  assert.equal(await page.locator('.ghost').count(), 0);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  clean();
});

test('a start in closed form is what the server computes, and what it refuses does not land there', async () => {
  // A fixed generator: the same scenes every time.
  let seed = 11;
  const random = (low, high) => {
    seed = (seed * 48271) % 2147483647;
    return low + (high - low) * (seed / 2147483647);
  };
  const { items: fields } = await (await fetch(`${stage.url}v1/fields`)).json();
  const counted = { landed: 0, before: 0, other: 0 };
  for (let round = 0; round < 60; round += 1) {
    const release = {
      height: random(0.14, 0.5),
      y_dot: random(-1, 1.5),
      theta: random(-0.5, 0.5),
      theta_dot: random(-6, 6),
    };
    const scene = {
      gravity: 9.81,
      incline: random(0.5, Math.PI / 2),
      body: { contact_distance: 0.4 / 3, radius_of_gyration: 0.0942809 },
      release,
    };
    const plane = `v1/trajectories?preset=case-1&bounces=1&scene.incline=${scene.incline}`;
    scene.derived = (await (await fetch(stage.url + plane)).json()).derived;
    const byAngle = round % 2 === 0;
    // Only a rod that whirls about low over the table strikes before it is as wanted.
    const whirls = round % 4 === 0;
    if (whirls) Object.assign(release, { height: random(0.134, 0.16), y_dot: random(-0.2, 0.2) });
    const wanted = byAngle
      ? { theta: random(-1, 1), theta_dot: whirls ? random(60, 150) * -1 : random(-15, 15) }
      : { x_dot: random(-2, 2), y_dot: random(-3, 0.5) };
    const start = within(
      byAngle ? angleStart(scene, wanted.theta, wanted.theta_dot) : velocityStart(scene, wanted.x_dot, wanted.y_dot),
      fields,
    );
    const ask = (values) => {
      const query = new URLSearchParams({ preset: 'case-1', bounces: '1', 'scene.incline': String(scene.incline) });
      for (const [path, value] of Object.entries({
        ...Object.fromEntries(Object.entries(release).map(([name, own]) => [`release.${name}`, own])),
        ...values,
      }))
        query.set(`scene.${path}`, String(value));
      return fetch(`${stage.url}v1/trajectories?${query}`);
    };
    if (start.values) {
      counted.landed += 1;
      const answer = await (await ask(start.values)).json();
      assert.ok(answer.impacts, JSON.stringify([answer, start]));
      const { impacts: first } = answer;
      for (const [name, value] of Object.entries(wanted))
        assert.ok(Math.abs(first[name][0] - value) < 1e-9, `${name} of round ${round}: ${first[name][0]}, ${value}`);
    } else if (/strike before/.test(start.words) && byAngle) {
      counted.before += 1;
      const G = 9.81 * Math.sin(scene.incline);
      const T =
        (release.y_dot +
          Math.sqrt(release.y_dot ** 2 + 2 * G * (release.height - (0.4 / 3) * Math.cos(wanted.theta)))) /
        G;
      // Turned by whole turns, it meets the table at the same time.
      const { impacts: first } = await (
        await ask({
          'release.theta': Math.atan2(
            Math.sin(wanted.theta - wanted.theta_dot * T),
            Math.cos(wanted.theta - wanted.theta_dot * T),
          ),
          'release.theta_dot': wanted.theta_dot,
        })
      ).json();
      assert.ok(first.t[0] < T - 1e-6, `round ${round}: ${first.t[0]}, ${T}`);
    } else counted.other += 1;
  }
  assert.ok(counted.landed > 15 && counted.before > 0 && counted.other > 0, JSON.stringify(counted));
});

test('by touch a tap offers and the second one there starts; the page still scrolls over a plot', async () => {
  const { page, clean } = await paused('?preset=case-1', 10, { hasTouch: true });
  const box = page.locator('#plane-angle .canvas-box');
  await box.scrollIntoViewIfNeeded();
  assert.equal(await box.evaluate((element) => getComputedStyle(element).touchAction), 'pan-y pinch-zoom');
  await wake(page);
  const { x, y, width, height } = await box.boundingBox();
  const before = page.url();
  await page.touchscreen.tap(x + width * 0.6, y + height * 0.45);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.equal(page.url(), before, 'one tap has started nothing');
  await page.touchscreen.tap(x + width * 0.6, y + height * 0.45);
  await page.waitForFunction(() => /scene\.release\.theta=/.test(location.search));
  await reachPhase(page, 'running');
  clean();
});

test('beyond twenty thousand impacts the dots are put down as pixels, selected ones over the rest', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why');
  const found = await page.evaluate(async () => {
    const [{ Impacts, COLUMNS }, { Selection }, { anglePlane }] = await Promise.all([
      import('./run/impacts.js'),
      import('./run/selection.js'),
      import('./charts/impacts/plots.js'),
    ]);
    const impacts = new Impacts(1 << 18);
    for (let n = 1; n <= 100_000; n += 1) {
      const impact = Object.fromEntries(COLUMNS.map((name) => [name, 0]));
      impacts.append({
        ...impact,
        n,
        theta: 0.3 * Math.cos(n) * Math.sqrt(n / 1e5),
        theta_dot: Math.sin(n) * Math.sqrt(n / 1e5),
      });
    }
    const selection = new Selection(impacts);
    const plot = anglePlane(impacts);
    plot.selection = selection;
    selection.changed = () => plot.redraw();
    document.querySelector('#charts').append(plot.figure.element);
    const frames = async (count) => {
      for (let k = 0; k < count; k += 1) await new Promise((done) => requestAnimationFrame(done));
    };
    const images = { put: 0, drawn: 0 };
    const { putImageData, drawImage } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.putImageData = function (...all) {
      images.put += 1;
      return putImageData.apply(this, all);
    };
    CanvasRenderingContext2D.prototype.drawImage = function (...all) {
      if (this === plot.layers[0].context) images.drawn += 1;
      return drawImage.apply(this, all);
    };
    const until = async (condition) => {
      while (!condition()) await frames(1);
    };
    await until(() => images.drawn > 0);
    const count = (rgb) => {
      const { canvas } = plot.layers[0];
      const copy = Object.assign(document.createElement('canvas'), {
        width: canvas.width,
        height: canvas.height,
      }).getContext('2d', { willReadFrequently: true });
      drawImage.call(copy, canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      let some = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] > 200 && rgb.every((part, k) => Math.abs(data[i + k] - part) < 14)) some += 1;
      return some;
    };
    const blue = [0, 0x72, 0xb2];
    const plain = count(blue);
    const times = [];
    for (let k = 0; k < 15; k += 1) {
      plot.redraw();
      const from = performance.now();
      plot.draw(from);
      times.push(performance.now() - from);
    }
    selection.set([['theta', { low: 0.1, high: 0.2 }]]);
    const drawn = images.drawn;
    await until(() => images.drawn > drawn);
    return {
      kept: impacts.end - impacts.begin,
      plain,
      picked: count(blue),
      places: selection.places.length,
      put: images.put,
      median_ms: times.sort((a, b) => a - b)[7],
    };
  });
  assert.equal(found.kept, 100_000);
  assert.ok(found.put > 0 && found.plain > 300, JSON.stringify(found));
  assert.ok(found.picked > 20 && found.picked < found.plain, 'the rest has receded');
  assert.ok(found.places > 5000 && found.places < 30_000);
  console.log(`100,000 dots drawn anew in ${found.median_ms.toFixed(1)} ms, the median of 15`);
  clean();
});
