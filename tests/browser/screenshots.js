// Pictures of the page in five states and both colour schemes, for docs/: `node tests/browser/screenshots.js`.

import { Stage, loadAll, reachImpact, reachPhase, slide, speedUp, verdict } from './stage.js';

const stage = await Stage.open(null);
const docs = new URL('../../docs/', import.meta.url);
const viewport = { width: 1200, height: 900 };

/** What the page is brought to, and where it is looked at. @type {Record<string, (page: import('playwright-core').Page) => Promise<void>>} */
const STATES = {
  idle: async (page) => {
    await verdict(page);
  },
  running: async (page) => {
    await speedUp(page);
    await page.click('#run');
    await reachImpact(page, 60);
    await slide(page, '#gain', 1.15);
    await reachImpact(page, 140);
    await page.click('#run');
    await reachPhase(page, 'paused');
    await page.click('#step');
    await page.waitForTimeout(300);
  },
  error: async (page) => {
    await page.fill('#field-table-tilt_gain', '200');
    await page.locator('#field-table-tilt_gain-error:not(:empty)').waitFor();
    await page.fill('#field-release-theta', 'steep');
    await page.locator('#field-release-theta').blur();
    await page.locator('#field-release-theta-error:not(:empty)').waitFor();
    await page.evaluate(() => document.querySelector('.parameters').scrollIntoView());
  },
  disconnected: async (page) => {
    await page.click('#run');
    await reachImpact(page, 4);
    await stage.stopServer();
    await page.locator('.countdown', { hasText: /\d s/ }).waitFor();
  },
  map: async (page) => {
    await loadAll(page);
    await page.locator('.map-told', { hasText: 'cells:' }).waitFor();
    await page.evaluate(() => document.querySelector('#map').scrollIntoView());
  },
};

for (const colorScheme of ['light', 'dark']) {
  for (const [state, bring] of Object.entries(STATES)) {
    const { page } = await stage.page('?preset=case-1', { colorScheme, viewport });
    await bring(page);
    await page.screenshot({ path: new URL(`page-${state}-${colorScheme}.png`, docs).pathname });
    await page.close();
    if (state === 'disconnected') await stage.startServer();
  }
}
await stage.close();
