// A component as a panel of a card: in a frame of somebody's dashboard, and among the chapters of the paper.

import { html, render } from '../vendor/preact/preact.js';
import { readSettings, wholeParts, withParts } from './settings.js';

/** @typedef {import('./settings.js').Page} Page */
/** @typedef {import('./settings.js').Broken} Broken */

/**
 * @param {string} id
 * @param {(props: {page: Page}) => unknown} Panel
 * @param {Record<string, import('./settings.js').Setting> | ((page: Page) => Broken)} settings or the broken parts of an address
 * @returns {import('./card.js').Module['mount']}
 */
export const alone = (id, Panel, settings) => (root, around, first) => {
  const own = (/** @type {URLSearchParams} */ link) =>
    new URLSearchParams([...link].filter(([part]) => part.startsWith(`${id}.`)));
  let link = own(first);
  let unattended = false;
  /** @returns {Page} */
  const page = () => ({
    fields: around.fields,
    query: around.query(),
    scene: around.scene(),
    link,
    unattended,
    part: (changes) => {
      link = withParts(link, changes);
      around.changed();
      draw();
    },
    // Those that restore it tell of them.
    drop: () => {},
    take: around.play,
  });
  const draw = () => render(html`<${Panel} page=${page()} />`, root);
  draw();
  return {
    sceneChanged: draw,
    retell: draw,
    ask: () => {
      unattended = true;
      draw();
    },
    query: () => link,
    restore: (asked) => {
      link = own(asked);
      const broken = typeof settings === 'function' ? settings(page()) : readSettings(id, settings, link).broken;
      link = wholeParts(link, broken);
      draw();
      return broken.map(([, words]) => words);
    },
  };
};
