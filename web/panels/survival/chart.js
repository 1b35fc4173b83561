// The chart of survival as SVG: the curve in its band, the number at risk beneath, and the quantiles of |θ|.

import { number } from '../../dom/numbers.js';
import { roundRange, ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';

/** @typedef {import('contract').Ensemble} Ensemble */
/** @typedef {import('../../charts/axes.js').Range} Range */

const MARGIN = { left: 46, right: 14, top: 22 };
/** Under the upper picture there are the numbers along it and those at risk, under the lower one numbers and a name. */
const BETWEEN = 78;
const BELOW = 38;
/** The part of the room that the upper picture has. */
const UPPER = 0.58;
/** Between two numbers along an axis, px. */
const APART = { x: 62, y: 34 };

export class SurvivalChart {
  #box;
  #drawing = svg('svg', { 'aria-hidden': 'true' });
  #pointer = svg('path', { class: 'pointer' });
  /** @type {Ensemble | null} */
  #shown = null;
  /** @type {number | null} */
  #pointed = null;
  #left = MARGIN.left;
  #across = 0;
  /** The upper and lower ends of the two pictures, px. @type {[number, number][]} */
  #ends = [];

  /** @param {HTMLElement} box */
  constructor(box) {
    this.#box = box;
    box.append(this.#drawing);
    new ResizeObserver(() => this.#draw()).observe(box);
  }

  /** @param {Ensemble} answer */
  show(answer) {
    this.#shown = answer;
    this.#draw();
  }

  /** The contact at a place on the screen. @param {PointerEvent} event @returns {number | null} */
  nearest(event) {
    if (!this.#shown || this.#across <= 0) return null;
    const x = event.clientX - this.#box.getBoundingClientRect().left - this.#left;
    if (x < -8 || x > this.#across + 8) return null;
    return Math.max(1, Math.min(this.#shown.impacts, Math.round((x / this.#across) * this.#shown.impacts)));
  }

  /** @param {number | null} contact */
  point(contact) {
    this.#pointed = contact;
    this.#pointer.toggleAttribute('hidden', contact === null || !this.#shown);
    if (contact === null || !this.#shown) return;
    const x = (this.#left + (contact / this.#shown.impacts) * this.#across).toFixed(1);
    this.#pointer.setAttribute('d', this.#ends.map(([from, to]) => `M${x} ${from}V${to}`).join(''));
  }

  #draw() {
    const { width, height } = this.#box.getBoundingClientRect();
    if (!this.#shown || width < 120 || height < 200) return;
    const { survival, quantiles, runs, impacts } = this.#shown;
    const { left, top } = MARGIN;
    const across = width - left - MARGIN.right;
    this.#across = across;
    const room = height - top - BETWEEN - BELOW;
    const middle = top + Math.round(room * UPPER);
    const from = middle + BETWEEN;
    const bottom = height - BELOW;
    const right = left + across;
    this.#ends = [
      [top, middle],
      [from, bottom],
    ];
    const x = (/** @type {number} */ contact) => left + (contact / impacts) * across;
    const share = { low: 0, high: 1 };
    const y = (/** @type {number} */ value) => middle - value * (middle - top);
    const along = ticks({ low: 0, high: impacts }, Math.max(2, Math.floor(across / APART.x))).filter(Number.isInteger);
    /** @type {Element[]} */
    const parts = [];
    /** @param {Range} range @param {number} above @param {number} below */
    const axes = (range, above, below) => {
      for (const contact of along) {
        parts.push(
          svg('path', { class: 'grid', d: `M${x(contact).toFixed(1)} ${above}V${below}` }),
          svg('text', { x: x(contact), y: below + 15, 'text-anchor': 'middle' }, number(contact, 7)),
        );
      }
      for (const value of ticks(range, Math.max(2, (below - above) / APART.y))) {
        const at = below - ((value - range.low) / (range.high - range.low)) * (below - above);
        parts.push(
          svg('path', { class: 'grid', d: `M${left} ${at.toFixed(1)}H${right}` }),
          svg('text', { x: left - 6, y: at + 4, 'text-anchor': 'end' }, number(value)),
        );
      }
      parts.push(svg('rect', { class: 'edge', x: left, y: above, width: across, height: below - above }));
    };
    axes(share, top, middle);
    parts.push(svg('text', { class: 'name', x: 2, y: top - 8 }, 'share of runs going on'));
    const line = (/** @type {number[]} */ values, first = values[0]) =>
      corners(values, first, impacts).map(([contact, value]) => `${x(contact).toFixed(1)} ${y(value).toFixed(1)}`);
    parts.push(
      svg('path', { class: 'band', d: `M${[...line(survival.upper), ...line(survival.lower).reverse()].join('L')}Z` }),
      svg('path', { class: 'curve', d: `M${line(survival.survival, 1).join('L')}` }),
    );
    // The number at risk at a contact is of those that came to it; before the first one it is all.
    parts.push(svg('text', { class: 'name', x: 2, y: middle + 34 }, 'at risk'));
    for (const contact of along) {
      parts.push(
        svg(
          'text',
          { class: 'risk', x: x(contact), y: middle + 50, 'text-anchor': 'middle' },
          number(contact === 0 ? runs : survival.at_risk[contact - 1], 6),
        ),
      );
    }
    const largest = Math.max(0, ...quantiles.q95.map((value) => value ?? 0));
    const range = roundRange({ low: 0, high: largest || 0.1 }, { from: 0 });
    axes(range, from, bottom);
    const down = (/** @type {number} */ value) => bottom - (value / range.high) * (bottom - from);
    parts.push(
      svg('text', { class: 'name', x: 2, y: from - 8 }, '|θ| / rad'),
      svg('text', { class: 'name', x: right, y: bottom + 32, 'text-anchor': 'end' }, 'contact'),
    );
    const places = quantiles.n.map(x);
    for (const [name, low, high] of /** @type {const} */ ([
      ['wide', 'q05', 'q95'],
      ['inner', 'q25', 'q75'],
    ])) {
      parts.push(svg('path', { class: name, d: between(places, quantiles[low], quantiles[high], down) }));
    }
    parts.push(svg('path', { class: 'median', d: way(places, quantiles.q50, down) }));
    this.#drawing.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#drawing.replaceChildren(...parts, this.#pointer);
    this.point(this.#pointed);
  }
}

/**
 * The corners of a curve that changes at contacts only.
 * @param {number[]} values after each contact
 * @param {number} first before them
 * @param {number} last contact
 */
function corners(values, first, last) {
  /** @type {[number, number][]} */
  const found = [[0, first]];
  let before = first;
  for (const [index, value] of values.entries()) {
    if (value !== before) found.push([index + 1, before], [index + 1, value]);
    before = value;
  }
  found.push([last, before]);
  return found;
}

/** @param {number[]} places @param {(number | null)[]} values @param {(value: number) => number} y */
function way(places, values, y) {
  let open = false;
  return values
    .map((value, index) => {
      const step = value === null ? '' : `${open ? 'L' : 'M'}${places[index].toFixed(1)} ${y(value).toFixed(1)}`;
      open = value !== null;
      return step;
    })
    .join('');
}

/** @param {number[]} places @param {(number | null)[]} low @param {(number | null)[]} high @param {(value: number) => number} y */
function between(places, low, high, y) {
  const there = places.map((_, index) => index).filter((index) => low[index] !== null && high[index] !== null);
  const edge = (/** @type {number[]} */ order, /** @type {(number | null)[]} */ values) =>
    order.map((index) => `${places[index].toFixed(1)} ${y(/** @type {number} */ (values[index])).toFixed(1)}`);
  const round = [...edge(there, high), ...edge(there.toReversed(), low)];
  return round.length > 0 ? `M${round.join('L')}Z` : '';
}
