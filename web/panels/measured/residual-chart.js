// Residuals against the number of the impact, one strip for each quantity, as SVG.

import { number } from '../../dom/numbers.js';
import { roundRange, ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';

/** Residuals of an impact by name; NaN where one is not there. @typedef {{n: number} & Record<string, number>} Row */
/** Half the width of a band around 0 by name, and numbers of the impacts with a value that was left out. @typedef {{bands: Record<string, number>, outliers: Set<number>}} Expected */
/** Numbers of the simulated impacts that were not measured, and those at which there are measured impacts too many. @typedef {{missed: number[], extra: number[]}} Unpaired */

const MARGIN = { left: 58, right: 12, top: 18, bottom: 34 };
/** A strip and the room over it for its name, px. */
const STRIP = 62;
const BETWEEN = 20;
/** Half bands beyond which a value of an impact with an outlier is that outlier. */
const FAR = 1.5;
/** Height of the lane of impacts without a pair, px. */
const LANE = 14;
/** @type {Unpaired} */
const ALL_PAIRED = { missed: [], extra: [] };

/**
 * @param {HTMLElement} box
 * @param {Row[]} residuals
 * @param {[string, string][]} strips quantities that there are, with names
 * @param {Expected} [expected]
 * @param {Unpaired} [unpaired]
 * @returns {{x: (n: number) => number, top: number, bottom: number} | null} the scale along
 */
export function drawResiduals(
  box,
  residuals,
  strips,
  { bands, outliers } = { bands: {}, outliers: new Set() },
  unpaired = ALL_PAIRED,
) {
  const { width } = box.getBoundingClientRect();
  const lane = unpaired.missed.length + unpaired.extra.length > 0 ? BETWEEN + LANE : 0;
  const height = MARGIN.top + strips.length * (STRIP + BETWEEN) - BETWEEN + lane + MARGIN.bottom;
  if (width < 120 || strips.length === 0) {
    box.replaceChildren();
    return null;
  }
  const [left, right] = [MARGIN.left, width - MARGIN.right];
  const first = residuals[0].n;
  const last = Math.max(first + 1, residuals[residuals.length - 1].n);
  const x = (/** @type {number} */ n) => left + ((n - first) / (last - first)) * (right - left);
  const along = ticks({ low: first, high: last }, Math.max(2, Math.floor((right - left) / 70))).filter(
    Number.isInteger,
  );
  /** @type {Element[]} */
  const parts = [];
  for (const [index, [quantity, name]] of strips.entries()) {
    const top = MARGIN.top + index * (STRIP + BETWEEN);
    const known = residuals.filter((one) => Number.isFinite(one[quantity]));
    const band = bands[quantity] ?? 0;
    const isFar = (/** @type {Row} */ one) => outliers.has(one.n) && Math.abs(one[quantity]) > FAR * band;
    const told = known.filter((one) => !isFar(one));
    const most = Math.max(band, ...told.map((one) => Math.abs(one[quantity])));
    const range = roundRange({ low: -most, high: most }, { symmetric: true, span: most === 0 ? 2 : 0 });
    const y = (/** @type {number} */ value) => top + ((range.high - value) / (range.high - range.low)) * STRIP;
    if (band > 0)
      parts.push(svg('rect', { class: 'band', x: left, y: y(band), width: right - left, height: y(-band) - y(band) }));
    for (const n of along) parts.push(svg('path', { class: 'grid', d: `M${x(n).toFixed(1)} ${top}V${top + STRIP}` }));
    for (const value of ticks(range, 2)) {
      parts.push(
        svg('path', { class: value === 0 ? 'zero' : 'grid', d: `M${left} ${y(value).toFixed(1)}H${right}` }),
        svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, number(value, 2)),
      );
    }
    const at = told.map((one) => `${x(one.n).toFixed(1)} ${y(one[quantity]).toFixed(1)}`);
    parts.push(
      svg('rect', { class: 'edge', x: left, y: top, width: right - left, height: STRIP }),
      svg('text', { class: 'name', x: 2, y: top - 5 }, name),
      svg('path', { class: 'way', d: at.length > 0 ? `M${at.join('L')}` : '' }),
      svg('path', { class: 'dots', d: at.map((place) => `M${place}h0`).join('') }),
      // They would leave no room for the others, so that they stand at the edge.
      ...known.filter(isFar).map((one) => {
        const value = Math.max(range.low, Math.min(range.high, one[quantity]));
        return svg('circle', { class: 'far', cx: x(one.n), cy: y(value), r: 4 });
      }),
    );
  }
  if (lane > 0) {
    const middle = height - MARGIN.bottom - LANE / 2;
    const marks = (/** @type {number[]} */ numbers, /** @type {(at: string) => string} */ shape) =>
      numbers
        .filter((n) => n >= first && n <= last)
        .map((n) => shape(`M${x(n).toFixed(1)} ${middle}`))
        .join('');
    parts.push(
      svg('text', { class: 'name', x: 2, y: height - MARGIN.bottom - LANE - 5 }, 'missed ○, extra ×'),
      svg('rect', { class: 'edge', x: left, y: middle - LANE / 2, width: right - left, height: LANE }),
      svg('path', { class: 'unpaired', d: marks(unpaired.missed, (at) => `${at}m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0`) }),
      svg('path', { class: 'unpaired', d: marks(unpaired.extra, (at) => `${at}m-4 -4l8 8m0 -8l-8 8`) }),
    );
  }
  for (const n of along)
    parts.push(svg('text', { x: x(n), y: height - MARGIN.bottom + 15, 'text-anchor': 'middle' }, number(n, 7)));
  parts.push(svg('text', { class: 'name', x: right, y: height - 3, 'text-anchor': 'end' }, 'bounce'));
  box.replaceChildren(
    svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, 'aria-hidden': 'true' }, ...parts),
  );
  return { x, top: MARGIN.top, bottom: height - MARGIN.bottom };
}
