// axe on a page: all its rules in the light scheme, and those on colours in the dark one too. The schemes differ in colours only.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const source = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const COLOUR_RULES = ['color-contrast', 'link-in-text-block'];

/**
 * The findings of axe in both schemes; the page is light afterwards.
 * @param {import('playwright-core').Page} page
 * @param {string | {include: string[]}} [within] the part to look at
 * @param {object} [options] of axe
 */
export async function violations(page, within = 'html', options = {}) {
  if (!(await page.evaluate(() => 'axe' in globalThis))) await page.evaluate(source);
  const found = [];
  for (const [colorScheme, rules] of [
    ['light', {}],
    ['dark', { runOnly: COLOUR_RULES }],
  ]) {
    await page.emulateMedia({ colorScheme });
    const result = await page.evaluate(
      ([part, settings]) => globalThis.axe.run(part, settings),
      [within, { resultTypes: ['violations'], ...options, ...rules }],
    );
    for (const { id, nodes } of result.violations)
      found.push(
        `${colorScheme}: ${id}: ${nodes.map(({ target, failureSummary }) => `${target} ${failureSummary}`).join('; ')}`,
      );
  }
  await page.emulateMedia({ colorScheme: 'light' });
  return found;
}
