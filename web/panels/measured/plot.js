// Plots of measured bounces as SVG: strips over one axis, read by pointer and keys.

import { ticks } from '../../charts/axes.js';
import { movedInRow } from '../../charts/readable/chart-reader.js';
import { svg } from '../../charts/svg.js';
import { number } from '../../dom/numbers.js';

/** @typedef {import('../../charts/axes.js').Range} Range */
/** @typedef {(value: number) => number} Scale px of a value */
/** A strip on the screen, with the ticks of the axis along. @typedef {{x: Scale, y: Scale, left: number, right: number, top: number, bottom: number, along: number[]}} Area */

/**
 * @typedef {object} Strip
 * @property {string} name
 * @property {number} height px
 * @property {Range} range
 * @property {number[]} ticks
 * @property {number} [zero] the tick with a stronger line
 * @property {number} [band] half the width of a band around 0
 * @property {boolean} [log]
 * @property {(area: Area) => Element[]} marks
 */

/** Room around the strips and between them, px. */
const [LEFT, RIGHT, TOP, BETWEEN, BELOW] = [58, 12, 24, 20, 34];

/**
 * @param {HTMLElement} box
 * @param {object} what
 * @param {Range} what.along
 * @param {string} what.name of the axis along
 * @param {boolean} [what.whole] its ticks are whole numbers
 * @param {Strip[]} what.strips
 * @param {number[]} what.items places along that can be read
 * @param {(item: number) => string} what.words
 */
export function plot(box, { along, name, whole = false, strips, items, words }) {
  const { width } = box.getBoundingClientRect();
  box.replaceChildren();
  if (width < 120 || strips.length === 0) return null;
  const [left, right] = [LEFT, width - RIGHT];
  const x = (/** @type {number} */ at) => left + ((at - along.low) / (along.high - along.low)) * (right - left);
  const across = ticks(along, Math.max(2, Math.floor((right - left) / 75))).filter(
    (at) => !whole || Number.isInteger(at),
  );
  /** @type {Element[]} */
  const parts = [];
  let top = TOP;
  for (const { name: said, height, range, ticks: up, zero, band = 0, log, marks } of strips) {
    const scale = log ? Math.log : Number;
    const [low, high] = [scale(range.low), scale(range.high)];
    const bottom = top + height;
    const y = (/** @type {number} */ value) => bottom - ((scale(value) - low) / (high - low)) * height;
    if (band > 0)
      parts.push(svg('rect', { class: 'band', x: left, y: y(band), width: right - left, height: y(-band) - y(band) }));
    for (const value of up)
      parts.push(
        svg('path', { class: value === zero ? 'zero' : 'grid', d: `M${left} ${y(value).toFixed(1)}H${right}` }),
        svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, number(value, 3)),
      );
    parts.push(
      svg('rect', { class: 'edge', x: left, y: top, width: right - left, height }),
      svg('text', { class: 'name', x: 2, y: top - 7 }, said),
      ...marks({ x, y, left, right, top, bottom, along: across }),
    );
    top = bottom + BETWEEN;
  }
  const bottom = top - BETWEEN;
  const height = bottom + BELOW;
  const line = svg('path', { class: 'pointed', hidden: '' });
  parts.push(
    ...across.map((at) => svg('text', { x: x(at), y: bottom + 15, 'text-anchor': 'middle' }, number(at, 7))),
    svg('text', { class: 'name', x: right, y: height - 3, 'text-anchor': 'end' }, name),
    line,
  );
  box.replaceChildren(
    svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, 'aria-hidden': 'true' }, ...parts),
  );
  return {
    nearest: (/** @type {PointerEvent} */ { clientX }) => {
      const from = clientX - box.getBoundingClientRect().left;
      const distance = (/** @type {number} */ item) => Math.abs(x(items[item]) - from);
      return items.length === 0
        ? null
        : items.reduce((best, _, item) => (distance(item) < distance(best) ? item : best), 0);
    },
    moved: (/** @type {string} */ key, /** @type {number | null} */ at) => movedInRow(key, at, 0, items.length - 1),
    mark: (/** @type {number | null} */ item) => {
      line.toggleAttribute('hidden', item === null);
      if (item !== null) line.setAttribute('d', `M${x(items[item]).toFixed(1)} ${TOP}V${bottom}`);
    },
    words,
  };
}

/** A way through places, and nothing without any. @param {string[]} places as `x y` */
export const way = (places) => (places.length > 0 ? `M${places.join('L')}` : '');
