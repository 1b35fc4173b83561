// The panels of all pages, each loaded when it is drawn for the first time, and its card. Each can stand alone under `embed/`.

import { get, wordsOf } from '../api/client.js';
import { h } from '../dom/elements.js';
import { STUDY_SHEETS, styles } from '../dom/styles.js';
import { enlarger } from '../export/enlarge.js';
import { html, render, useEffect, useState } from '../vendor/preact/preact.js';
import ALL from './entries.json' with { type: 'json' };

/** @type {Entry[]} */
export const ENTRIES = ALL;

/** The panels of a page, in their order. @param {Entry['page']} page */
export const entriesOf = (page) => ENTRIES.filter((entry) => entry.page === page);

/** A panel, once its code, its styles and what it asks for are there. What fails to load can be asked for again. @param {{id: string, [prop: string]: unknown}} props with those of the component */
export function Panel({ id, ...props }) {
  const {
    sheets = STUDY_SHEETS,
    module,
    component,
    asks,
  } = /** @type {Entry} */ (ENTRIES.find((one) => one.id === id));
  const [loaded, bring] = useState(/** @type {{Component: (props: any) => unknown, answer: unknown} | null} */ (null));
  const [failed, fail] = useState('');
  const ask = async () => {
    try {
      const [code, answer] = await Promise.all([import(`../${module}`), asks && get(asks), ...sheets.map(styles)]);
      bring({ Component: code[component], answer });
    } catch (error) {
      fail(wordsOf(error));
    }
  };
  useEffect(() => void ask(), []);
  if (loaded) return html`<${loaded.Component} ...${props} answer=${loaded.answer} />`;
  return failed && html`<p class="muted">${failed} <button type="button" onClick=${ask}>Try again</button></p>`;
}

/** The card of a panel. @param {Entry} entry */
export function card({ id, title, about, fills = false, kind = '' }) {
  const body = h('div', { id: `${id}-body`, class: 'lazy-body' });
  const element = h(
    'section',
    { class: `card lazy ${kind}`, id, 'aria-labelledby': `${id}-title` },
    h('div', { class: 'card-head' }, h('h2', { id: `${id}-title` }, title), h('p', { class: 'muted' }, about)),
    body,
  );
  if (!fills) element.firstElementChild?.append(enlarger(element, title));
  return {
    element,
    draw: (/** @type {PanelPage} */ page, more = {}) =>
      render(html`<${Panel} id=${id} page=${page} ...${more} />`, body),
  };
}
