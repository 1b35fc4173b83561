// The name of the typed scene: its case, or how it differs from that.

import { playedAt, same } from '../../api/scene-fields.js';
import { byId, h } from '../../dom/elements.js';
import { prose } from '../../dom/typeset.js';
import { captionOf } from '../../play/stories.js';

/** @typedef {import('../page.js').Page} Page */

/** Text without subscripts, for an option or the window's title. @param {string} text */
export const plain = (text) => text.replaceAll('κ_', 'κ');

/** The case that a scene is, if it is one. @param {Page} page @param {import('../page.js').Scene} scene */
export const caseOf = ({ cases, fields }, scene) =>
  cases.find((one) => fields.every((field) => same(playedAt(one.scene, field), playedAt(scene, field)))) ?? null;

/** @param {Page} page @param {() => void} back returns to the case */
export function nameScene({ typed = {}, chosen: one, fields, chooser }, back) {
  const other = one ? fields.filter((field) => !same(playedAt(typed, field), playedAt(one.scene, field))) : [];
  const shows = byId('case-shows');
  chooser.value = one?.name ?? '';
  document.title = one ? `${plain(one.title)}${other.length > 0 ? ', changed' : ''} · equipoise` : 'equipoise';
  const named = other.slice(0, 3).map(({ title }) => title.toLowerCase());
  const rest = other.length > 3 ? ` and ${other.length - 3} more` : '';
  const words =
    other.length > 0
      ? `Changed from the case: ${named.join(', ')}${rest}. `
      : one
        ? (captionOf(one.name) ?? one.shows)
        : 'A scene of your own.';
  // A button that is being pressed has to stay.
  if (shows.dataset.words === words) return;
  shows.dataset.words = words;
  const button = h('button', { type: 'button', id: 'case-back', click: back }, 'Back to the case');
  shows.replaceChildren(...prose(words), one && other.length > 0 ? button : '');
}
