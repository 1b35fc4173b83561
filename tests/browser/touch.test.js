// Fingers: over planes the page scrolls, a drag aside selects, a tap offers; on the map a drag moves the scene.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, reachImpact, showChart, speedUp, runTo } from './stage.js';

const stage = await Stage.open();
const PHONE = { viewport: { width: 820, height: 900 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1 };

/** Real touches, as a finger's own, that the browser turns into scrolling where the page lets it. */
async function finger(page, context) {
  const session = await context.newCDPSession(page);
  const send = (type, points) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  return {
    async drag(from, to, steps = 8) {
      await send('touchStart', [from]);
      for (let k = 1; k <= steps; k += 1)
        await send('touchMove', [
          [from[0] + ((to[0] - from[0]) * k) / steps, from[1] + ((to[1] - from[1]) * k) / steps],
        ]);
      await send('touchEnd', []);
    },
    async pinch([x, y], apart, wider, steps = 8) {
      const both = (half) => [
        [x - half, y],
        [x + half, y],
      ];
      await send('touchStart', both(apart));
      for (let k = 1; k <= steps; k += 1) await send('touchMove', both(apart + ((wider - apart) * k) / steps));
      await send('touchEnd', []);
    },
  };
}

async function middle(page, selector) {
  const box = page.locator(selector);
  await box.evaluate((element) => element.scrollIntoView({ block: 'center' }));
  const { x, y, width, height } = await box.boundingBox();
  return { at: (across, down) => [x + width * across, y + height * down] };
}

async function running(query) {
  const opened = await stage.page(query, PHONE);
  const { page } = opened;
  await page.locator('#plane-angle .canvas-box[aria-describedby]').waitFor({ state: 'attached' });
  await speedUp(page);
  await runTo(page, 20);
  await showChart(page, 'plane-angle');
  return opened;
}

test('a finger that moves down over a plane scrolls the page and selects nothing', async () => {
  const { page, context } = await running('?preset=case-1');
  const { drag } = await finger(page, context);
  const { at } = await middle(page, '#plane-angle .canvas-box');
  const before = await page.evaluate(() => scrollY);
  await drag(at(0.5, 0.8), [at(0.5, 0.8)[0], at(0.5, 0.8)[1] - 200], 16);
  await page.waitForFunction((from) => Math.abs(scrollY - from) > 40, before);
  assert.match(await page.locator('#brush-told').textContent(), /Drag over/);
  assert.equal(await page.locator('.ghost').count(), 0);
});

test('a finger that moves aside over a plane selects impacts', async () => {
  const { page, context } = await running('?preset=case-1');
  const { drag } = await finger(page, context);
  const { at } = await middle(page, '#plane-angle .canvas-box');
  await drag(at(0.25, 0.3), at(0.8, 0.45));
  await page.locator('#brush-told', { hasText: /bounces selected/ }).waitFor({ state: 'attached' });
  await page.waitForFunction(() => /brush\.theta\.from/.test(location.search));
});

test('two fingers apart over a plane enlarge the page', async () => {
  const { page, context } = await running('?preset=case-1');
  const { pinch } = await finger(page, context);
  const { at } = await middle(page, '#plane-angle .canvas-box');
  await pinch(at(0.5, 0.5), 20, 110, 14);
  await page.waitForFunction(() => visualViewport.scale > 1.2);
  assert.match(await page.locator('#brush-told').textContent(), /Drag over/);
});

test('a tap in a plane offers a release, its button releases it with one more', async () => {
  const { page } = await running('?preset=case-1');
  const { at } = await middle(page, '#plane-angle .canvas-box');
  await page.touchscreen.tap(...at(0.6, 0.4));
  await page.locator('#ghost-release').waitFor();
  const { width, height } = await page.locator('#ghost-release').boundingBox();
  assert.ok(width >= 44 && height >= 44, `${width} × ${height}`);
  assert.doesNotMatch(page.url(), /scene\.release/, 'offered, not released');
  await page.locator('#ghost-release').tap();
  await page.waitForFunction(() => /scene\.release\.theta=/.test(location.search));
});

test('a finger on the map drags the scene, and the page stays where it is', async () => {
  const { page, context, clean } = await stage.page('?preset=case-1&map.columns=48', PHONE);
  await page.locator('#map-box[aria-busy=false]').waitFor();
  const { drag } = await finger(page, context);
  const { at } = await middle(page, '#map-box');
  const before = await page.evaluate(() => scrollY);
  await drag(at(0.5, 0.3), at(0.4, 0.7), 16);
  await page.waitForFunction(() => /scene\.release\.theta=.*epoch_ms=/.test(location.search));
  assert.equal(await page.evaluate(() => scrollY), before);
  const { width, height } = await page.locator('#map-box').boundingBox();
  assert.ok(width > 250 && height > 250, `${width} × ${height} px`);
  await reachImpact(page, 1);
  clean();
});
