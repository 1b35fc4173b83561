// Words and figures of the server as parts of a Preact tree.

import { wordsOf } from '../api/client.js';
import { serverFigure } from '../charts/readable/server-figure.js';
import { marked, prose } from '../dom/typeset.js';
import { Nodes } from '../panels/parts.js';
import { html, useEffect, useRef, useState } from '../vendor/preact/preact.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */

/**
 * Data that a chapter is made from.
 * @typedef {object} Context
 * @property {Field[]} fields
 * @property {Case[]} cases
 * @property {Case | null} chosen the only case to show; null for all
 */

/** Asks for a chapter's content: its sections as anchor and title, and its body. @typedef {(context: Context) => Promise<{contents: [string, string][], body: unknown}>} Load */

/** Time that a figure may take, ms. */
const PATIENCE_MS = 60_000;

/** With a capital, unless it begins with a symbol, and with a full stop. @param {string} words */
const sentence = (words) =>
  (/^(?:[a-z]{2}|a )/.test(words) ? words[0].toUpperCase() + words.slice(1) : words) +
  (/[.!?]$/.test(words) ? '' : '.');

/** The server's words as a sentence, its numbers no longer than one reads unless they stand in full. @param {{text: string, full?: boolean}} props */
export const Sentence = ({ text, full }) => html`<${Nodes} nodes=${(full ? marked : prose)(sentence(text))} />`;

/**
 * Acts once, when an element comes near or the page is printed.
 * @param {Element | null} element
 * @param {() => void} act
 * @returns {() => void} gives it up
 */
export function whenNear(element, act) {
  const stop = () => {
    watch.disconnect();
    removeEventListener('beforeprint', now);
  };
  const now = () => {
    stop();
    act();
  };
  const near = (/** @type {IntersectionObserverEntry[]} */ entries) =>
    entries.some(({ isIntersecting }) => isIntersecting) && now();
  const watch = new IntersectionObserver(near, { rootMargin: '600px 0px' });
  if (element) watch.observe(element);
  addEventListener('beforeprint', now);
  return stop;
}

/**
 * A picture by the server, asked for when it comes near.
 * @param {{path: string, label: string, over?: unknown}} props `over` lies above the picture
 */
export function Figure({ path, label, over }) {
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  const [told, tell] = useState('The picture is being drawn…');
  const draw = () =>
    void serverFigure(path, AbortSignal.timeout(PATIENCE_MS)).then(
      (figure) => {
        box.current?.replaceChildren(figure);
        tell('');
      },
      (error) => tell(wordsOf(error)),
    );
  useEffect(() => whenNear(box.current, draw), [path]);
  return html`<div class="picture" role="img" aria-label=${label}>
    <div class="picture-box" ref=${box} />
    ${over}
    ${told && html`<p class="muted">${told}</p>`}
  </div>`;
}

/**
 * Printed values beside computed ones.
 * @param {{label: string, rows: {name: Node, printed: string, computed: string, agrees: boolean | null, why: string | null, where?: string[]}[]}} props
 */
export const Compared = ({ label, rows }) => html`<div class="table-box" tabindex="0" role="region" aria-label=${label}>
  <table class="compared">
    <thead>
      <tr>
        <th scope="col">Quantity</th>
        <th scope="col">Printed</th>
        <th scope="col">Computed</th>
        <th scope="col"><span class="unseen">Equal</span></th>
      </tr>
    </thead>
    <tbody>
      ${rows.map(
        ({ name, printed, computed, agrees, why, where }) => html`<tr>
            <th scope="row">${name}</th>
            <td>${printed}${where?.[0] && html`<span class="where">${where[0]}</span>`}</td>
            <td>${computed}${where?.[1] && html`<span class="where">${where[1]}</span>`}</td>
            <td class=${agrees ? 'same' : 'differs'}>${agrees === null ? '' : agrees ? '=' : '≠'}</td>
          </tr>
          ${why && html`<tr class="why"><td colspan="4"><${Sentence} text=${why} /></td></tr>`}`,
      )}
    </tbody>
  </table>
</div>`;
