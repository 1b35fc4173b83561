// The cells of a map as they arrive, row by row.

import { rowsOf } from './settings.js';

/** @typedef {import('contract').Region['boundary']} Boundary */

export class Grid {
  columns;
  rows;
  settings;
  /** Not a number where there is none. */
  values;
  outcomes;
  /** 1 for each row that has arrived. */
  #arrived;
  arrived = 0;
  /** True when some cell that arrived has no value. */
  lacks = false;
  low = Infinity;
  high = -Infinity;
  /** The number of cells of each outcome; null until the answer is whole. @type {Record<string, number> | null} */
  counts = null;
  /** @type {string[]} */
  names;
  /** @type {Boundary} */
  boundary;

  /**
   * @param {import('./settings.js').Settings} settings
   * @param {{outcome_names: string[], boundary: Boundary}} outline
   */
  constructor(settings, outline) {
    this.settings = settings;
    this.columns = settings.columns;
    this.rows = rowsOf(settings.columns);
    this.values = new Float64Array(this.columns * this.rows).fill(NaN);
    this.outcomes = new Uint8Array(this.columns * this.rows);
    this.#arrived = new Uint8Array(this.rows);
    this.names = outline.outcome_names;
    this.boundary = outline.boundary;
  }

  /** @param {import('contract').RegionLine} line */
  take(line) {
    if ('end' in line) {
      this.counts = line.end.counts;
      return;
    }
    const from = line.row * this.columns;
    line.values.forEach((value, column) => {
      if (value === null) {
        this.lacks = true;
        return;
      }
      this.values[from + column] = value;
      this.low = Math.min(this.low, value);
      this.high = Math.max(this.high, value);
    });
    this.outcomes.set(line.outcomes, from);
    this.arrived += 1 - this.#arrived[line.row];
    this.#arrived[line.row] = 1;
  }

  /** @param {number} row */
  has(row) {
    return this.#arrived[row] === 1;
  }

  /** The value of the field across, bit for bit the server's. @param {number} column */
  x(column) {
    return valueOn(this.settings.x, column, this.columns);
  }

  /** @param {number} row */
  y(row) {
    return valueOn(this.settings.y, row, this.rows);
  }

  /** The ends of the colours: with impacts to survive, from none to all. */
  get scale() {
    if (this.settings.quantity === 'survival') return { low: 0, high: this.settings.impacts };
    return this.low <= this.high ? { low: this.low, high: this.high } : { low: 0, high: 1 };
  }
}

/**
 * @param {import('./settings.js').Side} side
 * @param {number} index
 * @param {number} count
 */
function valueOn({ from, to }, index, count) {
  const share = index / (count - 1);
  return share === 1 ? to : from + (to - from) * share;
}
