// The page's address: the run while there is one, else the typed scene, and what the panels show.

import { sceneQuery } from '../api/scene-query.js';
import { debounce } from '../dom/debounce.js';
import { keepAngles } from '../dom/units.js';
import { typedQuery } from './queries.js';

/** @typedef {import('./page.js').Page} Page */

/** @param {Page} page */
export function updateAddress(page) {
  const { run, chosen, fields, speed } = page;
  const query = run.released ? sceneQuery(run.released, chosen, fields) : typedQuery(page);
  if (!query) return;
  if (run.released) {
    // The server spells the scene out; the name of the case says it shorter and for people.
    for (const [key, value] of run.query) if (key !== 'preset' && !key.startsWith('scene.')) query.set(key, value);
  } else if (speed !== 1) query.set('speed', String(speed));
  for (const [key, value] of page.panelQuery) query.set(key, value);
  keepAngles(query);
  history.replaceState(null, '', `?${query}`);
  page.panels?.played();
}

export const updateAddressSoon = debounce(150, updateAddress);

/** A new entry of the history, with the panels' part of the address. @param {Page} page @param {Iterable<string[]>} query */
export function pushAddress({ panelQuery }, query) {
  const whole = new URLSearchParams([...query, ...panelQuery]);
  keepAngles(whole);
  history.pushState(null, '', `?${whole}`);
}
