// The actions that save a panel: pictures, numbers, the call that gives them, the panel itself for another page.

import { escaped } from '../charts/svg.js';
import { copy } from '../dom/clipboard.js';
import { html } from '../vendor/preact/preact.js';

/** Text in quotes that a shell does not read. @param {string} text */
const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** @param {string} path from where the page is */
export const absolute = (path) => new URL(path, document.baseURI).href;

/** The command that asks the same. @param {string} path */
export const curl = (path) => `curl ${quoted(absolute(path))}`;

/** The panel alone in a frame, with the scene and the run of this page. @param {string} id @param {string} title @param {string} [search] of another scene */
export const frame = (id, title, search = location.search) =>
  `<iframe src="${escaped(absolute(`embed/${id}${search}`))}" title="${escaped(`equipoise: ${title}`)}" width="640" height="480"></iframe>`;

/** The actions, in a row. @param {Saves} saves */
export function SaveActions({ id, title, path, formats, view }) {
  const stem = `equipoise-${id}`;
  const label = (/** @type {string} */ format) => `Save as ${format.toUpperCase()}: ${title}`;
  const drawn = (/** @type {string} */ format) => {
    const save = async () => view && (await import('./capture.js')).savePicture(view, title, `${stem}.${format}`);
    return html`<button type="button" aria-label=${label(format)} onClick=${save}>${format.toUpperCase()}</button>`;
  };
  const asked = (/** @type {string} */ format) => {
    // A stream; `.arrow` is a file of Arrow.
    const name = `${stem}.${format === 'arrow' ? 'arrows' : format}`;
    const href = `${path}&format=${format}`;
    return html`<a href=${href} download=${name} aria-label=${label(format)}>${format.toUpperCase()}</a>`;
  };
  const copier = (/** @type {string} */ name, /** @type {() => string} */ text) => {
    const click = (/** @type {Event} */ event) => void copy(/** @type {HTMLElement} */ (event.currentTarget), text());
    return html`<button type="button" aria-label=${`${name}: ${title}`} onClick=${click}>${name}</button>`;
  };
  return html`${view && ['svg', 'png'].map(drawn)}
    ${path !== null && [...formats.map(asked), copier('Copy curl', () => curl(path))]}
    ${copier('Copy embed', () => frame(id, title))}`;
}
