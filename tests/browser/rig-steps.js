// Steps of the tests of My rig.

import { readFileSync } from 'node:fs';
import { answersOf, plain } from './stage.js';

/** Bounces of a simulated rig: κ = 1.12, ρ = 0.097 m, one bounce missed, one angle wrong. */
export const RIG = readFileSync(new URL('../../docs/clients/measured.csv', import.meta.url), 'utf8');
export const text = async (page, selector) => plain(await page.locator(selector).innerText());

/** The page with its verdict. @param {string} [address] a query, and a step */
export async function openRig(stage, address = '?preset=case-1', options) {
  const opened = await stage.page(address, { path: 'rig', sign: '#verdict .headline[aria-busy=false]', ...options });
  if (/#measurements/.test(address)) await opened.page.locator('#fit-start').waitFor();
  return opened;
}

/** The headline, once it belongs to what is typed. */
export async function verdict(page) {
  await page.locator('#verdict .headline[aria-busy=false]').waitFor();
  return text(page, '#verdict .headline');
}

/** The answer of the step on limits, once it belongs to what is typed. */
export async function limits(page) {
  await page.locator('#budget .answer', { hasNotText: 'Trying' }).waitFor();
  return text(page, '#budget .answer');
}

export async function drop(page, content, name = 'rig.csv') {
  await page.locator('body').evaluate(
    (element, [file, words]) => {
      const carried = new DataTransfer();
      carried.items.add(new File([words], file));
      element.dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: carried }));
    },
    [name, content],
  );
  if (!/json$/.test(name)) await page.locator('#fit-data', { hasText: name }).waitFor();
}

/** The fits that the page asks for from now on, each with its request and its answer. */
export async function fitsOf(page) {
  const answers = await answersOf(page, 'v1/fits');
  const fits = [];
  page.on('request', (request) => {
    if (!request.url().includes('/v1/fits')) return;
    const index = fits.length;
    fits.push({ request: request.postDataJSON(), answer: async () => (await answers())[index] });
  });
  return fits;
}

export async function fit(page) {
  await page.click('#fit-start');
  await page.locator('#fit-told', { hasText: 'Fitted in' }).waitFor();
}

/** Fits the scene to an example of measured bounces. */
export async function fitExample(page) {
  await page.click('#fit-example');
  await page.locator('#fit-data', { hasText: 'Computed' }).waitFor();
  await fit(page);
}
