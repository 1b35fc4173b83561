// Parts of studies, loaded with them: charts that are read by pointer and keys, words that are explained, answers to keep, and demands on the table.

import { get } from '../api/client.js';
import { serverFigure } from '../charts/readable/server-figure.js';
import { byId } from '../dom/elements.js';
import { number, quantity, unbroken } from '../dom/numbers.js';
import { SaveActions } from '../export/save-actions.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';
import { Row, Table } from './parts.js';

/** An answer with its picture. @param {string} path @param {AbortSignal} [signal] @returns {Promise<[any, SVGSVGElement]>} */
export const pictured = (path, signal) => Promise.all([get(path, signal), serverFigure(`${path}&format=svg`, signal)]);

/** An answer as files to keep. @param {{id: string, title: string, path: string, formats?: string[]}} props */
export const Savings = ({ formats = ['svg', 'png', 'csv', 'arrow', 'json'], ...answer }) =>
  html`<${SaveActions} formats=${formats} ...${answer} />`;

/**
 * A chart that is read by pointer and keys, drawn anew with its width: the values in words below it, and the same spoken.
 * @param {object} props
 * @param {string} props.name the beginning of its ids
 * @param {string} props.label for those who do not see it
 * @param {unknown} props.hint on its keys
 * @param {string} [props.kind] class of its box
 * @param {(box: HTMLElement) => Readable | null} props.draw
 * @param {readonly unknown[]} props.inputs of the drawing
 */
export function Chart({ name, label, hint, kind = 'measured-box', draw, inputs }) {
  const box = useRef(/** @type {any} */ (null));
  const shown = useRef(/** @type {Readable | null} */ (null));
  const at = useRef(/** @type {number | null} */ (null));
  // It is spoken when keys move, but not while a pointer goes over the chart.
  const [told, tell] = useState({ words: '', spoken: '' });
  const point = (/** @type {number | null} */ item, byKey = false) => {
    at.current = item;
    shown.current?.mark(item);
    const words = item === null ? '' : (shown.current?.words(item) ?? '');
    tell(({ spoken }) => ({ words, spoken: byKey ? words : spoken }));
  };
  useEffect(() => {
    point(null);
    // It hears once more when the box is taken away.
    const element = box.current;
    const watch = new ResizeObserver(() => {
      shown.current = draw(element);
      shown.current?.mark(at.current);
    });
    watch.observe(element);
    return () => watch.disconnect();
  }, inputs);
  const press = (/** @type {KeyboardEvent} */ event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const item = shown.current?.moved(event.key, at.current);
    if (item === undefined) return;
    event.preventDefault();
    point(item, true);
  };
  return html`<div class=${`${name}-chart`}>
    <div class=${`${name}-box ${kind}`} id=${`${name}-box`} tabindex="0" role="application" aria-roledescription="chart"
      aria-label=${label} aria-describedby=${`${name}-hint`} ref=${box}
      onPointerMove=${(/** @type {PointerEvent} */ event) => point(shown.current?.nearest(event) ?? null)}
      onPointerLeave=${() => point(null)} onKeyDown=${press} />
    <output class="readout" id=${`${name}-readout`} aria-live="off">${unbroken(told.words)}</output>
    <p class="unseen" role="status">${told.spoken}</p>
    <p class="muted small" id=${`${name}-hint`}>${hint}</p>
  </div>`;
}

/**
 * A picture of the server that is read by pointer and keys.
 * @param {{figure: SVGSVGElement, read: (figure: SVGSVGElement) => Readable, name: string, label: string, hint: string}} props
 */
export function Picture({ figure, read, ...about }) {
  const readable = useMemo(() => read(figure), [figure]);
  useLayoutEffect(() => byId(`${about.name}-box`).replaceChildren(figure), [figure]);
  return html`<${Chart} ...${about} kind="figure-box" draw=${() => readable} inputs=${[figure]} />`;
}

/** @typedef {Trajectory['demand']} Demand */

/** @type {[name: keyof Demand, title: string, unit: string][]} */
const QUANTITIES = [
  ['tilt', 'Tilt', 'rad'],
  ['tilt_rate', 'Tilt rate', 'rad/s'],
  ['speed', 'Speed', 'm/s'],
  ['stroke', 'Stroke', 'm'],
];

/** The largest values with their limits and shares. @param {{label: string, kind?: string, values: Partial<Record<keyof Demand, number | null>>, limits: Record<string, number | undefined>}} props */
export const Loads = ({ label, kind, values, limits }) =>
  html`<${Table} label=${label} kind=${kind} head=${['quantity', 'largest', 'limit', 'share']}
    children=${QUANTITIES.map(([name, title, unit]) => {
      const [value, limit] = [values[name] ?? null, limits[name] ?? null];
      const share = value === null || !limit ? null : value / limit;
      const allowed = limit === null ? 'none' : quantity(limit, unit, 3);
      const part = share === null ? '' : `${number(100 * share, 3)}\u202f%`;
      const cells = [quantity(value, unit, 3), allowed, part];
      return html`<${Row} cells=${[title, ...cells]} kind=${share !== null && share > 1 ? 'beyond' : null} />`;
    })}
  />`;
