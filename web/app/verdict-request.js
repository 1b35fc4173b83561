// Asks for the verdict on the typed scene and shows the answer.

import { Problem, get, server } from '../api/client.js';
import { LatestRequest } from '../api/latest-request.js';
import { debounce } from '../dom/debounce.js';
import { byId } from '../dom/elements.js';
import { typedQuery } from './queries.js';

/** @typedef {import('./page.js').Page} Page */

const latest = new LatestRequest();

/** Marks the verdict as out of date, and asks anew once typing has paused. @param {Page} page */
export function askVerdict(page) {
  page.verdict.busy(true);
  askSoon(page);
}

const askSoon = debounce(120, async (/** @type {Page} */ page) => {
  const { verdict, circle } = page;
  latest.cancel();
  const scene = typedQuery(page);
  if (!scene) return verdict.fail('A parameter is not a number; it is marked below.');
  const signal = latest.next();
  try {
    const answer = await get(`v1/stability?${scene}`, signal);
    page.unjudged = false;
    page.form?.blame([]);
    void verdict.show(answer, () => get(`v1/stability?${scene}&basin=true`, signal));
    circle.show(answer);
    page.judged = { answer, scene };
    page.panels?.judged(page.judged);
    byId('build').textContent = server.build;
  } catch (error) {
    if (signal.aborted) return;
    circle.show(null);
    page.unjudged = !(error instanceof Problem);
    if (error instanceof Problem && error.errors.length > 0) {
      const elsewhere = page.form?.blame(error.errors) ?? [];
      verdict.fail(elsewhere.join(' ') || 'The server does not take this scene; the parameter is marked below.');
    } else {
      const words = error instanceof Problem ? error.message : 'The server does not answer.';
      verdict.fail(words, () => askVerdict(page));
    }
  }
});
