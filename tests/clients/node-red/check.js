// Runs docs/dashboards/node-red/flows.json in Node-RED, and looks at its dashboard in Chromium: margins, verdict, and impacts as they happen.
//
//   node check.js http://127.0.0.1:8080 ../../../docs/dashboards/node-red/flows.json

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const [, , server, file] = process.argv;
/** How long a condition may take before the test gives up; it measures no speed by it. */
const PATIENCE_MS = 120_000;
const folder = mkdtempSync(join(tmpdir(), 'equipoise-node-red-'));
const probe = createServer().listen(0, '127.0.0.1');
await new Promise((resolve) => probe.once('listening', resolve));
const { port } = probe.address();
await new Promise((resolve) => probe.close(resolve));

// As the file is, with the address of the tested server.
const shipped = readFileSync(file, 'utf8');
const shippedAddresses = shipped.match(/127\.0\.0\.1:8080\/v1/g);
assert.equal(shippedAddresses?.length, 2, 'the flow asks at two addresses');
writeFileSync(join(folder, 'flows.json'), shipped.replaceAll('127.0.0.1:8080/v1', `${new URL(server).host}/v1`));
writeFileSync(
  join(folder, 'settings.js'),
  `module.exports = {
  flowFile: 'flows.json', uiHost: '127.0.0.1', uiPort: ${port}, credentialSecret: false, telemetry: { enabled: false },
  nodesDir: [], logging: { console: { level: 'warn' } },
};
`,
);
const log = [];
const nodeRed = spawn(
  process.execPath,
  ['node_modules/node-red/red.js', '--userDir', folder, '--settings', join(folder, 'settings.js')],
  { cwd: import.meta.dirname, env: { ...process.env, NODE_PATH: join(import.meta.dirname, 'node_modules') } },
);
for (const stream of [nodeRed.stdout, nodeRed.stderr]) stream.on('data', (data) => log.push(String(data)));
let browser = null;
let passed = false;
try {
  const page_url = `http://127.0.0.1:${port}/dashboard/equipoise`;
  for (const begin = Date.now(); ; ) {
    assert.equal(nodeRed.exitCode, null, 'Node-RED has ended');
    assert.ok(Date.now() - begin < PATIENCE_MS, 'Node-RED does not start');
    if ((await fetch(page_url).catch(() => null))?.ok) break;
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu'],
  });
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(PATIENCE_MS);
  await page.goto(page_url);

  const stability = await (await fetch(`${server}/v1/stability?preset=case-1`)).json();
  await page.locator('.text-verdict', { hasText: stability.verdict.text }).waitFor();
  const { below, above } = stability.margins.find(({ field }) => field === 'table.tilt_gain');
  for (const { margin } of [below, above]) {
    const shown = String(Math.round(margin * 1000) / 1000);
    await page.waitForFunction(
      (value) => [...document.querySelectorAll('.nrdb-ui-gauge-value')].some((gauge) => gauge.textContent === value),
      shown,
    );
  }

  // Impacts as they happen, with the numbers of the run.
  const run = (await (await fetch(`${server}/v1/trajectories?preset=case-1&bounces=2000`)).json()).impacts;
  let before = 0;
  for (let seen = 0; seen < 3; seen += 1) {
    const words = await page
      .waitForFunction((last) => {
        const text = document.querySelector('.text-live')?.textContent ?? '';
        const n = Number(/impact (\d+) at/.exec(text)?.[1] ?? 0);
        return n > last ? text : null;
      }, before)
      .then((handle) => handle.jsonValue());
    const [, n, t, theta] = /impact (\d+) at ([\d.]+) s: (-?[\d.e-]+) rad/.exec(words).map(Number);
    assert.ok(Math.abs(run.theta[n - 1] - theta) < 6e-5, `${words}: ${run.theta[n - 1]}`);
    assert.ok(Math.abs(run.t[n - 1] - t) < 6e-4, `${words}: ${run.t[n - 1]}`);
    before = n;
  }
  // The chart has drawn them: other pixels than its background, and more than axes and words need.
  await page.waitForFunction(() => {
    const canvas = document.querySelector('.nrdb-ui-chart canvas, .nrdb-chart canvas, canvas');
    if (!canvas) return false;
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let blue = 0;
    for (let at = 0; at < data.length; at += 4)
      if (data[at + 3] > 200 && data[at + 2] - data[at] > 120 && data[at + 1] > 80 && data[at + 1] < 160) blue += 1;
    return blue > 100;
  });
  if (process.env.PICTURE) await page.screenshot({ path: process.env.PICTURE });
  passed = true;
  const version = (name) => JSON.parse(readFileSync(`node_modules/${name}/package.json`, 'utf8')).version;
  console.log(`ok    Node-RED ${version('node-red')} with its dashboard ${version('@flowfuse/node-red-dashboard')}`);
} finally {
  if (!passed) console.error(log.join(''));
  await browser?.close();
  nodeRed.kill();
  await new Promise((resolve) => (nodeRed.exitCode === null && nodeRed.signalCode === null ? nodeRed.once('exit', resolve) : resolve()));
  rmSync(folder, { recursive: true, force: true });
}
