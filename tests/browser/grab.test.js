// The rod as a thing to take hold of: by mouse, by finger and by keys; and what a release from the hand leaves alone.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, reachImpact, reachPhase } from './stage.js';

const stage = await Stage.open();

/** The handle comes after the first plot. */
const wake = (page) => page.locator('#grab').waitFor();

/** Places on the screen along the rod: its middle, and its upper end. */
async function places(page) {
  await wake(page);
  const { x, y, width, height } = await page.locator('#grab').boundingBox();
  return { middle: [x + width / 2, y + height / 2], end: [x + width / 2, y + 14] };
}

const field = async (page, path) =>
  Number((await page.inputValue(`#field-${path.replace('.', '-')}`)).replace('−', '-'));
const readout = (page, words) => page.locator('#scene-readout', { hasText: words }).waitFor();

test('a drag by the middle moves the rod, and letting go releases it there', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0');
  const { middle } = await places(page);
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] + 60, middle[1] - 40, { steps: 4 });
  await readout(page, /Held/);
  assert.equal(await page.locator('#run-state').innerText(), 'Ready');
  await page.mouse.up();
  await reachImpact(page, 1);
  assert.ok((await field(page, 'release.height')) > 0.215);
  assert.ok((await field(page, 'release.x')) > 0.03);
  assert.equal(await field(page, 'release.theta'), 0);
  assert.match(page.url(), /scene\.release\.x=0\.0/);
  await page.keyboard.press('Control+z');
  await page.waitForFunction(() => document.querySelector('#field-release-height').value === '0.2');
  assert.doesNotMatch(page.url(), /release\.x/);
  clean();
});

test('a drag by an end tilts it and lifts nothing', async () => {
  const { page, clean } = await stage.page('?preset=case-2');
  const spin = await field(page, 'release.theta_dot');
  assert.notEqual(spin, 0);
  const { end } = await places(page);
  await page.mouse.move(...end);
  await page.mouse.down();
  await page.mouse.move(end[0] - 25, end[1] + 3, { steps: 4 });
  await page.mouse.up();
  await reachImpact(page, 1);
  assert.ok((await field(page, 'release.theta')) > 0.15);
  assert.equal(await field(page, 'release.height'), 0.2);
  // A hand lets go at rest.
  assert.equal(await field(page, 'release.theta_dot'), 0);
  clean();
});

test('the table holds the rod up, it stays in the picture, and Escape puts it back', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0');
  const { middle } = await places(page);
  const frame = await page.locator('#scene-frame').boundingBox();
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0], middle[1] + 200, { steps: 4 });
  await readout(page, /Held\s0\.133\sm/);
  await page.mouse.move(middle[0], frame.y - 30, { steps: 4 });
  await page.waitForFunction(
    (before) => !document.querySelector('#scene-readout').textContent.includes(before),
    '0.133',
  );
  const held = (await places(page)).middle;
  assert.ok(held[1] > frame.y, `${held[1]} px, the picture begins at ${frame.y} px`);
  await page.mouse.move(frame.x + frame.width + 40, middle[1], { steps: 4 });
  await page.waitForFunction(
    (right) => {
      const { x, width } = document.querySelector('#grab').getBoundingClientRect();
      return x + width / 2 > right;
    },
    frame.x + frame.width * 0.9,
  );
  assert.ok((await places(page)).middle[0] < frame.x + frame.width);
  await page.keyboard.press('Escape');
  await readout(page, /Released at 0\.200/);
  await page.mouse.up();
  assert.equal(await page.locator('#run-state').innerText(), 'Ready');
  assert.equal(await field(page, 'release.height'), 0.2);
  clean();
});

test('during a run the drag holds the picture, and letting go is a new release', async () => {
  const { page, clean } = await stage.page('?preset=case-1&speed=0.05');
  await wake(page);
  await page.click('#run');
  await reachPhase(page, 'running');
  const { middle } = await places(page);
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0], middle[1] - 25, { steps: 4 });
  await readout(page, /Held/);
  const told = await page.locator('#scene-readout').innerText();
  await page.waitForTimeout(300);
  assert.equal(await page.locator('#scene-readout').innerText(), told);
  const before = new URL(page.url()).searchParams.get('epoch_ms');
  await page.mouse.up();
  await page.waitForFunction(
    (epoch) => ![null, epoch].includes(new URL(location.href).searchParams.get('epoch_ms')),
    before,
  );
  assert.ok((await field(page, 'release.height')) > 0.2);
  clean();
});

test('by keys: arrows lift and tilt, Enter releases, leaving puts back', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await wake(page);
  await page.focus('#grab');
  await page.keyboard.press('Shift+ArrowUp');
  await page.keyboard.press('ArrowLeft');
  await page.locator('#grab-said', { hasText: /Held .*tilted by 0\.310/ }).waitFor({ state: 'attached' });
  await page.keyboard.press('Tab');
  await page.locator('#grab-said', { hasText: 'Put back' }).waitFor({ state: 'attached' });
  await readout(page, /Released at 0\.200/);
  await page.focus('#grab');
  await page.keyboard.press('Shift+ArrowUp');
  await page.keyboard.press('Control+ArrowRight');
  await page.keyboard.press('Enter');
  await page.locator('#grab-said', { hasText: 'Released' }).waitFor({ state: 'attached' });
  await reachImpact(page, 1);
  assert.ok((await field(page, 'release.height')) > 0.21 && (await field(page, 'release.x')) > 0);
  assert.equal(await field(page, 'release.theta'), 0.3);
  clean();
});

test('by touch a finger drags the rod and does not scroll', async () => {
  const { page, context, clean } = await stage.page('?preset=case-1&scene.release.theta=0', {
    viewport: { width: 390, height: 844 },
    hasTouch: true,
    isMobile: true,
  });
  const { middle } = await places(page);
  const client = await context.newCDPSession(page);
  const touch = (type, points) => client.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  const [x, y] = middle;
  const scrolled = await page.evaluate(() => scrollY);
  await touch('touchStart', [{ x, y }]);
  for (let step = 1; step <= 5; step += 1) await touch('touchMove', [{ x: x + 4 * step, y: y - 4 * step }]);
  await readout(page, /Held/);
  await touch('touchEnd', []);
  await reachImpact(page, 1);
  assert.equal(await page.evaluate(() => scrollY), scrolled);
  await page.waitForFunction(() => Number(new URLSearchParams(location.search).get('scene.release.height')) > 0.2);
  clean();
});

test('a point mass is dragged as a whole and has no tilt', async () => {
  const { page, clean } = await stage.page('?preset=point-mass');
  const { middle } = await places(page);
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] + 10, middle[1] - 20, { steps: 4 });
  await readout(page, /Held/);
  await page.mouse.up();
  await reachImpact(page, 1);
  assert.doesNotMatch(page.url(), /release\.theta=/);
  clean(/^(?!exception)/);
});
