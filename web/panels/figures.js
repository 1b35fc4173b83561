// Parts of studies, loaded with them: charts that are read by pointer and keys, words that are explained, answers to keep, and demands on the table.

import { get } from '../api/client.js';
import { ChartReader } from '../charts/readable/chart-reader.js';
import { serverFigure } from '../charts/readable/server-figure.js';
import { term } from '../dom/glossary.js';
import { number, quantity } from '../dom/numbers.js';
import { actions } from '../export/save-actions.js';
import { html, useEffect, useMemo, useRef } from '../vendor/preact/preact.js';
import { Nodes, Row, Table } from './parts.js';

/** A word that is explained at a press. @param {{name: import('../dom/glossary.js').Term, words?: string}} props */
export function Term({ name, words: said }) {
  const nodes = useMemo(() => [term(name, said)], [name, said]);
  return html`<${Nodes} nodes=${nodes} />`;
}

/**
 * An answer with its picture.
 * @param {string} path
 * @param {AbortSignal} [signal]
 * @returns {Promise<[any, SVGSVGElement]>}
 */
export const pictured = (path, signal) => Promise.all([get(path, signal), serverFigure(`${path}&format=svg`, signal)]);

/** An answer as files to keep. @param {{id: string, title: string, path: string, formats?: string[]}} props */
export function Savings({ id, title, path, formats = ['svg', 'png', 'csv', 'arrow', 'json'] }) {
  const nodes = useMemo(() => actions({ id, title, path, formats }), [path]);
  return html`<${Nodes} nodes=${nodes} />`;
}

/**
 * A chart that is read by pointer and keys, drawn anew with its width.
 * @param {object} props
 * @param {string} props.name the beginning of its ids
 * @param {string} props.label for those who do not see it
 * @param {unknown} props.hint on its keys
 * @param {string} [props.kind] class of its box
 * @param {(box: HTMLElement) => import('../charts/readable/chart-reader.js').Readable | null} props.draw
 * @param {readonly unknown[]} props.inputs of the drawing
 */
export function Chart({ name, label, hint, kind = 'measured-box', draw, inputs }) {
  const shown = useRef(/** @type {ReturnType<typeof draw>} */ (null));
  const at = useRef(/** @type {number | null} */ (null));
  const reader = useMemo(() => {
    const made = new ChartReader(name, label);
    made.box.classList.add(kind);
    made.read({
      nearest: (event) => shown.current?.nearest(event) ?? null,
      moved: (key, item) => shown.current?.moved(key, item),
      mark: (item) => {
        at.current = item;
        shown.current?.mark(item);
      },
      words: (item) => shown.current?.words(item) ?? '',
    });
    return made;
  }, []);
  useEffect(() => {
    reader.point(null, false);
    const watch = new ResizeObserver(() => {
      shown.current = draw(reader.box);
      shown.current?.mark(at.current);
    });
    watch.observe(reader.box);
    return () => watch.disconnect();
  }, inputs);
  useEffect(() => reader.box.setAttribute('aria-label', label), [label]);
  return html`<div class=${`${name}-chart`}>
    <${Nodes} tag="div" nodes=${[reader.box, reader.readout, reader.spoken]} />
    <p class="muted small" id=${`${name}-hint`}>${hint}</p>
  </div>`;
}

/** @typedef {import('contract').Trajectory['demand']} Demand */

/** @type {[name: keyof Demand, title: string, unit: string][]} */
const QUANTITIES = [
  ['tilt', 'Tilt', 'rad'],
  ['tilt_rate', 'Tilt rate', 'rad/s'],
  ['speed', 'Speed', 'm/s'],
  ['stroke', 'Stroke', 'm'],
];

/** The largest values with their limits and shares. @param {{label: string, kind?: string, values: Partial<Record<keyof Demand, number | null>>, limits: Record<string, number | undefined>}} props */
export const Loads = ({ label, kind, values, limits }) =>
  html`<${Table}
    label=${label}
    kind=${kind}
    head=${['quantity', 'largest', 'limit', 'share']}
    children=${QUANTITIES.map(([name, title, unit]) => {
      const [value, limit] = [values[name] ?? null, limits[name] ?? null];
      const share = value === null || !limit ? null : value / limit;
      const allowed = limit === null ? 'none' : quantity(limit, unit, 3);
      const part = share === null ? '' : `${number(100 * share, 3)}\u202f%`;
      const cells = [quantity(value, unit, 3), allowed, part];
      return html`<${Row} cells=${[title, ...cells]} kind=${share !== null && share > 1 ? 'beyond' : null} />`;
    })}
  />`;
