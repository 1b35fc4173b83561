// Speed of the page, in headless Chromium against a server on loopback: `node benches/page.mjs [--write]`, after
// `tests/run browser` has installed its packages. With `--write` it writes docs/page-speed.md. Figures depend on the machine and are
// not asserted; the page's behaviour is tested in tests/browser.

import { cpus, loadavg } from 'node:os';
import { writeFile } from 'node:fs/promises';
import { Stage, reachImpact } from '../tests/browser/stage.js';

const stage = await Stage.open(null);
const viewport = { width: 1280, height: 1500 };
/** @type {[string, string, string][]} what, wanted, measured */
const figures = [];
const tell = (what, wanted, measured) => { figures.push([what, wanted, measured]); console.log(`${what}: ${measured} (wanted ${wanted})`); };
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
tell('First plot, cold', '≤ 500 ms', `${median(plots).toFixed(0)} ms (${sorted(plots)[0].toFixed(0)} to ${sorted(plots).at(-1).toFixed(0)})`);

{
  const { page } = await stage.page('?preset=case-1&speed=10', { viewport });
  await page.click('#run');
  await reachImpact(page, 20);
  const plain = await frames(page, 6);
  tell('Main thread in a live run with scene and four plots', '≤ 4 ms a frame', `${plain.msPerFrame.toFixed(2)} ms a frame at ${plain.perSecond.toFixed(1)} frames a second`);
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setCPUThrottlingRate', { rate: 4 });
  const slow = await frames(page, 6);
  await session.send('Emulation.setCPUThrottlingRate', { rate: 1 });
  tell('The same with a processor four times slower', '≥ 55 frames a second', `${slow.perSecond.toFixed(1)} frames a second`);
  await page.context().close();
}

{
  const { page } = await stage.page('?preset=case-1', { viewport });
  await page.click('#run');
  await reachImpact(page, 3);
  await page.evaluate(() => {
    globalThis.waits = [];
    new PerformanceObserver((list) => globalThis.waits.push(...list.getEntries().filter(({ name }) => name === 'input' || name === 'keydown').map(({ duration }) => duration))).observe({ type: 'event', durationThreshold: 16, buffered: false });
  });
  await page.locator('#gain').focus();
  for (let k = 0; k < 60; k += 1) {
    await page.keyboard.press(k % 2 ? 'ArrowLeft' : 'ArrowRight');
    await wait(30);
  }
  await wait(300);
  const waits = await page.evaluate(() => globalThis.waits);
  tell('Slider to the next paint, worst of 60', '≤ 100 ms', waits.length > 0 ? `${Math.max(...waits)} ms` : 'under 16 ms');
  await page.context().close();
}

{
  // Some hundred bounces a second, so that many pass while one waits.
  const { page } = await stage.page('?preset=case-1&scene.release.theta=0&scene.release.height=0.1336&speed=20', { viewport });
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
  const { page } = await stage.page('', { viewport });
  const redraw = await page.evaluate(async () => {
    const [{ Impacts, COLUMNS }, { anglePlane }] = await Promise.all([import('/impacts.js'), import('/plane.js')]);
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

if (process.argv.includes('--write')) {
  const rows = figures.map((row) => `| ${row.join(' | ')} |`).join('\n');
  const [{ model }] = cpus();
  await writeFile(new URL('../docs/page-speed.md', import.meta.url), `# Speed of the page

Written by \`node benches/page.mjs --write\` in headless Chromium without a graphics card, server and browser on ${cpus().length} cores of one ${model.trim()},
load ${loadavg()[0].toFixed(1)} at the end. Medians, with the range where there is one.

| what | wanted | measured |
|---|---|---|
${rows}
`);
}
await stage.close();
