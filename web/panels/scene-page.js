// The page around a panel that stands alone: the scene is in the address. Another scene opens in the whole page beside it.

import { merged, sceneQuery } from '../api/scene-query.js';
import { readLink } from '../app/link.js';

/** @typedef {import('./card.js').PanelPage} PanelPage */
/** @typedef {import('./card.js').Field} Field */
/** @typedef {import('./card.js').Case} Case */

/**
 * The scene that an address names, with its case and its query.
 * @param {string} search
 * @param {Field[]} fields
 * @param {Case[]} cases
 */
export function sceneOf(search, fields, cases) {
  const link = readLink(search, fields, cases);
  const named = cases.find(({ name }) => name === link.preset);
  const chosen = named ?? (Object.keys(link.changes).length === 0 ? cases[0] : null);
  const scene = merged(chosen?.scene ?? {}, link.changes);
  return { link, chosen, scene, query: sceneQuery(scene, chosen, fields) };
}

/**
 * @param {Field[]} fields
 * @param {() => Pick<ReturnType<typeof sceneOf>, 'scene' | 'query'>} shown
 * @param {() => void} changed
 * @param {string} [whole] the page in which another scene opens
 * @returns {PanelPage}
 */
export function scenePage(fields, shown, changed, whole = './') {
  const beside = (/** @type {URLSearchParams} */ query) => void open(`${whole}?${query}`, '_blank', 'noopener');
  return {
    fields,
    query: () => new URLSearchParams(shown().query),
    scene: () => shown().scene,
    play: (scene) => beside(sceneQuery(scene, null, fields)),
    changed,
    open: (_, part) => beside(new URLSearchParams([...shown().query, ...part])),
    launch: (values) => {
      const other = new URLSearchParams(shown().query);
      for (const [path, value] of Object.entries(values)) other.set(`scene.${path}`, String(value));
      beside(other);
    },
  };
}
