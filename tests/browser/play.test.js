// Play, as its visitors use it: the first screen, drops from the map, stories, falls, the table in one's hand, a lecture, a phone.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { beforeRun, firstScreen } from './first-screen.js';
import { Stage, inkOf, reachPhase } from './stage.js';

const stage = await Stage.open();

/** A place on the map by shares of its cells, from the left and from below, in px of the window. */
async function placeOnMap(page, across, upwards) {
  // Room of the axes around the cells, as web/panels/map/picture.js has it.
  const { x, y, width, height } = await page.locator('#map-box').boundingBox();
  return { x: x + 52 + across * (width - 66), y: y + 26 + (1 - upwards) * (height - 66) };
}

/** Waits for the finest cells. */
const wholeMap = (page) =>
  page.waitForFunction(() => /^98.304 cells/.test(document.querySelector('#map-told')?.textContent ?? ''));
const fieldOf = (page, name) => new URLSearchParams(new URL(page.url()).search).get(name);
const headline = (page) => page.locator('#verdict .headline').innerText();

for (const [width, height] of [
  [1280, 800],
  [1920, 1080],
])
  test(`the first screen is one picture and one map, with little around them: ${width} × ${height}`, async () => {
    const { page, clean } = await stage.page('', { viewport: { width, height }, folded: true, autorun: true });
    await page.locator('.facts', { hasText: 'ends it' }).waitFor();
    await wholeMap(page);
    const found = await firstScreen(page);
    assert.ok(found.controls.length <= 25, found.controls.join(', '));
    assert.ok(found.words <= 100, `${found.words} words`);
    assert.ok(found.smallest >= 13, `${found.smallest} px`);
    assert.ok(found.scene >= 0.3 && found.map >= 0.25, JSON.stringify(found));
    assert.equal(found.excess, 0);
    const { requests } = await beforeRun(page);
    assert.ok(requests > 10 && requests <= 45, `${requests} requests before the run`);
    assert.match(await headline(page), /Stays up/);
    for (const id of ['run', 'why', 'case'])
      assert.ok(await page.locator(`#${id}`).evaluate((one) => one.getBoundingClientRect().bottom <= innerHeight), id);
    clean();
  });

test('the facts beside the verdict are those of the server for this release', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.locator('.facts', { hasText: 'ends it' }).waitFor();
  const { margins } = await (
    await fetch(`${stage.url}v1/stability?preset=case-1&release_margins=true&bounces=500`)
  ).json();
  const { below, above } = margins.find((one) => one.field === 'table.tilt_gain' && one.of === 'release');
  const [, low, high] = /κ may be ([\d.]+) to ([\d.]+) here/.exec(await page.locator('.facts').innerText());
  // Rounded into the range, by less than a hundredth.
  assert.ok(Number(low) >= below.limit && Number(low) < below.limit + 0.01, low);
  assert.ok(Number(high) <= above.limit && Number(high) > above.limit - 0.01, high);
  assert.match(await page.locator('.facts').innerText(), /Friction above 0 ends it/);
  clean();
});

test('a drag of the point on the map drops the body at every move, and the verdict follows', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { autorun: true });
  await reachPhase(page, 'running');
  await wholeMap(page);
  const [from, to] = [await placeOnMap(page, 0.17, 0.6), await placeOnMap(page, 0.5, 0.76)];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2);
  await page.mouse.move(to.x, to.y);
  // It falls before the hand has let go.
  await reachPhase(page, 'running');
  await page.mouse.up();
  await page.locator('#verdict .headline', { hasText: 'Fell' }).waitFor();
  await page.waitForFunction(() => /tilt_gain=1\.3/.test(location.search) && /theta=0\.3/.test(location.search));
  assert.match(await page.locator('#case-shows').innerText(), /Changed from the case: tilt gain, angle/);
  assert.doesNotMatch(await page.locator('.facts').innerText(), /may be/);
  // One drag is one step back.
  await page.click('#tools-open');
  await page.click('#undo');
  await page.waitForFunction(() => !/theta=/.test(location.search));
  clean();
});

test('arrow keys move the point by a cell, and a drop can be shared by its address', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await wholeMap(page);
  await page.locator('#map-box').focus();
  await page.keyboard.press('Shift+ArrowRight');
  await reachPhase(page, 'running');
  await page.waitForFunction(() => /tilt_gain=.*epoch_ms=/.test(location.search));
  const gain = Number(fieldOf(page, 'scene.table.tilt_gain'));
  assert.ok(Math.abs(gain - 1.1 - (10 * 0.6) / 383) < 0.002, String(gain));
  const other = await stage.page(new URL(page.url()).search);
  await other.page.waitForFunction(() => document.querySelector('#run-state').dataset.phase !== 'idle');
  assert.match(await other.page.locator('#case-shows').innerText(), /Changed from the case: tilt gain/);
  clean();
});

test('a fall ends on the ground and says why; it can be seen again, slowly too', async () => {
  const { page, clean } = await stage.page(
    '?preset=case-1&scene.table.tilt_gain=1.5&scene.release.theta=0.45&speed=0.4',
    {
      autorun: true,
    },
  );
  const ending = page.locator('.ending.fell');
  await ending.waitFor();
  assert.match(await ending.innerText(), /Fell at bounce 1: the table struck too steeply/);
  await page.locator('#verdict .headline', { hasText: '▲ Fell at bounce 1' }).waitFor();
  // It lies: ink of the rod is left, and none of it above the table.
  await page.waitForTimeout(3500);
  const canvas = page.locator('#scene-frame canvas').first();
  const { height } = await canvas.evaluate((one) => ({ height: one.height }));
  assert.ok((await inkOf(canvas, '--ink')) > 1000);
  assert.equal(await inkOf(canvas, '--ink', { margins: [0, 0, 0, Math.round(height * 0.4)] }), 0);
  await page.click('#slow');
  await page.waitForFunction(() => /tenth/.test(document.querySelector('#timeline-told').textContent));
  await page.click('#again');
  await reachPhase(page, 'running');
  assert.ok(await ending.isHidden());
  clean();
});

test('a lecturer walks through the stories by keys, and a catch ends at rest', async () => {
  const { page, clean } = await stage.page('', { viewport: { width: 1280, height: 800 } });
  await page.locator('#present:enabled').click();
  await page.locator('html.presenting').waitFor();
  const caption = () => page.locator('#case-shows').innerText();
  const seen = [];
  for (let story = 0; story < 5; story += 1) {
    await page.keyboard.press(story === 0 ? '1' : 'ArrowRight');
    await page.waitForFunction(
      (before) => document.querySelector('#case-shows').textContent !== before,
      seen.at(-1) ?? '',
    );
    seen.push(await caption());
    await reachPhase(page, 'running');
  }
  assert.equal(new Set(seen).size, 5);
  for (const words of seen) assert.ok(words.split(' ').length <= 20, words);
  assert.match(seen[4], /holds it/);
  await page.locator('.ending.kept').waitFor();
  assert.match(await headline(page), /● /);
  await page.keyboard.press('PageUp');
  await page.waitForFunction((words) => document.querySelector('#case-shows').textContent === words, seen[3]);
  await page.keyboard.press('PageDown');
  await page.waitForFunction((words) => document.querySelector('#case-shows').textContent === words, seen[4]);
  // Space is for the run.
  await reachPhase(page, 'running');
  await page.keyboard.press(' ');
  await reachPhase(page, 'paused');
  await page.keyboard.press('Escape');
  await page.locator('html:not(.presenting)').waitFor();
  assert.equal(await page.locator('#stories [aria-pressed=true]').innerText(), 'Caught');
  clean();
});

test('one is the table: what the hand does is a run like any other, and a link opens the challenge', async () => {
  const { page, clean } = await stage.page('?you=table');
  assert.equal(await page.locator('#you').getAttribute('aria-pressed'), 'true');
  // It waits for the first move.
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'idle');
  const { x, y, width, height } = await page.locator('#scene-frame').boundingBox();
  await page.mouse.move(x + width * 0.45, y + height / 2);
  await reachPhase(page, 'running');
  await page.locator('#verdict .headline', { hasText: 'Held 1' }).waitFor();
  await page.locator('#case-shows', { hasText: /You held \d+ bounces?\. A table with κ = 1\.1 holds 2000/ }).waitFor();
  await page.waitForFunction(() =>
    /interventions\.\d+\.set\.table\.errors\.tilt_offset=0\.0[56]/.test(location.search),
  );
  // The server's own run of that address ends at the same bounce.
  const query = new URLSearchParams(new URL(page.url()).search);
  for (const key of [...query.keys()]) if (!/^(preset|scene\.|interventions\.)/.test(key)) query.delete(key);
  const { outcome } = await (await fetch(`${stage.url}v1/trajectories?${query}&bounces=2000`)).json();
  const held = Number(/\d+/.exec(await page.locator('#case-shows').innerText())[0]);
  assert.equal(held, outcome.bounces - 1);
  // The link still opens the challenge, which begins anew in place of a run that nobody holds.
  assert.equal(new URL(page.url()).searchParams.get('you'), 'table');
  await page.click('#again');
  assert.equal(await page.locator('#you').getAttribute('aria-pressed'), 'true');
  await reachPhase(page, 'idle');
  // A story ends the game: no hand tilts its table.
  await page.locator('#stories button', { hasText: 'Balanced' }).click();
  assert.equal(await page.locator('#you').getAttribute('aria-pressed'), 'false');
  await page.mouse.move(x + width * 0.7, y + height / 2);
  await page.waitForFunction(() => !/you=table|tilt_offset/.test(location.search));
  clean();
});

test('nothing moves while a run begins, goes on and falls', async () => {
  const { page, clean } = await stage.page('?preset=case-3&scene.release.theta=0.3&speed=2', {
    viewport: { width: 1280, height: 800 },
  });
  await page.locator('#verdict .headline.unstable').waitFor();
  await page.locator('#present:enabled').waitFor();
  const places = () =>
    page.evaluate(() =>
      ['scene-frame', 'run', 'kick', 'map-box', 'tabs', 'verdict-card', 'stories'].map((id) => {
        const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
        return [id, ...[x, y, width, height].map(Math.round)].join(' ');
      }),
    );
  await wholeMap(page);
  const before = await places();
  await page.click('#run');
  await reachPhase(page, 'running');
  assert.deepEqual(await places(), before, 'while it runs');
  await reachPhase(page, 'ended');
  assert.deepEqual(await places(), before, 'after its end');
  clean();
});

test('arrow keys, Home and End go through the tabs; the reasons open from the verdict; the address names the tab', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await page.locator('#tab-map').focus();
  const shown = () => page.locator('[role=tabpanel]:visible').evaluateAll((panels) => panels.map(({ id }) => id));
  await page.keyboard.press('ArrowRight');
  assert.deepEqual(await shown(), ['panel-values']);
  await page.keyboard.press('End');
  assert.deepEqual(await shown(), ['panel-more']);
  await page.waitForFunction(() => /tab=more/.test(location.search));
  await page.keyboard.press('Home');
  assert.deepEqual(await shown(), ['panel-map']);
  await page.click('#why');
  assert.deepEqual(await shown(), ['panel-why']);
  await page.waitForFunction(() => /tab=why/.test(location.search));
  await page.locator('#plane-angle').scrollIntoViewIfNeeded();
  assert.ok(await page.locator('#plane-angle canvas').first().isVisible());
  clean();
});

for (const [width, height] of [
  [390, 844],
  [320, 640],
  [800, 1000],
  [844, 390],
])
  test(`${width} × ${height}: nothing is wider than the screen, and a finger hits each control`, async () => {
    const { page, clean } = await stage.page('', {
      viewport: { width, height },
      hasTouch: true,
      isMobile: true,
      folded: true,
    });
    await wholeMap(page);
    // A phone would zoom out over a page that is wider.
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
    const small = await page.evaluate(() =>
      [...document.querySelectorAll('.play button, .play select, .bar button')]
        .filter((one) => one.checkVisibility())
        .map((one) => [one.id || one.textContent, one.getBoundingClientRect()])
        .filter(([, box]) => box.width < 40 || box.height < 40)
        .map(([name, box]) => `${name} ${Math.round(box.width)} × ${Math.round(box.height)}`),
    );
    assert.deepEqual(small, []);
    if (width < 500) {
      const [scene, verdict, map] = await page.evaluate(() =>
        ['scene-card', 'verdict-card', 'studies'].map((id) => document.getElementById(id).getBoundingClientRect().top),
      );
      assert.ok(scene < verdict && verdict < map);
    }
    // A finger drags the point, not the page.
    await page.locator('#map-box').scrollIntoViewIfNeeded();
    const at = await placeOnMap(page, 0.3, 0.3);
    await page.touchscreen.tap(at.x, at.y);
    await reachPhase(page, 'running');
    await page.waitForFunction(() => /theta=0\.1/.test(location.search));
    clean();
  });
