// The actions that save a panel: pictures, numbers, the call that gives them, the panel itself for another page.

import { escaped } from '../charts/svg.js';
import { copy } from '../dom/clipboard.js';
import { h } from '../dom/elements.js';

/** @typedef {import('./capture.js').Layered} Layered */
/**
 * @typedef {object} Saves
 * @property {string} id of the panel
 * @property {string} title
 * @property {string | null} path the call that gives its numbers, from where the page is; null where there are none yet
 * @property {string[]} formats that the server has for them
 * @property {Layered} [view] where the page draws it
 */

/** Text in quotes that a shell does not read. @param {string} text */
const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** @param {string} path from where the page is */
export const absolute = (path) => new URL(path, document.baseURI).href;

/** The command that asks the same. @param {string} path */
export const curl = (path) => `curl ${quoted(absolute(path))}`;

/** @param {string} name @param {() => string} text @param {string} title */
const copier = (name, text, title) =>
  h(
    'button',
    {
      type: 'button',
      'aria-label': `${name}: ${title}`,
      click: (/** @type {Event} */ event) => void copy(/** @type {HTMLElement} */ (event.currentTarget), text()),
    },
    name,
  );

/** The panel alone in a frame, with the scene and the run of this page. @param {string} id @param {string} title @param {string} [search] of another scene */
export const frame = (id, title, search = location.search) =>
  `<iframe src="${escaped(absolute(`embed/${id}${search}`))}" title="${escaped(`equipoise: ${title}`)}" width="640" height="480"></iframe>`;

/** @param {Saves} saves */
export function actions({ id, title, path, formats, view }) {
  const stem = `equipoise-${id}`;
  const drawn = view
    ? /** @type {const} */ (['svg', 'png']).map((format) =>
        h(
          'button',
          {
            type: 'button',
            'aria-label': `Save as ${format.toUpperCase()}: ${title}`,
            click: async () => (await import('./capture.js')).savePicture(view, title, `${stem}.${format}`),
          },
          format.toUpperCase(),
        ),
      )
    : [];
  const asked =
    path === null
      ? []
      : [
          ...formats.map((format) =>
            h(
              'a',
              {
                href: `${path}&format=${format}`,
                // A stream; `.arrow` is a file of Arrow.
                download: `${stem}.${format === 'arrow' ? 'arrows' : format}`,
                'aria-label': `Save as ${format.toUpperCase()}: ${title}`,
              },
              format.toUpperCase(),
            ),
          ),
          copier('Copy curl', () => curl(path), title),
        ];
  return [...drawn, ...asked, copier('Copy embed', () => frame(id, title), title)];
}
