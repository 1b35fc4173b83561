// A panel, loaded when it is drawn for the first time, and its card.

import { wordsOf } from '../api/client.js';
import { h } from '../dom/elements.js';
import { STUDY_SHEETS, styles } from '../dom/styles.js';
import { enlarger } from '../export/enlarge.js';
import { html, render, useEffect, useState } from '../vendor/preact/preact.js';

/** A panel of the workbench: the tab in which it stands. @typedef {Entry & {tab: string}} Study */

/**
 * A panel, once its code and its styles are there. What fails to load can be asked for again.
 * @param {{entry: Entry, [prop: string]: unknown}} props with those of the component
 */
export function Panel({ entry: { sheets = STUDY_SHEETS, load }, ...props }) {
  const [loaded, bring] = useState(/** @type {{Component: (props: any) => unknown} | null} */ (null));
  const [failed, fail] = useState('');
  const ask = async () => {
    try {
      const [Component] = await Promise.all([load(), ...sheets.map(styles)]);
      bring({ Component });
    } catch (error) {
      fail(wordsOf(error));
    }
  };
  useEffect(() => void ask(), []);
  if (loaded) return html`<${loaded.Component} ...${props} />`;
  return failed && html`<p class="muted">${failed} <button type="button" onClick=${ask}>Try again</button></p>`;
}

/** The card of a panel, which is loaded when it is drawn for the first time. @param {Entry} entry */
export function card(entry) {
  const { id, title, about, fills = false, kind = '' } = entry;
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
      render(html`<${Panel} entry=${entry} page=${page} ...${more} />`, body),
  };
}
