// Speed of the page, in headless Chromium against a server on loopback: `node benches/page.mjs`, after `tests/run browser` has installed its
// packages. It prints the part of docs/measurements.md that `benches/run page` writes. Figures depend on the machine and are not asserted;
// the page's behaviour is tested in tests/browser.

import { cpus, loadavg } from 'node:os';
import { beforeRun, firstScreen } from '../tests/browser/first-screen.js';
import { Stage, reachImpact } from '../tests/browser/stage.js';

const stage = await Stage.open(null);
const viewport = { width: 1280, height: 1500 };
const DESK = { width: 1280, height: 800 };
/** @type {[string, string, string][]} name, wanted, measured */
const figures = [];
const tell = (what, wanted, measured) => { figures.push([what, wanted, measured]); console.error(`${what}: ${measured} (wanted ${wanted})`); };
const sorted = (values) => values.toSorted((a, b) => a - b);
const median = (values) => sorted(values)[values.length >> 1];
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Frames, and the processor time of the main thread, over some seconds, by the browser's own count. */
async function frames(page, seconds) {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const metrics = async () => Object.fromEntries((await session.send('Performance.getMetrics')).metrics.map(({ name, value }) => [name, value]));
  await page.evaluate(() => {
    // The counter starts once.
    if (globalThis.frameCount !== undefined) return;
    globalThis.frameCount = 0;
    const count = () => { globalThis.frameCount += 1; requestAnimationFrame(count); };
    requestAnimationFrame(count);
  });
  const count = () => page.evaluate(() => [globalThis.frameCount, performance.now()]);
  const [before, [from, begin]] = [await metrics(), await count()];
  await wait(seconds * 1000);
  const [after, [to, end]] = [await metrics(), await count()];
  await session.detach();
  return { perSecond: (to - from) / (end - begin) * 1000, msPerFrame: (after.TaskDuration - before.TaskDuration) * 1000 / (to - from) };
}

// Cold: a new profile each time, with an empty cache.
const plots = [];
for (let round = 0; round < 9; round += 1) {
  const { page } = await stage.page('', { viewport });
  await page.waitForFunction(() => performance.getEntriesByName('first plot').length > 0);
  plots.push(await page.evaluate(() => performance.getEntriesByName('first plot')[0].startTime));
  await page.context().close();
}
tell('First picture, cold', '≤ 500 ms', `${median(plots).toFixed(0)} ms (${sorted(plots)[0].toFixed(0)} to ${sorted(plots).at(-1).toFixed(0)})`);

{
  const { page } = await stage.page('?preset=case-1&speed=10&tab=why', { viewport });
  await page.click('#run');
  await reachImpact(page, 20);
  const plain = await frames(page, 6);
  tell('Main thread in a live run with the reasons open: scene and four charts', '≤ 4 ms a frame', `${plain.msPerFrame.toFixed(2)} ms a frame at ${plain.perSecond.toFixed(1)} frames a second`);
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  const slow = await frames(page, 6);
  await session.send('Emulation.setCPUThrottlingRate', { rate: 1 });
  tell('The same with a processor four times slower', '≥ 55 frames a second', `${slow.perSecond.toFixed(1)} frames a second`);
  await page.context().close();
}

{
  const { page } = await stage.page('', { viewport: DESK, folded: true, autorun: true });
  await page.locator('#map-told', { hasText: /^98.304 cells/ }).waitFor({ state: 'attached' });
  await page.locator('.facts', { hasText: 'ends it' }).waitFor();
  const { controls, words, smallest, scene, map } = await firstScreen(page);
  tell('Controls in view at 1280 × 800', '≤ 25', String(controls.length));
  tell('Words in view there', '≤ 100', String(words));
  tell('Smallest text there', '≥ 13 px', `${smallest.toFixed(1)} px`);
  tell('Shares of scene and map there', '≥ 30 % and 25 %', `${(100 * scene).toFixed(0)} % and ${(100 * map).toFixed(0)} %`);
  const { requests } = await beforeRun(page);
  tell('Requests before the first run', '≤ 45', String(requests));
  await page.evaluate(() => {
    globalThis.waits = [];
    new PerformanceObserver((list) => globalThis.waits.push(...list.getEntries().filter(({ name }) => /^(pointermove|pointerdown|input)$/.test(name)).map(({ duration }) => duration))).observe({ type: 'event', durationThreshold: 16, buffered: false });
  });
  const { x, y, width, height } = await page.locator('#map-box').boundingBox();
  await page.mouse.move(x + 80, y + height / 2);
  await page.mouse.down();
  for (let k = 0; k < 100; k += 1) {
    await page.mouse.move(x + 80 + (width - 120) * k / 100, y + height / 2 - 20 * Math.sin(k / 5));
    await wait(30);
  }
  await page.mouse.up();
  await page.click('#tab-values');
  const slider = page.locator('.field:has(#field-contact-friction) input[type=range]');
  await slider.focus();
  for (let k = 0; k < 60; k += 1) {
    await page.keyboard.press('ArrowRight');
    await wait(30);
  }
  await wait(300);
  const waits = sorted(await page.evaluate(() => globalThis.waits));
  const at = waits[Math.floor(0.95 * waits.length)] ?? 0;
  tell('A drag on the map, or of a value, to the next picture with the body falling anew, 95th of 100', '≤ 100 ms', at > 16 ? `${at} ms` : 'under 16 ms');
  await page.context().close();
}

{
  const { page } = await stage.page('', { viewport: DESK, folded: true, autorun: true, begun: true, path: 'health/live', sign: 'body' });
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', { offline: false, latency: 150, downloadThroughput: 1.6e6 / 8, uploadThroughput: 1.6e6 / 8 });
  await session.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  await page.goto(stage.url);
  await page.waitForFunction(() => document.querySelector('#run-state')?.dataset.phase === 'running', null, { polling: 'raf' });
  const running = await page.evaluate(() => performance.now());
  tell('A running body at 150 ms, 1.6 Mbit/s, a processor four times slower', '≤ 3.5 s', `${(running / 1000).toFixed(1)} s`);
  await page.waitForFunction(() => performance.getEntriesByName('all parts').length > 0);
  tell('Frames there once all parts are loaded', '≥ 50 a second', `${(await frames(page, 6)).perSecond.toFixed(0)} a second`);
  await page.context().close();
}

{
  // Some hundred bounces a second, so that many pass while one waits.
  const { page } = await stage.page('?preset=case-1&scene.release.theta=0&scene.release.height=0.1336&speed=20&tab=why', { viewport });
  await page.click('#run');
  await reachImpact(page, 5000);
  const session = await page.context().newCDPSession(page);
  const heap = async () => { await session.send('HeapProfiler.collectGarbage'); const { usedSize, backingStorageSize = 0 } = await session.send('Runtime.getHeapUsage'); return { used: usedSize, arrays: backingStorageSize }; };
  const before = await heap();
  const first = Number(/\d+/.exec(await page.locator('#plane-angle .readout').innerText())[0]);
  await wait(60_000);
  const after = await heap();
  const last = Number(/\d+/.exec((await page.locator('#plane-angle .readout').innerText()).replace(/\s(?=\d{3})/g, ''))[0]);
  tell(`Heap growth over ${(last - first).toLocaleString('en')} impacts in a minute`, '≤ 5 MB', `${((after.used - before.used) / 1e6).toFixed(2)} MB, and ${((after.arrays - before.arrays) / 1e6).toFixed(2)} MB of arrays`);
  await page.context().close();
}

{
  // Hidden charts draw nothing.
  const { page } = await stage.page('?tab=why', { viewport });
  const redraw = await page.evaluate(async () => {
    const [{ Impacts, COLUMNS }, { anglePlane }] = await Promise.all([import('/run/impacts.js'), import('/charts/impacts/plots.js')]);
    const impacts = new Impacts(1 << 18);
    for (let n = 1; n <= 1e5; n += 1) impacts.append(/** @type {any} */ (Object.fromEntries(COLUMNS.map((name) => [name, name === 'n' ? n : name === 'series' ? 0 : Math.sin(n * 0.7 + name.length) * 0.3]))));
    const plot = anglePlane(impacts);
    document.querySelector('#charts').append(plot.figure.element);
    // The drawing of many dots is loaded when there are many.
    await new Promise((done) => setTimeout(done, 1000));
    const times = [];
    for (let round = 0; round < 21; round += 1) {
      plot.redraw();
      const begin = performance.now();
      plot.draw(begin);
      times.push(performance.now() - begin);
    }
    return { times, kept: impacts.end - impacts.begin };
  });
  tell(`${redraw.kept.toLocaleString('en')} points redrawn`, '≤ 5 ms for 1e5', `${median(redraw.times).toFixed(1)} ms (${sorted(redraw.times)[0].toFixed(1)} to ${sorted(redraw.times).at(-1).toFixed(1)})`);
  await page.context().close();
}

console.log(`Written by \`benches/run page\` in headless Chromium without a graphics card, server and browser on ${cpus().length} cores of one
${cpus()[0].model.trim()}, load ${loadavg()[0].toFixed(1)} at the end. Medians, with the range where there is one.

| | wanted | measured |
|---|---|---|
${figures.map((row) => `| ${row.join(' | ')} |`).join('\n')}`);
await stage.close();
