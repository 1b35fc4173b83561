// The scene and the run of the page as queries, and what of the typed scene the run does not play yet.

import { MOST_IMPACTS } from '../api/client.js';
import { playedAt, same, valueAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';

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
