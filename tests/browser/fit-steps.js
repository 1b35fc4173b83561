// Steps of the tests of the tab Fit.

import { readFileSync } from 'node:fs';
import { answersOf, openPanel, verdict } from './stage.js';

/** Impacts of a simulated rig: κ = 1.12, ρ = 0.097 m, one impact missed, one angle wrong. */
export const RIG = readFileSync(new URL('../../docs/clients/measured.csv', import.meta.url), 'utf8');
export const plain = (text) => text.replace(/[\u00a0\u202f]/g, ' ').replaceAll('\u2212', '-');
export const text = async (page, selector) => plain(await page.locator(selector).innerText());

export async function openFit(stage, query = '?preset=case-1', options) {
  const opened = await stage.page(query, options);
  await verdict(opened.page);
  await openPanel(opened.page, 'fit');
  await opened.page.locator('#fit-start').waitFor();
  return opened;
}

export async function drop(page, content, name = 'rig.csv') {
  await page.locator('#fit').evaluate(
    (element, [file, words]) => {
      const carried = new DataTransfer();
      carried.items.add(new File([words], file, { type: 'text/csv' }));
      element.dispatchEvent(new DragEvent('drop', { bubbles: true, cancelable: true, dataTransfer: carried }));
    },
    [name, content],
  );
  await page.locator('#fit-data', { hasText: name }).waitFor();
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
