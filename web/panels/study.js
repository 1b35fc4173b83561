// A study that is asked for by a form: its button beside what is told, its settings, and the answer with a picture below.

import { get } from '../api/client.js';
import { serverFigure } from '../charts/readable/server-figure.js';
import { h } from '../dom/elements.js';
import { actions } from '../export/save-actions.js';

/** Told where the scene of the page is not whole. */
export const NO_SCENE = 'A parameter of the scene is not a number; it is marked among them.';

/**
 * The parts of a study below its root.
 * @param {HTMLElement} root
 * @param {string} name of the study, the beginning of its ids
 */
export function study(root, name) {
  root.classList.add('study');
  return {
    told: h('div', { class: 'study-told', id: `${name}-told`, role: 'status' }),
    sheet: h('div', { class: 'study-sheet', id: `${name}-sheet`, hidden: true }),
  };
}

/**
 * A form whose button asks.
 * @param {string} name of the study
 * @param {string} words of its button
 * @param {() => void} ask
 * @param {HTMLElement[]} beside the button
 * @param {HTMLElement[]} settings
 */
export const studyForm = (name, words, ask, beside, settings) =>
  h(
    'form',
    {
      novalidate: true,
      submit: (/** @type {Event} */ event) => {
        event.preventDefault();
        ask();
      },
    },
    h(
      'div',
      { class: 'study-act' },
      h('button', { type: 'submit', id: `${name}-start`, class: 'primary' }, words),
      ...beside,
    ),
    ...settings,
  );

/**
 * An answer with its picture.
 * @param {string} path
 * @param {AbortSignal} [signal]
 * @returns {Promise<[any, SVGSVGElement]>}
 */
export const pictured = (path, signal) => Promise.all([get(path, signal), serverFigure(`${path}&format=svg`, signal)]);

/** The answer as files to keep. @param {string} id @param {string} title @param {string} path */
export const savings = (id, title, path) =>
  h(
    'p',
    { class: 'actions', id: `${id}-links` },
    ...actions({ id, title, path, formats: ['svg', 'png', 'csv', 'arrow', 'json'] }),
  );
