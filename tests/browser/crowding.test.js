// Words, numbers and controls keep clear of each other: in the planes, in the scene, in present mode and on a phone.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, changeUnderWay, drawn, showChart, slide, releaseTo } from './stage.js';

const stage = await Stage.open();
const PINNED =
  '?preset=case-1&pin.0.preset=case-1&pin.0.scene.table.tilt_gain=1.2&pin.1.preset=case-1&pin.1.scene.release.theta=0.2&pin.2.preset=case-2&tab=why';

/** Keeps the boxes of all words that a canvas shows. */
function recordWords() {
  globalThis.words = new Map();
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.clearRect = function (...args) {
    globalThis.words.set(this.canvas, []);
    return clearRect.apply(this, args);
  };
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
    const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right } = this.measureText(text);
    const { actualBoundingBoxAscent: above, actualBoundingBoxDescent: below } = this.measureText(text);
    const list = globalThis.words.get(this.canvas) ?? [];
    list.push({ text, left: x - left, right: x + right, top: y - above, bottom: y + below });
    globalThis.words.set(this.canvas, list);
    return fillText.call(this, text, x, y, ...rest);
  };
}

/** Pairs of words that overlap in a plane. */
const overlaps = (page, id) =>
  page.evaluate((plane) => {
    const all = [...document.querySelectorAll(`#${plane} canvas`)].flatMap(
      (canvas) => globalThis.words.get(canvas) ?? [],
    );
    return all.flatMap((one, index) =>
      all
        .slice(index + 1)
        .filter(
          (other) =>
            one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom,
        )
        .map((other) => `${one.text} | ${other.text}`),
    );
  }, id);

for (const width of [1280, 390])
  test(`the legend of a plane leaves the name of the axis its place, ${width} px wide`, async () => {
    const { page, clean } = await stage.page(PINNED, { prepare: recordWords, viewport: { width, height: 844 } });
    await showChart(page, 'plane-angle');
    await page.waitForFunction(() => [...globalThis.words.values()].flat().some(({ text }) => text === 'B'));
    await drawn(page);
    assert.deepEqual(await overlaps(page, 'plane-angle'), []);
    // A release that is offered has longer words.
    const box = await page.locator('#plane-angle .canvas-box').boundingBox();
    await page.mouse.click(box.x + box.width * 0.6, box.y + box.height * 0.4);
    await page.locator('#plane-angle .ghost button').first().waitFor();
    await drawn(page);
    assert.deepEqual(await overlaps(page, 'plane-angle'), []);
    clean();
  });

for (const width of [1280, 800])
  test(`the numbers of a strike stand beside the stand of the table while presented, ${width} px wide`, async () => {
    const { page, clean } = await stage.page('?preset=case-1&speed=5', {
      viewport: { width, height: 800 },
      prepare: () => {
        localStorage['equipoise.symbols'] = 'on';
        globalThis.met = new Set();
        globalThis.told = 0;
        let stand = null;
        let last = 0;
        const { moveTo, stroke, fillText } = CanvasRenderingContext2D.prototype;
        CanvasRenderingContext2D.prototype.moveTo = function (x, y) {
          last = x;
          return moveTo.call(this, x, y);
        };
        CanvasRenderingContext2D.prototype.stroke = function () {
          // The stand is the only line as broad.
          if (this.lineWidth === 8) stand = { left: last - 4, right: last + 4 };
          return stroke.call(this);
        };
        CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
          if (/^(bounce|impulse|α)/.test(text) && stand && this.canvas.closest('#scene-frame')) {
            const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right } = this.measureText(text);
            globalThis.told += 1;
            if (x - left < stand.right && stand.left < x + right) globalThis.met.add(text);
          }
          return fillText.call(this, text, x, y, ...rest);
        };
      },
    });
    await page.locator('#present:enabled').waitFor({ state: 'attached' });
    await page.locator('body').press('p');
    await page.locator('html.presenting').waitFor();
    await releaseTo(page, 80);
    assert.ok((await page.evaluate(() => globalThis.told)) > 10);
    assert.deepEqual(await page.evaluate(() => [...globalThis.met]), []);
    clean();
  });

/** The middles of the rows in which controls stand, px. */
const rows = (page, selector) =>
  page.locator(selector).evaluateAll((controls) => [
    ...new Set(
      controls
        .filter((control) => control.checkVisibility())
        .map((control) => {
          const { top, height } = control.getBoundingClientRect();
          return Math.round((top + height / 2) / 8);
        }),
    ),
  ]);

for (const [width, height] of [
  [1280, 800],
  [800, 900],
])
  test(`presented, scene, map and verdict have the screen, and the controls stand in single rows, ${width} px wide`, async () => {
    const { page, clean } = await stage.page('?preset=case-1', { viewport: { width, height } });
    await page.locator('#present:enabled').waitFor({ state: 'attached' });
    const inRows = async () => {
      for (const row of ['#step-back, #step, #restart', '.directions button', '#run, #speed', '.acts button'])
        assert.equal((await rows(page, row)).length, 1, row);
    };
    await inRows();
    await page.locator('body').press('p');
    await page.locator('html.presenting').waitFor();
    await page.locator('#time-open').evaluate((button) => button.click());
    await drawn(page);
    assert.equal((await rows(page, '#run, #speed, .acts button')).length, 1);
    const [frame, controls, map, verdict] = await Promise.all(
      ['#scene-frame', '#controls', '#map-box', '#verdict-card'].map((id) => page.locator(id).boundingBox()),
    );
    assert.ok(frame.height > 0.25 * height, `${frame.height} px`);
    assert.ok(controls.y >= frame.y + frame.height, `controls at ${controls.y} px, the scene at ${frame.y} px`);
    if (width === 1280) {
      assert.ok(map.y >= 0 && map.y + map.height <= verdict.y, `the map ends at ${map.y + map.height} px`);
      assert.ok(verdict.y + verdict.height <= height, `the verdict ends at ${verdict.y + verdict.height} px`);
    }
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} px`);
    clean();
  });

test('controls stand in single rows on a phone', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 390, height: 844 }, folded: true });
  await page.locator('#throw-it').waitFor();
  assert.equal((await rows(page, '#run, .acts button')).length, 1);
  await page.click('#tools-open');
  await page.click('#time-open');
  assert.equal((await rows(page, '#step-back, #step, #restart')).length, 1);
  assert.equal((await rows(page, '.directions button')).length, 1);
  clean();
});

test('targets of the head are 44 px high on a phone', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 390, height: 844 }, hasTouch: true });
  await page.locator('#present:enabled').waitFor({ state: 'attached' });
  await page.click('#tools-open');
  const small = await page
    .locator('.bar :is(button, select)')
    .evaluateAll((targets) =>
      targets
        .filter((target) => target.checkVisibility() && target.getBoundingClientRect().height < 44)
        .map(({ id }) => id),
    );
  assert.deepEqual(small, []);
  clean();
});

test('nothing moves while a slider is dragged in a run that does not play its value yet', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 1280, height: 800 } });
  await page.locator('#present:enabled').waitFor({ state: 'attached' });
  await releaseTo(page, 1);
  const frame = () => page.locator('#scene-frame').boundingBox();
  const before = await frame();
  await changeUnderWay(page);
  await slide(page, '#field-release-theta-slider', 0.2);
  await page.locator('#restart.attention').waitFor();
  assert.deepEqual(await frame(), before);
  clean();
});
