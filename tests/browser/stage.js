// The stage of every browser test: the server on a free port, Chromium, and an eye on what a page must never do.

import { spawn } from 'node:child_process';
import { createServer } from 'node:net';
import { after, afterEach } from 'node:test';
import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';

const PROGRAM = process.env.EQUIPOISE ?? new URL('../../target/release/equipoise', import.meta.url).pathname;
const FLAGS = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  // The first two as Playwright has them; with the others each window loads two pages for its address bar.
  '--disable-features=HttpsUpgrades,PaintHolding,WebUIOmniboxPopup,WebUIOmniboxAimPopup,WebUIOmniboxFullPopup',
];
/** The page itself, once its first parts are there. */
const BEGUN = '#case:enabled';
/** Choices of most tests: they reach every setting and the time line. */
const UNFOLDED = {
  groups: JSON.stringify(['Release', 'Body', 'Table', 'Feedback', 'Limits', 'Noise', 'World']),
  time: 'on',
};
/** Slows the page down by so many times, to find races. */
const THROTTLE = Number(process.env.THROTTLE ?? 1);
/** How long a condition may take before a test gives up; no test measures speed by it. */
export const PATIENCE_MS = Number(process.env.PATIENCE ?? 120_000);

async function freePort() {
  const probe = createServer().listen(0, '127.0.0.1');
  await new Promise((resolve) => probe.once('listening', resolve));
  const { port } = probe.address();
  await new Promise((resolve) => probe.close(resolve));
  return port;
}

export class Stage {
  #server = null;
  #browser = null;
  #contexts = [];

  /** Outside of tests, without their hooks. @param {{after: Function, afterEach: Function} | null} hooks @param {string[]} flags of the server */
  static async open(hooks = { after, afterEach }, flags = []) {
    const stage = new Stage();
    stage.flags = flags;
    stage.port = await freePort();
    stage.url = `http://127.0.0.1:${stage.port}/`;
    hooks?.after(() => stage.close());
    // A page that is left open goes on running beside the next test.
    hooks?.afterEach(() => Promise.all(stage.#contexts.splice(0).map((context) => context.close())));
    await stage.startServer();
    stage.#browser = await chromium.launch({
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: FLAGS,
    });
    return stage;
  }

  async startServer() {
    const server = spawn(PROGRAM, ['--listen', `127.0.0.1:${this.port}`, ...this.flags], {
      stdio: ['ignore', 'ignore', 'inherit'],
    });
    this.#server = server;
    let gone = null;
    server.once('error', (error) => {
      gone = error;
    });
    server.once('exit', (code) => {
      gone ??= new Error(`the server ended with ${code}`);
    });
    for (;;) {
      if (gone) throw gone;
      const answer = await fetch(`${this.url}health/ready`).catch(() => null);
      if (answer?.ok) return;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  async stopServer() {
    const server = this.#server;
    this.#server = null;
    if (!server || server.exitCode !== null) return;
    const ended = new Promise((resolve) => server.once('exit', resolve));
    server.kill('SIGKILL');
    await ended;
  }

  /** Pieces of work that the server does at the moment. */
  async running() {
    const metrics = await (await fetch(`${this.url}metrics`)).text();
    return Number(/^equipoise_jobs_running (\d+)$/m.exec(metrics)[1]);
  }

  async close() {
    await this.#browser?.close();
    await this.stopServer();
  }

  /**
   * A page in a fresh browser profile, and what it did wrong so far.
   * @param {string} query
   * @param {object} options of Playwright's context; `prepare`, which the page runs before its own code; `watch`, which sees the page before
   * it loads; another `path`, and the `sign` that it is there; `folded` settings; `autorun`, to let it run by itself; choices that are
   * `stored` from earlier visits; `begun`, to take it as soon as its first parts are there
   */
  async page(
    query = '',
    { prepare, path = '', sign = BEGUN, watch, folded, autorun, stored, begun = false, ...options } = {},
  ) {
    const context = await this.#browser.newContext({ viewport: { width: 1280, height: 860 }, ...options });
    this.#contexts.push(context);
    await context.grantPermissions(['clipboard-read', 'clipboard-write']);
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    if (THROTTLE > 1)
      await (await context.newCDPSession(page)).send('Emulation.setCPUThrottlingRate', { rate: THROTTLE });
    const wrongs = [];
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) wrongs.push(`console: ${message.text()}`);
    });
    page.on('pageerror', (error) => wrongs.push(`exception: ${error.stack}`));
    page.on('request', (request) => {
      if (!request.url().startsWith(this.url)) wrongs.push(`request elsewhere: ${request.url()}`);
    });
    page.on('websocket', (socket) => {
      if (!socket.url().startsWith(this.url.replace('http', 'ws'))) wrongs.push(`socket elsewhere: ${socket.url()}`);
    });
    await page.addInitScript(() =>
      addEventListener('securitypolicyviolation', (event) =>
        console.error(`policy: ${event.violatedDirective} ${event.blockedURI}`),
      ),
    );
    await page.addInitScript(
      (choices) => {
        try {
          for (const [name, choice] of Object.entries(choices)) localStorage[`equipoise.${name}`] ??= choice;
        } catch {
          /* a page that may not store anything */
        }
      },
      { ...(!folded && UNFOLDED), ...(!autorun && { autorun: 'off' }), ...stored },
    );
    watch?.(page);
    if (prepare) await page.addInitScript(prepare);
    await page.goto(this.url + path + query);
    await page.locator(sign).first().waitFor();
    if (sign === BEGUN && !begun)
      await page.waitForFunction(() => performance.getEntriesByName('all parts').length > 0);
    /** Nothing went wrong, but for what is `allowed`. @param {RegExp} [allowed] */
    const clean = (allowed) =>
      assert.deepEqual(
        wrongs.filter((wrong) => !allowed?.test(wrong)),
        [],
      );
    return { page, context, wrongs, clean };
  }

  /** The same, once it has its verdict. */
  async judged(query, options) {
    const opened = await this.page(query, options);
    await verdict(opened.page);
    return opened;
  }
}

/** Waits until the server does nothing more: far less than the work would take that was cancelled. @param {Stage} stage */
export async function free(stage) {
  const begin = Date.now();
  while ((await stage.running()) > 0) {
    assert.ok(Date.now() - begin < 5000, 'the work goes on for nobody');
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/**
 * From now on keeps what the page hears from a path that tells its progress, and gives the answers; null for one that broke off.
 * Browsers do not always keep the body of a stream for who looks at it from outside.
 */
export async function answersOf(page, path) {
  await page.evaluate((wanted) => {
    const real = globalThis.fetch;
    globalThis.answers = [];
    globalThis.fetch = async (input, init) => {
      const response = await real(input, init);
      if (String(input).includes(wanted))
        globalThis.answers.push(
          response
            .clone()
            .text()
            .then((text) => JSON.parse(text.trim().split('\n').at(-1)).end ?? null)
            .catch(() => null),
        );
      return response;
    };
  }, path);
  return () => page.evaluate(() => Promise.all(globalThis.answers));
}

/** Types into a field and commits it: by Enter, or by leaving one of several lines. Opens the values for one of them. */
export async function enter(page, field, text) {
  const input = typeof field === 'string' ? page.locator(field) : field;
  if (await input.evaluate((element) => element.closest('#panel-values')?.hidden)) await openTab(page, 'values');
  await input.fill(text);
  if (await input.evaluate(({ localName }) => localName === 'textarea')) await input.blur();
  else await input.press('Enter');
}

/** Waits until the verdict belongs to what is typed, and gives its words. */
export async function verdict(page) {
  await page.waitForFunction(() =>
    ['#verdict[aria-busy=false]', '.verdict-words'].every((one) => document.querySelector(one)),
  );
  return page.locator('.verdict-words').innerText();
}

/** A text with plain spaces and minus signs. */
export const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');

/** The drawn values of a picture at rest, which has four decimals of the time. */
export async function poseOf(page) {
  await drawn(page);
  await page.locator('#scene-readout', { hasText: /t\s\d+\.\d{4}\ss/ }).waitFor();
  const words = plain(await page.locator('#scene-readout').innerText());
  const [t, n, theta, x, y] = /t (\S+) s +bounce (\d+) +θ (\S+) rad +x (\S+) m +y (\S+) m/
    .exec(words)
    .slice(1)
    .map(Number);
  return { t, n, theta, x, y };
}

/** The box of a chart on the screen, once it is in view. */
export async function boxOf(page, id) {
  await showChart(page, id);
  return page.locator(`#${id} .canvas-box`).boundingBox();
}

/** The number of the last impact on the page. */
export async function impacts(page) {
  const text = await page.locator('#plane-angle .readout').innerText();
  return Number(/^n\s(\d+)/.exec(text)?.[1] ?? 0);
}

export const reachImpact = (page, n) =>
  page.waitForFunction(
    (wanted) =>
      Number(/^n\s(\d+)/.exec(document.querySelector('#plane-angle .readout')?.textContent ?? '')?.[1] ?? 0) >= wanted,
    n,
  );

export const reachPhase = (page, phase) => page.locator(`#run-state[data-phase=${phase}]`).waitFor();

/** Waits until all that is known is drawn. */
export const drawn = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/**
 * Steps a run to its impact `n`, or pauses it beyond. A run that goes on by the clock is anywhere by the time a busy machine
 * pauses it.
 */
export async function stepTo(page, n) {
  if ((await page.locator('#run-state').getAttribute('data-phase')) !== 'paused') await page.click('#run');
  await reachPhase(page, 'paused');
  await drawn(page);
  for (let last = await impacts(page); last < n; last += 1) {
    await page.click('#step');
    await reachImpact(page, last + 1);
  }
  // The address follows a moment later.
  const last = await impacts(page);
  await page.waitForFunction((n) => {
    const [, told, t] = /^n\s(\d+) · ([\d.]+)/.exec(document.querySelector('#timeline-told').textContent) ?? [];
    const run = [...new URLSearchParams(location.search)].findLast(([key]) => /^clock\.\d+\.run$/.test(key))?.[1];
    return Number(told) === n && Number(run).toFixed(2) === t;
  }, last);
}

/** How many pixels of a canvas have (nearly) the colour of the style sheet's property. */
export async function ink(page, selector, property) {
  await showChart(page, selector.slice(1));
  return inkOf(page.locator(`${selector} canvas`).first(), property);
}

/** The same of one canvas, within margins (left, top, and both sides together across and down), above an opacity, and less `off` in all. */
export function inkOf(canvas, property, { margins = [0, 0, 0, 0], opacity = 200, off = 40 } = {}) {
  return canvas.evaluate(
    (element, [name, least, most, x, y, narrower, shorter]) => {
      const probe = document.createElement('canvas').getContext('2d');
      probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
      probe.fillRect(0, 0, 1, 1);
      const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
      const { width, height } = element;
      // Read from a copy: reading the page's own canvas would change how the browser keeps it.
      const copy = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', {
        willReadFrequently: true,
      });
      copy.drawImage(element, 0, 0);
      const { data } = copy.getImageData(x, y, width - narrower, height - shorter);
      let count = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] > least && Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < most)
          count += 1;
      return count;
    },
    [property, opacity, off, ...margins],
  );
}

/** Brings a chart of the reasons into view. */
export async function showChart(page, id) {
  const chart = page.locator(`#panel-why #${id}`);
  if ((await chart.count()) === 0) return;
  if (await page.locator('#panel-why').isHidden()) await openTab(page, 'why');
  await chart.scrollIntoViewIfNeeded();
  await drawn(page);
}

/** The numbers behind a chart, as its table shows them. */
export async function numbers(page, id, least = 1) {
  await showChart(page, id);
  const summary = page.locator(`#${id} summary`);
  if (!(await page.locator(`#${id} details`).evaluate((details) => details.open))) await summary.click();
  await page.waitForFunction(
    ([chart, rows]) => document.querySelectorAll(`#${chart} tbody tr`).length >= rows,
    [id, least],
  );
  return cellsOf(page, `#${id}`);
}

/** The texts of a table, row by row. */
export const cellsOf = (page, table) =>
  page
    .locator(`${table} tbody tr`)
    .evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));

/** Moves a slider as a hand would, from its first value to its last. */
export async function slide(page, selector, value) {
  await page.locator(selector).evaluate((slider, to) => {
    slider.value = String(to);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    slider.dispatchEvent(new Event('change', { bubbles: true }));
  }, value);
}

export const speedUp = (page) => slide(page, '#speed', 75);

/** Charts speed against accuracy, where its part of the page is loaded. */
export async function measure(page, impacts = 10) {
  await page.fill('#precision-impacts', String(impacts));
  await page.click('#precision-start');
  await page.locator('#precision-told', { hasText: 'Measured over' }).waitFor();
}

/** Presses an entry of the menu of tools. */
export async function tool(page, id) {
  if (await page.locator('#tools').isHidden()) await page.click('#tools-open');
  await page.click(`#${id}`);
}

/** The slider of the tilt gain among the values. */
export const GAIN = '#field-table-tilt_gain-slider';

/** From now on edits change the run under way. */
export const changeUnderWay = (page) => page.locator('#under-way').evaluate((box) => box.click());

/** Opens a tab beside the scene by its id, such as `map`. */
export async function openTab(page, id) {
  // The tab of the reasons has no button until it is open.
  await page.locator(id === 'why' ? '#why' : `#tab-${id}`).click();
  await page.locator(`#panel-${id}`).waitFor();
}

/** Opens the tab that holds a panel, and brings the panel into view. */
export async function openPanel(page, id) {
  const body = page.locator(`#${id}-body`);
  await body.waitFor({ state: 'attached' });
  const tab = await body.evaluate((element) => element.closest('[role=tabpanel]').id.replace('panel-', ''));
  await openTab(page, tab);
  await body.scrollIntoViewIfNeeded();
}

/** Fits the scene to an example of measured impacts, where its part of the page is loaded. */
export async function fitExample(page) {
  await page.click('#fit-example');
  await page.locator('#fit-data', { hasText: 'Computed' }).waitFor();
  await page.click('#fit-start');
  await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
}

/** Brings each panel of the studies to its full content, answers on request included. */
const PANELS = {
  map: (page) => page.locator('#map-links a').first().waitFor({ state: 'attached' }),
  catch: async (page) => {
    await page.click('#catch-start');
    await page.locator('#catch-sheet svg').waitFor();
  },
  branch: (page) => page.locator('#branch-body svg.figure').waitFor(),
};

/**
 * Opens all tabs of the studies one after another, each with what is asked for in it.
 * @param {(panel: string) => Promise<void>} [look] at each while it is open
 */
export async function loadAll(page, look) {
  for (const [id, whole] of Object.entries(PANELS)) {
    await openPanel(page, id);
    await whole(page);
    await look?.(id);
  }
}

/** Releases a run, or goes on with one, until there are so many impacts. */
export async function releaseTo(page, n) {
  await page.click('#run');
  await reachImpact(page, n);
}

/** The same, and pauses it. */
export async function runTo(page, n) {
  await releaseTo(page, n);
  await page.click('#run');
  await reachPhase(page, 'paused');
}

/** Releases a run, and pauses it at once. */
export async function startPaused(page) {
  await page.click('#run');
  await reachPhase(page, 'running');
  await page.click('#run');
  await reachPhase(page, 'paused');
}

/** A run with at least so many impacts, paused. */
export async function pausedRun(stage, query, n, options = {}) {
  const opened = await stage.page(query, options);
  const { page } = opened;
  await page.locator('#scrub').waitFor();
  await speedUp(page);
  await runTo(page, n);
  // The bounce before the pause may not be drawn yet.
  await drawn(page);
  return opened;
}

/** A run with a change and a kick in it, paused. */
export async function changedRun(stage) {
  const opened = await stage.page('?preset=case-1&scene.release.theta=0.2');
  const { page } = opened;
  await page.click('#run');
  await reachPhase(page, 'running');
  await stepTo(page, 3);
  await changeUnderWay(page);
  await slide(page, GAIN, 1.2);
  await page.waitForFunction(() => /tilt_gain=1\.2/.test(location.search));
  await stepTo(page, (await impacts(page)) + 2);
  await page.click('#kick');
  await page.waitForFunction(() => /kick\.theta_dot/.test(location.search));
  await stepTo(page, Math.max(12, (await impacts(page)) + 2));
  return opened;
}
