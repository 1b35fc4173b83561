// Residuals over the number of the bounce: measured less computed, a strip for each quantity.

import { roundRange, ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';
import { number, quantity as worded } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';
import { html } from '../../vendor/preact/preact.js';
import { Chart } from '../figures.js';
import { plot, way } from './plot.js';
import { QUANTITIES, nameOf, shownOf } from './quantities.js';

/** @typedef {import('./quantities.js').Column} Column */
/** @typedef {import('./plot.js').Strip} Strip */
/** Residuals of a bounce in SI units, NaN where one is not there; `outlier` has a value that was left out. @typedef {{n: number, line: number | undefined, outlier?: boolean} & Record<Column, number>} Residual */

const STRIP = 62;
const LANE = 14;
/** Half bands beyond which a value of a bounce with an outlier is that outlier. */
const FAR = 1.5;

/** @param {Residual[]} rows @param {Column} quantity @param {number} half of the band, in SI units @returns {Strip} */
function stripOf(rows, quantity, half) {
  const band = shownOf(quantity, half);
  const known = rows
    .filter((one) => Number.isFinite(one[quantity]))
    .map(({ n, outlier, [quantity]: value }) => ({ n, outlier, value: shownOf(quantity, value) }));
  const isFar = (/** @type {typeof known[number]} */ { outlier, value }) => outlier && Math.abs(value) > FAR * band;
  const told = known.filter((one) => !isFar(one));
  const most = Math.max(band, ...told.map(({ value }) => Math.abs(value)));
  const range = roundRange({ low: -most, high: most }, { symmetric: true, span: most === 0 ? 2 : 0 });
  /** @type {Strip['marks']} */
  const marks = ({ x, y, top, bottom, along }) => {
    const places = told.map(({ n, value }) => `${x(n).toFixed(1)} ${y(value).toFixed(1)}`);
    return [
      ...along.map((n) => svg('path', { class: 'grid', d: `M${x(n).toFixed(1)} ${top}V${bottom}` })),
      svg('path', { class: 'way', d: way(places) }),
      svg('path', { class: 'dots', d: places.map((place) => `M${place}h0`).join('') }),
      // They would leave no room for the others, so that they stand at the edge.
      ...known.filter(isFar).map(({ n, value }) => {
        const edge = Math.max(range.low, Math.min(range.high, value));
        return svg('circle', { class: 'far', cx: x(n), cy: y(edge), r: 4 });
      }),
    ];
  };
  return { name: `δ${nameOf(quantity)}`, height: STRIP, range, ticks: ticks(range, 2), zero: 0, band, marks };
}

/** A strip of bounces without a pair. @param {import('../../charts/axes.js').Range} along @param {number[]} missed @param {number[]} extra @returns {Strip} */
const unpairedStrip = (along, missed, extra) => ({
  name: 'missed ○, extra ×',
  height: LANE,
  range: { low: 0, high: 1 },
  ticks: [],
  marks: ({ x, y }) => {
    const shaped = (/** @type {number[]} */ numbers, /** @type {string} */ shape) => {
      const seen = numbers.filter((n) => n >= along.low && n <= along.high);
      return svg('path', { class: 'unpaired', d: seen.map((n) => `M${x(n).toFixed(1)} ${y(0.5)}${shape}`).join('') });
    };
    return [shaped(missed, 'm-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0'), shaped(extra, 'm-4 -4l8 8m0 -8l-8 8')];
  },
});

/**
 * @param {object} props
 * @param {string} props.name the beginning of its ids
 * @param {string} props.label for those who do not see it
 * @param {string} [props.hint]
 * @param {Residual[]} props.rows
 * @param {Column[]} props.quantities that there are
 * @param {Partial<Record<Column, number>>} [props.bands] half the width of a band around 0
 * @param {number[]} [props.missed] numbers of bounces that were not measured
 * @param {number[]} [props.extra] those at which there are measured ones too many
 */
export function Residuals({ name, label, hint = '', rows, quantities, bands = {}, missed = [], extra = [] }) {
  const [low, last] = [rows[0]?.n ?? 0, rows.at(-1)?.n ?? 0];
  const along = { low, high: Math.max(low + 1, last) };
  const words = (/** @type {number} */ item) => {
    const { n, line, outlier, ...values } = rows[item];
    const told = quantities
      .filter((one) => Number.isFinite(values[one]))
      .map((one) => `δ${QUANTITIES[one][0]} ${worded(values[one], QUANTITIES[one][1], 3)}`);
    const place = [`n ${number(n, 7)}`, line && `line ${number(line, 7)}`];
    return [...place, ...told, outlier && 'a value left out'].filter(Boolean).join('   ');
  };
  const draw = (/** @type {HTMLElement} */ box) => {
    const strips = quantities.map((one) => stripOf(rows, one, bands[one] ?? 0));
    if (missed.length + extra.length > 0) strips.push(unpairedStrip(along, missed, extra));
    return plot(box, { along, name: 'bounce', whole: true, strips, items: rows.map(({ n }) => n), words });
  };
  return html`<${Chart} name=${name} label=${label} draw=${draw} inputs=${[rows, angles()]}
    hint=${`${hint}With keys: left and right go from bounce to bounce.`} />`;
}
