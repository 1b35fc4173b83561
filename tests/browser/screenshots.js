// Pictures of the workbench for docs/: `node tests/browser/screenshots.js`, or some of them: `… screenshots.js run map`.

import { readFile, writeFile } from 'node:fs/promises';
import { Stage, openPanel, reachImpact, reachPhase, slide, speedUp, verdict } from './stage.js';

const stage = await Stage.open(null);
const docs = new URL('../../docs/', import.meta.url);
const DESK = { width: 1280, height: 800 };
const ONLY = process.argv.slice(2);
const PHONE = { width: 390, height: 844 };

/** A run of 140 impacts with a change in it, held. @param {import('playwright-core').Page} page */
async function held(page) {
  await speedUp(page);
  await page.click('#run');
  await reachImpact(page, 60);
  await slide(page, '#gain', 1.15);
  await reachImpact(page, 140);
  await page.click('#run');
  await reachPhase(page, 'paused');
}

/**
 * Each picture: its colour schemes, the page it begins with, and what the page is brought to.
 * @type {Record<string, {schemes: ('light' | 'dark')[], path?: string, query?: string, size?: {width: number, height: number}, bring: (page: import('playwright-core').Page) => Promise<void>}>}
 */
const PICTURES = {
  run: { schemes: ['light', 'dark'], bring: held },
  time: {
    schemes: ['light'],
    bring: async (page) => {
      await held(page);
      await page.click('#pin');
      await slide(page, '#gain', 1.2);
      await page.click('#restart');
      await reachPhase(page, 'running');
      await reachImpact(page, 60);
      await page.click('#run');
      await reachPhase(page, 'paused');
      await page.click('#pin');
      for (let k = 0; k < 20; k += 1) await page.click('#step-back');
      await page.click('#fork');
      await page.locator('#fork-told', { hasText: /\w/ }).waitFor();
      await page.waitForTimeout(300);
    },
  },
  map: {
    schemes: ['light', 'dark'],
    bring: async (page) => {
      await openPanel(page, 'map');
      await page.locator('.map-told', { hasText: 'cells:' }).waitFor();
      await page.waitForTimeout(8000);
      await page.locator('#map').scrollIntoViewIfNeeded();
    },
  },
  paper: {
    schemes: ['dark'],
    path: 'paper',
    query: '#figure-5',
    bring: (page) => page.locator('#figure-5 svg.figure').waitFor(),
  },
  fit: {
    schemes: ['light', 'dark'],
    query:
      '?preset=case-1&tab=fit&fit.unknown=table.tilt_gain,body.radius_of_gyration&fit.sd.t=0.001&fit.sd.theta=0.002',
    size: { width: 1280, height: 1500 },
    bring: async (page) => {
      await page.locator('#fit-start').waitFor();
      const rig = await readFile(new URL('clients/measured.csv', docs));
      await page.setInputFiles('#fit-file', { name: 'measured.csv', mimeType: 'text/csv', buffer: rig });
      await page.locator('#fit-data', { hasText: 'measured.csv' }).waitFor();
      await page.click('#fit-start');
      await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
      await page.click('#fit-convergence summary');
      await page.locator('#fit').evaluate((panel) => {
        panel.scrollIntoView();
        scrollBy(0, -60); // the row of tabs
      });
      await page.waitForTimeout(300);
    },
  },
  present: {
    schemes: ['dark'],
    bring: async (page) => {
      await held(page);
      await page.click('#present');
      await page.waitForTimeout(800);
    },
  },
  phone: {
    schemes: ['light'],
    size: PHONE,
    bring: async (page) => {
      await page.click('#run');
      await reachImpact(page, 12);
    },
  },
};

for (const [name, { schemes, path, query = '?preset=case-1', size = DESK, bring }] of Object.entries(PICTURES)) {
  if (ONLY.length > 0 && !ONLY.includes(name)) continue;
  for (const colorScheme of schemes) {
    const { page } = await stage.page(query, {
      colorScheme,
      viewport: size,
      folded: true,
      ...(path && { path, sign: 'article' }),
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
