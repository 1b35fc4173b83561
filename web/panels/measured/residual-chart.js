// Residuals against the number of the impact, one strip for each quantity, as SVG.

import { number } from '../../dom/numbers.js';
import { roundRange, ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';

/** @typedef {import('./compare.js').Residual} Residual */
/** @typedef {import('./compare.js').Compared} Compared */

const MARGIN = { left: 58, right: 12, top: 18, bottom: 34 };
/** A strip and the room over it for its name, px. */
const STRIP = 62;
const BETWEEN = 20;

/**
 * @param {HTMLElement} box
 * @param {Residual[]} residuals
 * @param {[Compared, string][]} strips quantities that there are, with names
 */
export function drawResiduals(box, residuals, strips) {
  const { width } = box.getBoundingClientRect();
  const height = MARGIN.top + strips.length * (STRIP + BETWEEN) - BETWEEN + MARGIN.bottom;
  if (width < 120 || strips.length === 0) return box.replaceChildren();
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
    const told = residuals.filter((one) => Number.isFinite(one[quantity]));
    const most = Math.max(...told.map((one) => Math.abs(one[quantity])));
    const range = roundRange({ low: -most, high: most }, { symmetric: true, span: most === 0 ? 2 : 0 });
    const y = (/** @type {number} */ value) => top + ((range.high - value) / (range.high - range.low)) * STRIP;
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
      svg('path', { class: 'way', d: `M${at.join('L')}` }),
      svg('path', { class: 'dots', d: at.map((place) => `M${place}h0`).join('') }),
    );
  }
  for (const n of along)
    parts.push(svg('text', { x: x(n), y: height - MARGIN.bottom + 15, 'text-anchor': 'middle' }, number(n, 7)));
  parts.push(svg('text', { class: 'name', x: right, y: height - 3, 'text-anchor': 'end' }, 'impact'));
  box.replaceChildren(
    svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, 'aria-hidden': 'true' }, ...parts),
  );
}
