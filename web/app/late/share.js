// The things that the page shares and saves: its links, a clip and pictures of the scene, the numbers of the run, and the charts.

import { copy } from '../../dom/clipboard.js';
import { byId, h } from '../../dom/elements.js';
import { notice } from '../../dom/notices.js';

/** Saves the answer to a call. @param {string | null} path @param {string} name of the file */
function save(path, name) {
  if (path) h('a', { href: path, download: name }).click();
  else notice('save', ['Mend the marked field first: there is no run to save yet.']);
}

/** Saves the impacts of the plots. @param {Page} page */
export function saveCsv(page) {
  const path = page.impactsPath;
  save(path && `${path}&format=csv`, 'equipoise-impacts.csv');
}

/** Brings the entries of the Share menu. @param {Page} page */
export function bringShare(page) {
  const { view, run } = page;
  const menu = byId('share-menu');
  const copies = (/** @type {string} */ id, /** @type {'replayAddress' | 'liveAddress'} */ which) => {
    const button = byId(id);
    button.onclick = () => {
      page.updateAddress();
      void copy(button, page[which]);
    };
  };
  /** An entry that closes the menu. @param {string} id @param {() => void} act */
  const saves = (id, act) => {
    byId(id).onclick = () => {
      menu.hidePopover();
      byId('share-open').focus();
      act();
    };
  };
  const picture = async (/** @type {'svg' | 'png'} */ format) =>
    (await import('../../export/capture.js')).savePicture(view, 'Scene', `equipoise-scene.${format}`);
  const clip = async () => {
    if (run.phase !== 'running') page.toggle();
    const { saveClip } = await import('../../export/clip.js');
    const line = () => {
      const seen = /** @type {HTMLElement} */ (byId('verdict').cloneNode(true));
      for (const hidden of seen.querySelectorAll('.unseen, [hidden]')) hidden.remove();
      return [...seen.querySelectorAll('.headline, .facts > span')].map((one) => one.textContent?.trim()).join(' · ');
    };
    await saveClip(view, byId('controls'), line);
  };
  const card = () => {
    const played = page.playedQuery;
    save(played && `v1/previews?${played}&format=png`, 'equipoise-preview.png');
  };
  copies('share', 'replayAddress');
  copies('share-live', 'liveAddress');
  byId('save-clip').hidden = !('MediaRecorder' in globalThis && 'captureStream' in HTMLCanvasElement.prototype);
  saves('save-clip', () => void clip());
  saves('save-png', () => void picture('png'));
  saves('save-svg', () => void picture('svg'));
  saves('save-card', card);
  saves('save-csv', () => saveCsv(page));
}

/**
 * The things to save of a chart of the page: its picture, and the request for its numbers.
 * @param {Page} page
 * @param {string} id
 * @param {string} title
 * @param {CanvasView} [view] where the page draws it; else the server does
 * @returns {Saves}
 */
export function savesOf(page, id, title, view) {
  // The frame that embeds the chart is at the page's address.
  page.updateAddress();
  const query = id === 'circle' ? (page.typedQuery ?? page.playedQuery) : null;
  const path = id === 'circle' ? query && `v1/stability?${query}` : page.impactsPath;
  return { id, title, view, formats: view ? ['csv', 'arrow', 'json'] : ['svg', 'png', 'csv', 'arrow', 'json'], path };
}
