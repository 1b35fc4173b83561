// A new drop: the typed scene falls from its release at once, and its live run begins when the hand rests.

import { updateAddressSoon } from '../app/address-bar.js';
import { start } from '../app/run-actions.js';
import { runsByItself, sceneChanged } from '../app/scenes.js';
import { debounce } from '../dom/debounce.js';

/** @typedef {import('../app/page.js').Page} Page */

/** The live run begins after so long without another drop, ms. Until then the page draws the first fall by itself. */
const REST_MS = 70;

/** The page whose drop waits for its run. @type {Page | null} */
let waiting = null;

const run = debounce(REST_MS, (/** @type {Page} */ page) => {
  waiting = null;
  // Another run may have been chosen meanwhile.
  if (page.run.phase === 'idle' && page.complete) start(page);
});

/** Drops the typed scene after a change. @param {Page} page */
function drop(page) {
  waiting = page;
  if (page.run.phase !== 'idle') page.run.reset();
  sceneChanged(page);
  if (!page.complete) return;
  page.view.fall(page.speed);
  run(page);
  updateAddressSoon(page);
}

/** Drops the scene after an edit. A page that does not run by itself stays at rest. @param {Page} page */
export function dropEdited(page) {
  if (page.run.phase !== 'idle' || waiting === page || runsByItself()) return drop(page);
  sceneChanged(page);
  updateAddressSoon(page);
}

/** Drops the scene with other values of some fields. @param {Page} page @param {Record<string, number>} values @param {boolean} first of a drag */
export function dropWith(page, values, first) {
  if (first) page.history?.record('the drop');
  for (const [path, value] of Object.entries(values)) page.put(path, value);
  drop(page);
}
