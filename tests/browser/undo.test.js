// Undo and redo of each kind of edit, beside the browser's own history.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { GAIN, Stage, changedRun, enter, reachPhase, showChart, slide, speedUp, tool, releaseTo } from './stage.js';

const stage = await Stage.open();

const ready = (page) => page.locator('#undone').waitFor({ state: 'attached' });
const address = (page) => page.evaluate(() => Object.fromEntries(new URLSearchParams(location.search)));
const holds = (page, condition, argument) => page.waitForFunction(condition, argument);

/** A drag of a slider: many moves, then it is let go. */
const drag = (page, selector, values) =>
  page.locator(selector).evaluate((slider, all) => {
    slider.dispatchEvent(new PointerEvent('pointerdown', { bubbles: true }));
    for (const value of all) {
      slider.value = String(value);
      slider.dispatchEvent(new Event('input', { bubbles: true }));
    }
    slider.dispatchEvent(new Event('change', { bubbles: true }));
  }, values);

test('a drag of a slider is one entry, undone by button and by keys, and redone', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  await ready(page);
  assert.ok(await page.locator('#undo').isDisabled());
  await drag(page, GAIN, [1.15, 1.2, 1.25, 1.3]);
  await drag(page, GAIN, [1.4, 1.45]);
  await tool(page, 'undo');
  assert.equal(await page.inputValue(GAIN), '1.3');
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.3');
  assert.equal(await page.locator('#undone').innerText(), 'Undone: tilt gain is 1.3 again.');
  await page.locator(GAIN).focus();
  await page.keyboard.press('Control+z');
  assert.equal(await page.inputValue(GAIN), '1.1');
  await holds(page, () => !/tilt_gain/.test(location.search));
  assert.ok(await page.locator('#undo').isDisabled());
  await page.keyboard.press('Control+Shift+z');
  assert.equal(await page.inputValue(GAIN), '1.3');
  await page.keyboard.press('Control+y');
  assert.equal(await page.inputValue(GAIN), '1.45');
  assert.ok(await page.locator('#redo').isDisabled());
  await holds(page, () => /tilt_gain=1\.45/.test(location.search));
  clean();
});

test('a kick and a live change are undone: the run is replayed without them, where it is', async () => {
  const { page, clean } = await changedRun(stage);
  const before = await address(page);
  const n = await page.locator('#plane-angle .readout').innerText();
  await page.keyboard.press('Control+z');
  assert.equal(await page.locator('#undone').innerText(), 'Undone: the kick.');
  // While it connects again, the address is that of the scene.
  await holds(page, () => !/kick/.test(location.search) && /epoch/.test(location.search));
  await reachPhase(page, 'paused');
  const without = await address(page);
  assert.equal(without.epoch_ms, before.epoch_ms, 'the same release');
  assert.equal(without['interventions.0.set.table.tilt_gain'], '1.2', 'the change stays');
  const clock = (query) => Object.entries(query).filter(([key]) => key.startsWith('clock.'));
  assert.deepEqual(clock(without), clock(before), 'the same place');
  await page.keyboard.press('Control+z');
  await holds(page, () => !/interventions/.test(location.search) && /epoch/.test(location.search));
  assert.equal(await page.inputValue('#field-table-tilt_gain'), '1.1');
  await tool(page, 'redo');
  await tool(page, 'redo');
  await holds(page, () => /kick/.test(location.search) && /tilt_gain=1\.2/.test(location.search));
  await reachPhase(page, 'paused');
  const again = await address(page);
  assert.deepEqual(again, before);
  await holds(page, (words) => document.querySelector('#plane-angle .readout').innerText === words, n);
  clean();
});

test('a case chosen is undone, and the way back of the browser stays', async () => {
  const { page, clean } = await stage.page('?preset=case-1&scene.release.theta=0.2');
  await ready(page);
  await page.selectOption('#case', 'case-3');
  await page.selectOption('#case', 'case-4');
  await tool(page, 'undo');
  assert.equal(await page.inputValue('#case'), 'case-3');
  await tool(page, 'undo');
  assert.equal(await page.inputValue('#case'), 'case-1');
  assert.equal(await page.inputValue('#field-release-theta'), '0.2');
  assert.match(page.url(), /preset=case-1&scene\.release\.theta=0\.2/);
  await page.goBack();
  await holds(page, () => /preset=case-3/.test(location.search));
  await holds(page, () => document.querySelector('#case').value === 'case-3');
  await page.goBack();
  await holds(page, () => document.querySelector('#field-release-theta').value === '0.2');
  clean();
});

test('each drop is undone, by an edit, on the map, of a bounce in a plane, and by a restart: the run before comes back', async () => {
  const { page, clean } = await stage.page('?preset=case-1&map.columns=48');
  await ready(page);
  await page.locator('#map-box[aria-busy=false] canvas').first().waitFor();
  await speedUp(page);
  await releaseTo(page, 3);
  await holds(page, () => /epoch/.test(location.search));
  const { epoch_ms: epoch } = await address(page);
  const theta = () => page.inputValue('#field-release-theta');
  const drops = async (act) => {
    await act();
    await holds(page, (old) => ![old, null].includes(new URLSearchParams(location.search).get('epoch_ms')), epoch);
    await page.keyboard.press('Control+z');
    await holds(page, (old) => new URLSearchParams(location.search).get('epoch_ms') === old, epoch);
    assert.equal(await theta(), '0.3');
    assert.doesNotMatch(page.url(), /scene\.release/);
  };
  // A drag over the map is one entry.
  await drops(async () => {
    const box = await page.locator('#map-box').boundingBox();
    const [x, y] = [box.x + box.width * 0.4, box.y + box.height * 0.6];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y - 20, { steps: 5 });
    await page.mouse.up();
    assert.notEqual(await theta(), '0.3');
  });
  await drops(async () => {
    await page.click('#tab-values');
    await enter(page, '#field-release-theta', '0.1');
    await page.locator('#field-release-theta').blur();
  });
  await drops(() => page.click('#restart'));
  await drops(async () => {
    await showChart(page, 'plane-angle');
    await page.locator('#plane-angle .canvas-box').focus();
    for (const key of ['Home', 'ArrowRight', 'Enter']) await page.keyboard.press(key);
    await page.locator('#ghost-release').click();
  });
  clean();
});

test('a text being edited keeps the browser’s own undo', async () => {
  const { page, clean } = await stage.page('?preset=case-1&tab=values');
  await ready(page);
  await slide(page, GAIN, 1.2);
  const field = page.locator('#field-gravity');
  await enter(page, field, '5');
  await page.keyboard.press('Control+z');
  assert.equal(await page.inputValue(GAIN), '1.2', 'the page’s own undo does not act');
  assert.equal(await page.locator('#undone').textContent(), '');
  clean();
});
