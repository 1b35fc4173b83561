// The scene and the run of the page as queries, and the page's address: the run while there is one, else the typed scene, and what the panels
// show.

import { MOST_IMPACTS } from '../api/client.js';
import { playedAt, same, valueAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';
import { debounce } from '../dom/debounce.js';
import { byId } from '../dom/elements.js';
import { keepAngles } from '../dom/units.js';

/** @typedef {import('./page.js').Page} Page */

/** The typed scene; null while some of it is no value. @param {Page} page */
export const typedQuery = ({ complete, chosen, fields }) => complete && sceneQuery(complete, chosen, fields);

/** The scene of the plots: that of the run with its interventions, else the typed one. @param {Page} page */
export function playedQuery(page) {
  const { run, chosen, fields } = page;
  if (!run.released) return typedQuery(page);
  const query = sceneQuery(run.released, chosen, fields);
  for (const [key, value] of run.query) if (key.startsWith('interventions.')) query.set(key, value);
  return query;
}

/** The request that answers with the impacts of the plots. @param {Page} page */
export function impactsPath(page) {
  const query = playedQuery(page);
  return query && `v1/trajectories?${query}&bounces=${Math.min(MOST_IMPACTS, page.run.impacts.last?.n ?? 100)}`;
}

/** Fields whose typed value the run does not play. @param {Page} page */
export function unplayed({ run: { asked, released }, typed, releasedAs, fields }) {
  if (!typed || !asked) return [];
  // The server has filled in what was left open at the release.
  const open = (/** @type {string} */ path) =>
    [typed, releasedAs].every((scene) => valueAt(scene, path) === undefined) &&
    same(valueAt(asked, path), valueAt(released ?? {}, path));
  return fields.filter((field) => !same(playedAt(typed, field), playedAt(asked, field)) && !open(field.field));
}

/**
 * The query of the page: its run with epoch and clock, or its typed scene, and what the panels show; null while there is no such scene.
 * @param {Page} page
 * @param {boolean} live true to name the run
 */
function pageQuery(page, live) {
  const { run, chosen, fields, speed } = page;
  const named = live ? run.released : null;
  const query = named ? sceneQuery(named, chosen, fields) : typedQuery(page);
  if (!query) return null;
  if (named) {
    // The server spells the scene out; the name of the case says it shorter and for people.
    for (const [key, value] of run.query) if (key !== 'preset' && !key.startsWith('scene.')) query.set(key, value);
  } else if (speed !== 1) query.set('speed', String(speed));
  return withPanels(page, query);
}

/** @param {Page} page @param {URLSearchParams} query */
function withPanels({ panelQuery }, query) {
  for (const [key, value] of panelQuery) query.set(key, value);
  keepAngles(query);
  return query;
}

/** True for a run that nobody has acted on. @param {URLSearchParams} run */
const untouched = (run) => ![...run.keys()].some((key) => /^(interventions|clock)\./.test(key));

/** @param {Page} page */
export function updateAddress(page) {
  const query = pageQuery(page, !(page.byItself && untouched(page.run.query)));
  if (!query) return;
  history.replaceState(null, '', `?${query}`);
  // The same scene is a rig.
  const scene = typedQuery(page);
  byId('rig', HTMLAnchorElement).href = scene ? `rig?${scene}` : 'rig';
}

/** @param {URLSearchParams | null} query */
const whole = (query) => new URL(query ? `?${query}` : '', location.href).href;

/** The address that replays the run from its release, with all that was done to it. @param {Page} page */
export function replayAddress(page) {
  const query = playedQuery(page);
  if (query && page.speed !== 1) query.set('speed', String(page.speed));
  return whole(query && withPanels(page, query));
}

/** The address that joins the run where it is by now. @param {Page} page */
export const liveAddress = (page) => whole(pageQuery(page, true));

export const updateAddressSoon = debounce(150, updateAddress);

/** A new entry of the history, with the panels' part of the address. @param {Page} page @param {URLSearchParams} query */
export function pushAddress(page, query) {
  history.pushState(null, '', `?${withPanels(page, query)}`);
}
