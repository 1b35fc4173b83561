// The entries of the Share menu that save files: a clip and pictures of the scene, and the numbers of the run.

import { byId, h } from '../../dom/elements.js';
import { notice } from '../../dom/notices.js';
import { impactsPath, playedQuery } from '../queries.js';
import { toggle } from '../run-actions.js';

/** @param {import('../page.js').Page} page */
export function bringShare(page) {
  const { view, run } = page;
  const opener = byId('share-open');
  /** An entry, which closes the menu. @param {string} id @param {string} words @param {() => void} act */
  const entry = (id, words, act) =>
    h(
      'button',
      {
        type: 'button',
        id,
        click: () => {
          opener.click();
          opener.focus();
          act();
        },
      },
      words,
    );
  const saved = (/** @type {'svg' | 'png'} */ format) => async () => {
    const { svgOf, pngOf, download } = await import('../../export/capture.js');
    download(format === 'svg' ? svgOf(view, 'Scene') : await pngOf(view), `equipoise-scene.${format}`);
  };
  const fetched = (/** @type {() => string | null} */ path, /** @type {string} */ name) => () => {
    const href = path();
    if (href) h('a', { href, download: name }).click();
    else notice('save', ['Mend the marked field first: there is no run to save yet.']);
  };
  const clip = async () => {
    if (run.phase !== 'running') toggle(page);
    const { saveClip } = await import('../../export/clip.js');
    await saveClip(view, byId('controls'), () => byId('verdict').innerText.replace(/\s+/g, ' '));
  };
  const query = (/** @type {string} */ resource, /** @type {string} */ format) => () => {
    const played = playedQuery(page);
    return played && `v1/${resource}?${played}&format=${format}`;
  };
  const records = 'MediaRecorder' in globalThis && 'captureStream' in HTMLCanvasElement.prototype;
  byId('share-menu').append(
    ...(records ? [entry('save-clip', 'Save a clip of the scene', () => void clip())] : []),
    entry('save-png', 'Scene as PNG', () => void saved('png')()),
    entry('save-svg', 'Scene as SVG', () => void saved('svg')()),
    entry('save-card', 'Picture for a post, 1200 × 630', fetched(query('previews', 'png'), 'equipoise-preview.png')),
    entry(
      'save-csv',
      'Bounces as CSV',
      fetched(() => csvPath(page), 'equipoise-impacts.csv'),
    ),
  );
}

/** The call that gives the impacts of the plots as CSV. @param {import('../page.js').Page} page */
export function csvPath(page) {
  const path = impactsPath(page);
  return path && `${path}&format=csv`;
}
