// The shell of the page: what is in sight together, the tabs of the studies, the layout of a phone, the mode for a lecture.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Stage, ink, openSheet, openTab, reachImpact, reachPhase, slide, verdict } from './stage.js';

const stage = await Stage.open();

/** The box of an element within the window, in px; it fails where part of the element is outside of it or covered. */
async function inSight(page, selector) {
  const found = await page
    .locator(selector)
    .first()
    .evaluate((element) => {
      const { left, top, right, bottom, width, height } = element.getBoundingClientRect();
      const within = left >= -1 && top >= -1 && right <= innerWidth + 1 && bottom <= innerHeight + 1;
      const hit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
      return {
        left,
        top,
        width,
        height,
        within,
        free: Boolean(hit && (element.contains(hit) || hit.contains(element))),
      };
    });
  assert.ok(found.width > 0 && found.height > 0, `${selector} has a size`);
  assert.ok(found.within, `${selector} is in sight: ${JSON.stringify(found)}`);
  assert.ok(found.free, `${selector} is covered`);
  return found;
}

const excess = (page) => page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
const ready = (page) => page.locator('#present:enabled').waitFor({ state: 'attached' });

for (const [width, height] of [
  [1280, 800],
  [1440, 900],
  [1920, 1080],
])
  test(`scene, planes, verdict, run and the edited parameter share ${width} × ${height}`, async () => {
    const { page, clean } = await stage.page('?preset=case-1', { viewport: { width, height } });
    await verdict(page);
    await page.locator('#field-release-theta').focus();
    assert.equal(await page.evaluate(() => scrollY), 0, 'the settings scroll, not the page');
    for (const selector of [
      '#scene-frame',
      '#plane-angle .canvas-box',
      '#plane-velocity .canvas-box',
      '#circle .canvas-box',
      '.verdict-words',
      '#run',
      '#gain',
      '#case',
      '#field-release-theta',
      '.field:has(#field-release-theta) input[type=range]',
      '#tab-run',
    ])
      await inSight(page, selector);
    const scene = await inSight(page, '#scene-frame');
    assert.ok(scene.width > 550 && scene.height > 180, JSON.stringify(scene));
    assert.equal(await excess(page), 0);
    clean();
  });

test('nothing in the workbench moves while a run begins, goes on and falls', async () => {
  const { page, clean } = await stage.page('?preset=case-3&scene.release.theta=0.3', {
    viewport: { width: 1280, height: 800 },
  });
  await verdict(page);
  await ready(page);
  const places = () =>
    page.evaluate(() =>
      ['scene-frame', 'run', 'gain', 'plane-angle', 'circle', 'tabs', 'verdict-card'].map((id) => {
        const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
        return [id, ...[x, y, width, height].map(Math.round)].join(' ');
      }),
    );
  const before = await places();
  await page.click('#run');
  await slide(page, '#speed', 100);
  await reachImpact(page, 3);
  assert.deepEqual(await places(), before, 'while it runs');
  await reachPhase(page, 'ended');
  assert.deepEqual(await places(), before, 'after its end');
  clean();
});

test('the chart of the shared place is switched, and both can be', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 1280, height: 800 } });
  await verdict(page);
  const energy = page.locator('.switch [aria-controls=energy]');
  await energy.waitFor();
  assert.ok(!(await page.locator('#energy').isVisible()));
  await energy.click();
  await inSight(page, '#energy .canvas-box');
  assert.ok(!(await page.locator('#circle').isVisible()));
  assert.equal(await energy.getAttribute('aria-pressed'), 'true');
  await page.locator('.switch [aria-controls=circle]').click();
  await inSight(page, '#circle .canvas-box');
  clean();
});

test('arrow keys, Home and End go through the tabs, and the address names the open one', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 1280, height: 800 } });
  await verdict(page);
  await ready(page);
  const names = await page.locator('#tabs [role=tab]').allInnerTexts();
  assert.ok(names.length >= 9, names.join(' · '));
  await page.locator('#tab-run').focus();
  const open = async () => {
    const shown = await page.locator('[role=tabpanel]:visible').evaluateAll((panels) => panels.map(({ id }) => id));
    const at = await page.evaluate(() => document.activeElement.id);
    assert.deepEqual(shown, [at.replace('tab-', 'panel-')]);
    assert.equal(await page.locator(`#${at}`).getAttribute('aria-selected'), 'true');
    assert.equal(await page.locator('#tabs [tabindex="0"]').count(), 1);
    return at;
  };
  await page.keyboard.press('ArrowRight');
  assert.equal(await open(), 'tab-map');
  await page.waitForFunction(() => new URLSearchParams(location.search).get('tab') === 'map');
  await page.keyboard.press('End');
  assert.equal(await open(), 'tab-api');
  await page.keyboard.press('ArrowRight');
  assert.equal(await open(), 'tab-run');
  await page.waitForFunction(() => !new URLSearchParams(location.search).has('tab'));
  await page.keyboard.press('ArrowLeft');
  assert.equal(await open(), 'tab-api');
  await page.keyboard.press('Home');
  assert.equal(await open(), 'tab-run');
  clean();
});

test('a link opens its tab, one with a panel in it the tab of the panel, and a tab that there is not is told', async () => {
  for (const [query, tab] of [
    ['tab=orbits', 'orbits'],
    ['map.columns=48', 'map'],
    ['tab=api&map.columns=48', 'api'],
    ['survival.runs=30', 'noise'],
  ]) {
    const { page, clean } = await stage.page(`?preset=case-1&${query}`);
    await page.locator(`#tab-${tab}[aria-selected=true]`).waitFor();
    assert.ok(await page.locator(`#panel-${tab}`).isVisible(), query);
    if (query.includes('map.columns')) assert.match(page.url(), /map\.columns=48/);
    assert.equal(await page.locator('.notice').count(), 0);
    clean();
  }
  const { page, clean } = await stage.page('?preset=case-1&tab=kitchen');
  await page.locator('.notice', { hasText: '“kitchen”' }).waitFor();
  assert.equal(await page.locator('#tab-run').getAttribute('aria-selected'), 'true');
  clean();
});

test('nothing of a tab is loaded or computed before it is opened, nor asked for while another is open', async () => {
  const asked = [];
  const { page, clean } = await stage.page('?preset=case-1', {
    watch: (one) => one.on('request', (request) => asked.push(new URL(request.url()).pathname)),
  });
  await verdict(page);
  await ready(page);
  await page.waitForTimeout(500);
  const panels = /\/panels\/(map|survival|design|catch|branch|measured|calls)\//;
  const studies = /\/v1\/(ladder|ensembles|periodic-orbits|precision|design|catches|failure-cases)/;
  assert.deepEqual(
    asked.filter((path) => panels.test(path) || studies.test(path)),
    [],
  );
  await openTab(page, 'orbits');
  await page.locator('#branch-body svg.figure').waitFor();
  assert.ok(asked.some((path) => path.includes('/panels/branch/')));
  assert.ok(!asked.some((path) => /\/panels\/(map|survival|design)\//.test(path)));
  await openTab(page, 'run');
  asked.length = 0;
  await slide(page, '#gain', 1.3);
  await page.waitForFunction(() => /tilt_gain=1\.3/.test(location.search));
  await verdict(page);
  await page.waitForTimeout(500);
  assert.deepEqual(
    asked.filter((path) => studies.test(path)),
    [],
  );
  await openTab(page, 'orbits');
  await page.waitForFunction(() => document.querySelector('#branch-body').textContent.length > 0);
  clean();
});

test('no tab is wider than 320 px, nor than a tablet', async () => {
  for (const width of [320, 800]) {
    const { page, clean } = await stage.page('?preset=case-1', { viewport: { width, height: 700 } });
    await verdict(page);
    await page.locator('#tab-api').waitFor({ state: 'attached' });
    for (const tab of await page.locator('#tabs [role=tab]').evaluateAll((tabs) => tabs.map(({ id }) => id))) {
      await openTab(page, tab.replace('tab-', ''));
      await page.waitForTimeout(300);
      assert.equal(await excess(page), 0, `${tab} at ${width} px`);
      const wider = await page
        .locator('#studies')
        .evaluate((studies) => studies.scrollWidth - Math.ceil(studies.getBoundingClientRect().width));
      assert.ok(wider <= 0, `${tab} is ${wider} px wider than its sheet at ${width} px`);
    }
    clean();
    await page.close();
  }
});

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

test('on a phone scene, plane, tilt gain and run are in sight, and what a thumb presses is 48 px', async () => {
  const { page, clean } = await stage.page('?preset=case-1', PHONE);
  await verdict(page);
  await ready(page);
  await page.locator('#run').tap();
  await reachImpact(page, 2);
  for (const selector of ['#headline', '#scene-frame', '#scrub', '#plane-angle .canvas-box', '#gain', '#run', '#kick'])
    await inSight(page, selector);
  const targets = [
    '#run',
    '#kick',
    '#gain',
    '#tools-open',
    ...['settings', 'verdict-card', 'studies'].map((id) => `#parts [aria-controls=${id}]`),
  ];
  if (await page.locator('#pin').count()) targets.push('#pin');
  for (const selector of targets) {
    const { width, height } = await inSight(page, selector);
    assert.ok(width >= 48 && height >= (selector === '#tools-open' ? 39 : 48), `${selector} is ${width} × ${height}`);
  }
  assert.match(await page.locator('#headline').innerText(), /keeps balance/i);
  await page.evaluate(() => scrollTo(0, 500));
  await inSight(page, '#headline');
  await inSight(page, '#run');
  assert.equal(await excess(page), 0);
  clean();
});

test('on a phone one chart fills the width, and one swipes or taps to the next', async () => {
  const { page, clean } = await stage.page('?preset=case-1', PHONE);
  await verdict(page);
  await ready(page);
  const { width } = await inSight(page, '#plane-angle');
  assert.ok(width > 370);
  /** The chart has come to rest in the middle of the page: it is in one place at two looks. What is scrolled before is lost. */
  const still = (id) =>
    page.waitForFunction(
      (name) => {
        const chart = document.getElementById(name);
        const left = String(chart.getBoundingClientRect().left);
        const rests = Math.abs(Number(left) - 7.5) < 2 && chart.dataset.seenAt === left;
        chart.dataset.seenAt = left;
        return rests;
      },
      id,
      { polling: 150 },
    );
  await page.locator('#chart-tabs button').nth(1).tap();
  await page.locator('#chart-tabs button:nth-child(2)[aria-current=true]').waitFor();
  await still('plane-velocity');
  await inSight(page, '#plane-velocity');
  await page.locator('#charts').evaluate((charts) => charts.scrollBy({ left: charts.clientWidth }));
  await page.locator('#chart-tabs button:nth-child(3)[aria-current=true]').waitFor();
  await still('circle');
  await inSight(page, '#circle');
  clean();
});

test('on a phone the rest is in sheets: the focus is led there and back, Escape closes, the scene stays in sight', async () => {
  const { page, clean } = await stage.page('?preset=case-1', PHONE);
  await verdict(page);
  await ready(page);
  for (const id of ['settings', 'verdict-card', 'studies']) {
    const button = page.locator(`#parts [aria-controls=${id}]`);
    assert.ok(!(await page.locator(`#${id}`).isVisible()));
    await button.tap();
    assert.ok(await page.locator(`#${id}`).isVisible());
    assert.equal(await button.getAttribute('aria-expanded'), 'true');
    assert.ok(await page.evaluate((name) => document.getElementById(name).contains(document.activeElement), id));
    await inSight(page, '#run');
    await inSight(page, '#gain');
    await page.keyboard.press('Escape');
    assert.ok(!(await page.locator(`#${id}`).isVisible()));
    assert.ok(await button.evaluate((element) => document.activeElement === element));
  }
  await openSheet(page, 'settings');
  await openSheet(page, 'verdict-card');
  assert.ok(!(await page.locator('#settings').isVisible()), 'one at a time');
  const sheet = await page.locator('#verdict-card').boundingBox();
  const scene = await page.locator('#scene-frame').boundingBox();
  assert.ok(sheet.y > scene.y + 40, 'the scene shows above the sheet');
  await page.locator('#verdict-card .sheet-close').tap();
  assert.ok(!(await page.locator('#verdict-card').isVisible()));
  // What the header has no room for.
  await page.locator('#tools-open').tap();
  await inSight(page, '#share');
  await page.keyboard.press('Escape');
  assert.ok(!(await page.locator('#share').isVisible()));
  clean();
});

for (const [name, width, height] of [
  ['a phone on its side', 844, 390],
  ['a page at 200 %', 640, 400],
])
  test(`${name} shows the rod, a chart and the controls together`, async () => {
    const { page, clean } = await stage.page('?preset=case-1', { viewport: { width, height } });
    await verdict(page);
    await ready(page);
    await page.click('#run');
    await reachImpact(page, 2);
    const scene = await inSight(page, '#scene-frame');
    const plane = await inSight(page, '#plane-angle .canvas-box');
    assert.ok(plane.left >= scene.left + scene.width - 8, 'beside each other');
    const tops = [];
    for (const selector of ['#run', '#kick', '#gain', '#parts [aria-controls=settings]'])
      tops.push((await inSight(page, selector)).top);
    assert.ok(Math.max(...tops) - Math.min(...tops) < 20, 'in one bar');
    await inSight(page, '#headline');
    await openSheet(page, 'settings');
    const sheet = await page.locator('#settings').boundingBox();
    assert.ok(sheet.x > scene.left + 0.75 * scene.width, 'most of the scene shows beside the sheet');
    assert.equal(await excess(page), 0);
    clean();
  });

test('a lecture shows scene, one plane and headline, large, with all keys alive', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 1280, height: 800 } });
  await verdict(page);
  await ready(page);
  const small = await page.locator('#plane-angle').boundingBox();
  await page.keyboard.press('p');
  await page.locator('html.presenting').waitFor();
  for (const selector of ['#scene-frame', '#plane-angle .canvas-box', '#headline', '#run'])
    await inSight(page, selector);
  for (const selector of ['#settings', '#verdict-card', '#studies', '#plane-velocity', '#circle'])
    assert.ok(!(await page.locator(selector).isVisible()), selector);
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).fontSize), '20px');
  assert.ok((await page.locator('#plane-angle').boundingBox()).height > 1.8 * small.height);
  assert.match(await page.locator('#headline').innerText(), /keeps balance/i);
  await page.keyboard.press(' ');
  await reachPhase(page, 'running');
  await reachImpact(page, 3);
  await page.keyboard.press(' ');
  await reachPhase(page, 'paused');
  // Dots of 6 px and more: each has at least the pixels of such a disc.
  const dots = Number(/^n\s(\d+)/.exec(await page.locator('#plane-angle .readout').innerText())[1]);
  assert.ok((await ink(page, '#plane-angle', '--series-0')) > dots * 14, `${dots} dots`);
  await page.keyboard.press('2');
  await page.waitForFunction(() => document.querySelector('#case').value === 'case-2');
  await page.keyboard.press('?');
  assert.ok(await page.locator('#keys').isVisible());
  await page.keyboard.press('Escape');
  await page.keyboard.press('p');
  await page.locator('html:not(.presenting)').waitFor();
  await inSight(page, '#plane-velocity');
  await page.click('#present');
  await page.locator('html.presenting').waitFor();
  assert.equal(await page.locator('#present').getAttribute('aria-pressed'), 'true');
  await page.keyboard.press('m');
  await page.locator('html:not(.presenting)').waitFor();
  await page.locator('#panel-map').waitFor();
  clean();
});

test('a pointer means in the large picture what it points at', async () => {
  const { page, clean } = await stage.page('?preset=case-1', { viewport: { width: 1280, height: 800 } });
  await verdict(page);
  await ready(page);
  await page.click('#run');
  await reachImpact(page, 8);
  await page.click('#run');
  await reachPhase(page, 'paused');
  await page.keyboard.press('p');
  await page.locator('html.presenting').waitFor();
  const box = await page.locator('#plane-angle .canvas-box').boundingBox();
  const at = (x, y) => [box.x + box.width * x, box.y + box.height * y];
  await page.mouse.move(...at(0.17, 0.09));
  await page.mouse.down();
  await page.mouse.move(...at(0.5, 0.5));
  await page.mouse.move(...at(0.96, 0.9));
  await page.mouse.up();
  // Nearly all of the frame, and so nearly all of the impacts.
  const counts = await page.waitForFunction(() =>
    /(\d+) of (\d+)/.exec(document.querySelector('#brush-told').textContent)?.slice(1).map(Number),
  );
  const [some, of] = await counts.jsonValue();
  assert.ok(some >= 0.8 * of, `${some} of ${of}`);
  clean();
});

test('the keys of the run act while a chart is large', async () => {
  const { page, clean } = await stage.page('?preset=case-1');
  await verdict(page);
  await ready(page);
  await page.locator('#plane-angle .enlarge').click();
  await page.locator('dialog.large').waitFor();
  await page.keyboard.press(' ');
  await reachPhase(page, 'running');
  await reachImpact(page, 2);
  await page.keyboard.press(' ');
  await reachPhase(page, 'paused');
  assert.ok(await page.locator('dialog.large').isVisible());
  await page.keyboard.press('m');
  await page.locator('dialog.large').waitFor({ state: 'detached' });
  await page.locator('#panel-map').waitFor();
  clean();
});
