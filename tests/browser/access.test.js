// For everybody: keyboard alone, axe in both schemes, 320 px, colours that follow, motion that stops.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { violations } from './axe.js';
import {
  Stage,
  enter,
  impacts,
  ink,
  loadAll,
  openPanel,
  openTab,
  reachImpact,
  reachPhase,
  verdict,
  runTo,
  releaseTo,
} from './stage.js';

const stage = await Stage.open();

/** Opens all that folds. */
const unfold = (page) =>
  page.locator('details').evaluateAll((all) => {
    for (const details of all) details.open = true;
  });

for (const width of [320, 800, 1280]) {
  test(`axe finds nothing at ${width} px in both schemes`, async () => {
    const { page } = await stage.page('?preset=case-4&colour=blue', {
      viewport: { width, height: 800 },
    });
    await verdict(page);
    assert.deepEqual(await violations(page), [], 'idle, with a notice');
    await releaseTo(page, 3);
    await openPanel(page, 'map');
    await unfold(page);
    await page.fill('#map-x-from', '9');
    await page.locator('#map-x-from').blur();
    assert.deepEqual(await violations(page), [], 'running, with an error in the map');
    await openTab(page, 'values');
    await enter(page, '#field-release-theta', '?');
    await page.locator('#field-release-theta-error', { hasText: 'not a number' }).waitFor();
    assert.deepEqual(await violations(page, '#studies'), [], 'with an error among the values');
    await openTab(page, 'why');
    await unfold(page);
    assert.deepEqual(await violations(page, '#studies'), [], 'with the reasons');
    await loadAll(page, async (panel) =>
      assert.deepEqual(await violations(page, '#studies'), [], `with the panel ${panel}`),
    );
    for (const menu of ['share-open', 'tools-open']) {
      await page.click(`#${menu}`);
      assert.deepEqual(await violations(page, '.bar'), [], menu);
    }
    await page.click('#keys-open');
    assert.deepEqual(await violations(page), [], 'with the dialog');
    await page.keyboard.press('Escape');
    await openTab(page, 'why');
    await page.click('#plane-velocity .enlarge');
    await page.locator('dialog.large').waitFor();
    assert.deepEqual(await violations(page), [], 'with a plane at its largest');
    assert.equal(
      await page.evaluate(
        () => document.querySelector('dialog.large').scrollWidth - document.querySelector('dialog.large').clientWidth,
      ),
      0,
    );
    await page.keyboard.press('Escape');
    await page.keyboard.press('p');
    await page.locator('html.presenting').waitFor();
    assert.deepEqual(await violations(page), [], 'before a room');
    await page.keyboard.press('p');
    await stage.stopServer();
    await page.locator('.notice', { hasText: 'Connection lost' }).waitFor();
    assert.deepEqual(await violations(page), [], 'with the connection lost');
    await stage.startServer();
  });
}

test('a fall, and the page in forced colours, keep their meaning for axe', async () => {
  const { page } = await stage.page('?preset=case-1&scene.table.tilt_gain=1.5&scene.release.theta=0.45', {
    forcedColors: 'active',
  });
  await page.click('#run');
  await page.locator('.ending.fell').waitFor();
  assert.deepEqual(await violations(page), []);
  assert.match(await page.locator('#verdict .headline').innerText(), /▲ Fell/);
});

test('nothing is wider than 320 px', async () => {
  const { page, clean } = await stage.page('?preset=case-4&scene.table.wobble=3', {
    viewport: { width: 320, height: 640 },
  });
  const excess = () => page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  await verdict(page);
  assert.equal(await excess(), 0);
  await releaseTo(page, 3);
  for (const tab of ['values', 'why']) {
    await openTab(page, tab);
    await unfold(page);
    assert.equal(await excess(), 0, tab);
  }
  await loadAll(page, async (panel) => assert.equal(await excess(), 0, panel));
  clean();
});

test('a whole session needs no pointer', async () => {
  const { page, clean } = await stage.judged('?tab=values');
  // What loads later is passed before it is there; the next round reaches it.
  const missing = new Set();
  const tabThrough = async (...ids) => {
    for (const id of ids) missing.add(id);
    for (let k = 0; k < 600 && missing.size > 0; k += 1) {
      await page.keyboard.press('Tab');
      missing.delete(await page.evaluate(() => document.activeElement?.id ?? ''));
    }
    assert.deepEqual([...missing], [], 'Tab reaches all');
  };
  await tabThrough('share-open', 'tools-open', 'present', 'grab', 'run', 'speed', 'scrub', 'why', 'case');
  await tabThrough('tab-values', 'field-table-tilt_gain', 'field-release-theta');
  await page.locator('#tab-values').focus();
  await page.keyboard.press('ArrowLeft');
  await tabThrough('map-box');
  await page.locator('#tools-open').focus();
  await page.keyboard.press('Enter');
  await tabThrough('units', 'keys-open');
  await page.keyboard.press('Escape');
  await page.locator('#case').focus();
  await page.keyboard.press('ArrowDown');
  await page.waitForFunction(() => document.querySelector('#case').selectedIndex === 2);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press(' ');
  await reachPhase(page, 'running');
  await reachImpact(page, 2);
  await page.keyboard.press(' ');
  await reachPhase(page, 'paused');
  await page.waitForTimeout(300);
  const held = await impacts(page);
  await page.keyboard.press('.');
  await reachImpact(page, held + 1);
  await page.keyboard.press('k');
  await page.waitForFunction(() => /kick/.test(location.search));
  await page.keyboard.press('r');
  await page.waitForFunction(() => !/kick/.test(location.search));
  // A drop from the map, and a part of it to look closer.
  await page.locator('#map-box').focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => /tilt_gain/.test(location.search));
  await reachPhase(page, 'running');
  await page.keyboard.press('+');
  await page.waitForFunction(() => /map\.x\.to=/.test(location.search));
  await page.locator('#map-options > summary').focus();
  await page.keyboard.press('Enter');
  await page.locator('.map-told', { hasText: 'cells:' }).waitFor();
  // Its numbers can be saved.
  await page.locator('#map-links').getByRole('link', { name: 'Save as CSV' }).focus();
  const saved = page.waitForEvent('download');
  await page.keyboard.press('Enter');
  assert.equal((await saved).suggestedFilename(), 'equipoise-map.csv');
  await page.evaluate(() => document.activeElement.blur());
  const impactsSaved = page.waitForEvent('download');
  await page.keyboard.press('e');
  await impactsSaved;
  await page.keyboard.press('?');
  assert.ok(await page.locator('#keys').isVisible());
  await page.locator('#keys-on').focus();
  await page.keyboard.press(' ');
  await page.keyboard.press('Escape');
  await reachPhase(page, 'running');
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press(' ');
  await page.waitForTimeout(300);
  assert.equal(await page.locator('#run-state').getAttribute('data-phase'), 'running', 'the key is off');
  clean();
});

test('the colours of the canvases follow the scheme while the page is open', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=why', { colorScheme: 'light' });
  await runTo(page, 5);
  const light = await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue('--series-0'));
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > 10);
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.waitForFunction(
    (before) => getComputedStyle(document.documentElement).getPropertyValue('--series-0') !== before,
    light,
  );
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > 10, 'the dots have the dark scheme’s colour');
  clean();
});

test('with motion unwanted the scene stands still between impacts, unless asked to move', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { reducedMotion: 'reduce' });
  await releaseTo(page, 2);
  // So slow that the next impact is seconds away.
  await page.locator('#speed').evaluate((slider) => {
    slider.value = '0';
    slider.dispatchEvent(new Event('change'));
  });
  await page.waitForFunction(() => /clock\.\d+\.speed=0\.05/.test(location.search));
  const n = await impacts(page);
  await reachImpact(page, n + 1);
  const picture = () => page.locator('#scene-frame canvas').evaluate((canvas) => canvas.toDataURL());
  await page.waitForTimeout(100);
  const before = await picture();
  await page.waitForTimeout(300);
  const still = await picture();
  if ((await impacts(page)) === n + 1) assert.equal(still, before);
  await page.locator('.motion input').check();
  const moving = await picture();
  await page.waitForFunction((old) => document.querySelector('#scene-frame canvas').toDataURL() !== old, moving);
  clean();
});
