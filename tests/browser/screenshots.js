// Pictures of the page for docs/: `node tests/browser/screenshots.js`, or some of them: `… screenshots.js run rig`.

import { readFile, writeFile } from 'node:fs/promises';
import { Stage, verdict, runTo } from './stage.js';

const stage = await Stage.open(null);
const docs = new URL('../../docs/', import.meta.url);
const DESK = { width: 1280, height: 800 };
const ONLY = process.argv.slice(2);
const PHONE = { width: 390, height: 844 };

/** Waits until map and facts are whole. @param {import('playwright-core').Page} page */
async function settled(page) {
  await page.locator('#map-told', { hasText: /^98.304 cells/ }).waitFor({ state: 'attached' });
  await page.locator('.facts', { hasText: /\w/ }).waitFor();
}

/** A run of some bounces, held. @param {import('playwright-core').Page} page @param {number} n */
async function held(page, n) {
  await runTo(page, n);
}

/**
 * Each picture: its colour schemes, the page it begins with, and what the page is brought to.
 * @type {Record<string, {schemes: ('light' | 'dark')[], path?: string, sign?: string, query?: string, size?: {width: number, height: number}, bring: (page: import('playwright-core').Page) => Promise<void>}>}
 */
const PICTURES = {
  run: {
    schemes: ['light', 'dark'],
    bring: async (page) => {
      await settled(page);
      await held(page, 14);
    },
  },
  time: {
    schemes: ['light'],
    query: '?preset=case-1&tab=why',
    bring: async (page) => {
      await page.click('#tools-open');
      await page.click('#time-open');
      await page.keyboard.press('Escape');
      await held(page, 30);
      for (let k = 0; k < 6; k += 1) await page.click('#step-back');
      await page.click('#fork');
      await page.locator('#fork-told', { hasText: /\w/ }).waitFor();
      await page.locator('#charts').scrollIntoViewIfNeeded();
      await page.waitForTimeout(300);
    },
  },
  fall: {
    schemes: ['light'],
    query: '?preset=case-1&scene.table.tilt_gain=1.32&scene.release.theta=0.384',
    bring: async (page) => {
      await settled(page);
      await page.click('#run');
      await page.locator('.ending.fell').waitFor();
      await page.waitForTimeout(2500);
    },
  },
  paper: {
    schemes: ['dark'],
    path: 'paper',
    sign: 'article',
    query: '#figure-5',
    bring: (page) => page.locator('#figure-5 svg.figure').waitFor(),
  },
  rig: {
    schemes: ['light', 'dark'],
    path: 'rig',
    sign: '#budget .limit',
    query:
      '?preset=rough-feedback&have.table.errors.angle_bias=0.008&have.table.assumed_restitution=0.0005&have.noise.restitution_sd=0.001',
    size: { width: 1280, height: 1180 },
    bring: (page) => page.waitForTimeout(500),
  },
  fit: {
    schemes: ['light', 'dark'],
    path: 'rig',
    sign: '#fit-start',
    query:
      '?preset=case-1&fit.unknown=table.tilt_gain,body.radius_of_gyration&fit.sd.t=0.001&fit.sd.theta=0.002#measurements',
    size: { width: 1280, height: 1500 },
    bring: async (page) => {
      await page.locator('#fit-start').waitFor();
      const rig = await readFile(new URL('clients/measured.csv', docs));
      await page.setInputFiles('#fit-file', { name: 'measured.csv', mimeType: 'text/csv', buffer: rig });
      await page.locator('#fit-data', { hasText: 'measured.csv' }).waitFor();
      await page.click('#fit-start');
      await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
      await page.click('#fit-convergence summary');
      await page.locator('#measurements').evaluate((step) => step.scrollIntoView());
      await page.waitForTimeout(300);
    },
  },
  present: {
    schemes: ['dark'],
    bring: async (page) => {
      await settled(page);
      await page.click('#present');
      await held(page, 14);
      await page.waitForTimeout(800);
    },
  },
  phone: {
    schemes: ['light'],
    size: PHONE,
    bring: async (page) => {
      await settled(page);
      await held(page, 12);
    },
  },
};

for (const [name, { schemes, path, sign, query = '?preset=case-1', size = DESK, bring }] of Object.entries(PICTURES)) {
  if (ONLY.length > 0 && !ONLY.includes(name)) continue;
  for (const colorScheme of schemes) {
    const { page } = await stage.page(query, {
      colorScheme,
      viewport: size,
      folded: true,
      ...(path && { path, sign }),
    });
    if (!path) await verdict(page);
    await bring(page);
    const browser = await page.context().newCDPSession(page);
    const { data } = await browser.send('Page.captureScreenshot', { format: 'webp', quality: 85 });
    await writeFile(new URL(`page-${name}-${colorScheme}.webp`, docs), Buffer.from(data, 'base64'));
    await page.close();
  }
}
await stage.close();
