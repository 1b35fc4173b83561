// The chart of error over cost, both logarithmic, as SVG. The style sheet colours it in both schemes.

import { outline } from '../../charts/method-symbols.js';
import { svg } from '../../charts/svg.js';

const MARGIN = { left: 58, right: 16, top: 26, bottom: 40 };
/** Half the width of a symbol, px. */
const SIZE = 5;
/** Between two numbers along an axis at least, px. */
const APART = { x: 52, y: 26 };

/**
 * @typedef {object} Place a point as it is drawn
 * @property {number} method its place among all methods
 * @property {number} cost
 * @property {number[] | null} spread its lower and upper quartile
 * @property {number} error
 * @property {boolean} front
 * @property {number} index its place in the answer
 */
/** @typedef {{low: number, high: number}} Range of powers of ten */

/** A symbol about a point. @param {number} method @param {number} x @param {number} y @param {number} [size] */
export const mark = (method, x, y, size = SIZE) =>
  svg('path', {
    class: `mark method-${method}`,
    d: `M${outline(method)
      .map(([right, down]) => `${(x + size * right).toFixed(1)} ${(y + size * down).toFixed(1)}`)
      .join('L')}Z`,
  });

/** @param {number} power */
const raised = (power) =>
  `10${String(power)
    .replace('-', '⁻')
    .replace(/\d/g, (digit) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(digit)])}`;

/** Around all values that have a logarithm, a decade at least. @param {number[]} values @returns {Range} */
function around(values) {
  const powers = values.filter((value) => value > 0).map(Math.log10);
  if (powers.length === 0) return { low: 0, high: 1 };
  const [low, high] = [Math.min(...powers) - 0.2, Math.max(...powers) + 0.2];
  const lack = Math.max(0, 1 - (high - low)) / 2;
  return { low: low - lack, high: high + lack };
}

/** Whole powers, as many as there is room for. @param {Range} range @param {number} length px @param {number} apart px */
function decades({ low, high }, length, apart) {
  const step = Math.max(1, Math.ceil((apart * (high - low)) / length));
  const found = [];
  for (let power = Math.ceil(low / step) * step; power <= high; power += step) found.push(power);
  return found;
}

export class PrecisionChart {
  #box;
  #drawing = svg('svg', { 'aria-hidden': 'true' });
  #ring = svg('circle', { class: 'pointed', r: 9 });
  /** @type {Place[]} */
  #places = [];
  #names = { x: '', y: '' };
  #rounding = 0;
  #hasFront = false;
  /** @type {[number, number][]} */
  #at = [];
  /** @type {number | null} */
  #pointed = null;

  /** @param {HTMLElement} box */
  constructor(box) {
    this.#box = box;
    box.append(this.#drawing);
    new ResizeObserver(() => this.#draw()).observe(box);
  }

  /**
   * @param {Place[]} places
   * @param {{x: string, y: string}} names of the axes
   * @param {number} rounding of the last state: no double is surely nearer
   * @param {boolean} hasFront
   */
  show(places, names, rounding, hasFront) {
    this.#places = places;
    this.#names = names;
    this.#rounding = rounding;
    this.#hasFront = hasFront;
    this.#draw();
  }

  /** The point next to a place on the screen. @param {PointerEvent} event @returns {number | null} its place among those shown */
  nearest(event) {
    const { left, top } = this.#box.getBoundingClientRect();
    let best = null;
    let distance = 24 ** 2;
    for (const [index, [x, y]] of this.#at.entries()) {
      const d = (x - event.clientX + left) ** 2 + (y - event.clientY + top) ** 2;
      if (d <= distance) {
        distance = d;
        best = index;
      }
    }
    return best;
  }

  /** @param {number | null} index */
  point(index) {
    this.#pointed = index;
    const at = index === null ? undefined : this.#at[index];
    this.#ring.toggleAttribute('hidden', !at);
    if (!at) return;
    this.#ring.setAttribute('cx', String(at[0]));
    this.#ring.setAttribute('cy', String(at[1]));
  }

  #draw() {
    const { width, height } = this.#box.getBoundingClientRect();
    const { left, top } = MARGIN;
    const [across, tall] = [width - left - MARGIN.right, height - top - MARGIN.bottom];
    if (across < 40 || tall < 40) return;
    const [right, bottom] = [left + across, top + tall];
    const x = around(this.#places.flatMap(({ cost, spread }) => [cost, ...(spread ?? [])]));
    const y = around([...this.#places.map(({ error }) => error), this.#rounding]);
    const toX = (/** @type {number} */ value) => left + ((Math.log10(value) - x.low) / (x.high - x.low)) * across;
    // A value without a logarithm stands on the lower edge.
    const toY = (/** @type {number} */ value) =>
      value > 0 ? bottom - ((Math.log10(value) - y.low) / (y.high - y.low)) * tall : bottom;
    this.#at = this.#places.map(({ cost, error }) => [toX(cost), toY(error)]);
    /** @type {Element[]} */
    const parts = [];
    for (const power of decades(x, across, APART.x)) {
      const at = toX(10 ** power);
      parts.push(
        svg('path', { class: 'grid', d: `M${at.toFixed(1)} ${top}V${bottom}` }),
        svg('text', { class: 'tick', x: at, y: bottom + 15, 'text-anchor': 'middle' }, raised(power)),
      );
    }
    for (const power of decades(y, tall, APART.y)) {
      const at = toY(10 ** power);
      parts.push(
        svg('path', { class: 'grid', d: `M${left} ${at.toFixed(1)}H${right}` }),
        svg('text', { class: 'tick', x: left - 6, y: at + 4, 'text-anchor': 'end' }, raised(power)),
      );
    }
    parts.push(
      svg('rect', { class: 'edge', x: left, y: top, width: across, height: tall }),
      svg('text', { class: 'name', x: right, y: bottom + 33, 'text-anchor': 'end' }, this.#names.x),
      svg('text', { class: 'name', x: 2, y: top - 9 }, this.#names.y),
    );
    if (this.#rounding > 0)
      parts.push(svg('path', { class: 'floor', d: `M${left} ${toY(this.#rounding).toFixed(1)}H${right}` }));
    const front = this.#places
      .map(({ front }, index) => ({ front, at: this.#at[index] }))
      .filter(({ front }) => front && this.#hasFront)
      .map(({ at }) => at)
      .sort((one, other) => one[0] - other[0]);
    if (front.length > 0) {
      const steps = front
        .slice(1)
        .map(([h, v]) => `H${h.toFixed(1)}V${v.toFixed(1)}`)
        .join('');
      parts.push(
        svg('path', {
          class: 'front',
          d: `M${front[0][0].toFixed(1)} ${top}V${front[0][1].toFixed(1)}${steps}H${right}`,
        }),
      );
    }
    for (const method of new Set(this.#places.map((place) => place.method))) {
      const own = this.#places
        .map((place, index) => ({ place, at: this.#at[index] }))
        .filter(({ place }) => place.method === method);
      parts.push(
        svg('path', {
          class: `way method-${method}`,
          d: own.map(({ at: [h, v] }, n) => `${n ? 'L' : 'M'}${h.toFixed(1)} ${v.toFixed(1)}`).join(''),
        }),
      );
      for (const {
        place: { spread },
        at,
      } of own) {
        if (spread)
          parts.push(
            svg('path', {
              class: `spread method-${method}`,
              d: `M${toX(spread[0]).toFixed(1)} ${at[1].toFixed(1)}H${toX(spread[1]).toFixed(1)}`,
            }),
          );
      }
      parts.push(...own.map(({ at: [h, v] }) => mark(method, h, v)));
    }
    this.#drawing.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#drawing.replaceChildren(...parts, this.#ring);
    this.point(this.#pointed);
  }
}
