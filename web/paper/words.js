// Figures of the server, and printed values beside computed ones.

import { wordsOf } from '../api/client.js';
import { serverFigure } from '../charts/readable/server-figure.js';
import { Row, Table, sentence } from '../panels/parts.js';
import { html, useEffect, useRef, useState } from '../vendor/preact/preact.js';

/** Time that a figure may take, ms. */
const PATIENCE_MS = 60_000;

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

/** A value with its place in the paper, or in the answer. @param {string} value @param {string | undefined} where */
const placed = (value, where) => html`${value}${where && html`<span class="where">${where}</span>`}`;

/**
 * Printed values beside computed ones.
 * @param {{label: string, rows: {name: unknown, printed: string, computed: string, agrees: boolean | null, why: string | null, where?: string[]}[]}} props
 */
export const Compared = ({
  label,
  rows,
}) => html`<${Table} label=${label} kind="compared" head=${['Quantity', 'Printed', 'Computed', html`<span class="unseen">Equal</span>`]}>
  ${rows.map(
    ({ name, printed, computed, agrees, why, where = [] }) => html`<${Row} cells=${[
      name,
      placed(printed, where[0]),
      placed(computed, where[1]),
      agrees !== null && html`<span class=${agrees ? 'same' : 'differs'}>${agrees ? '=' : '≠'}</span>`,
    ]} />
    ${why && html`<tr class="why"><td colspan="4">${sentence(why)}</td></tr>`}`,
  )}
<//>`;
