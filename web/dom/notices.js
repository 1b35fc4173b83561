// The notices of the page beside its panels: a lost connection, a broken link. A field's own error stands beside the field.

import { byId, h } from './elements.js';

/** @type {Map<string, HTMLElement>} */
const shown = new Map();

/** One notice of each kind at a time. @param {string} kind @param {(string | Node)[]} content @param {{dismissible?: boolean, caution?: boolean}} [manner] */
export function notice(kind, content, { dismissible = true, caution = false } = {}) {
  const element = shown.get(kind) ?? h('div', { class: 'notice' });
  element.classList.toggle('caution', caution);
  element.replaceChildren(
    h('div', { class: 'notice-words' }, ...content),
    dismissible ? h('button', { type: 'button', click: () => clearNotice(kind) }, 'Dismiss') : '',
  );
  if (!shown.has(kind)) byId('notices').append(element);
  shown.set(kind, element);
}

/** @param {string} kind */
export function clearNotice(kind) {
  shown.get(kind)?.remove();
  shown.delete(kind);
}

/**
 * The connection is lost; its countdown is for the eye only, or a screen reader would speak every second.
 * @param {number} seconds to the next try; 0 while trying
 * @param {() => void} retry
 */
export function connectionNotice(seconds, retry) {
  const existing = shown.get('connection')?.querySelector('.countdown');
  const words = seconds === 0 ? 'Trying now…' : `Next try in ${seconds} s.`;
  if (existing) {
    existing.textContent = words;
    return;
  }
  notice(
    'connection',
    [
      `Connection lost at ${new Date().toLocaleTimeString()}. The rest is shown once the server answers. `,
      h('span', { class: 'countdown', 'aria-hidden': 'true' }, words),
      ' ',
      h('button', { type: 'button', click: retry }, 'Try now'),
    ],
    { dismissible: false, caution: true },
  );
}

/** Names what was dropped of a link, if anything was. @param {string} kind @param {string[]} dropped */
export function brokenLinkNotice(kind, dropped) {
  if (dropped.length === 0) return clearNotice(kind);
  const list = h('ul', {}, ...dropped.map((what) => h('li', {}, what)));
  notice(kind, [h('strong', {}, 'This link was not whole. '), 'Dropped: ', list], { caution: true });
}
