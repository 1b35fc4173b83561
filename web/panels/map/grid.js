// The cells of a map as they arrive, row by row. Until then a row has the cells of the coarser map before.

import { classOf } from './classes.js';
import { rowsOf } from './settings.js';

/** @typedef {import('contract').Region['limit_curves']} LimitCurves */
/** @typedef {import('./classes.js').Class} Class */
/** @typedef {import('./settings.js').Side} Side */

/** A run that ends within this share of its bounces falls early. */
const EARLY = 0.25;
/** A map has two values where no more than this share of its cells lies between. */
const FEW = 0.08;
/** Runs of fewer bounces are too short for two classes. */
const LONG = 20;

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
  /** True when there was a coarser map before. */
  isFiner = false;
  /** True when some cell that arrived has no value. */
  lacks = false;
  low = Infinity;
  high = -Infinity;
  /** The number of cells of each outcome; null until the answer is whole. @type {Record<string, number> | null} */
  counts = null;
  /** 1 for each outcome that has occurred. */
  #seen = new Uint8Array(256);
  /** @type {string[]} */
  names;
  /** @type {LimitCurves} */
  limitCurves;
  /** True when its runs last to the end or fall early, so that it has classes in place of a scale. */
  classes = false;

  /**
   * @param {import('./settings.js').Settings} settings
   * @param {{outcome_names: string[], limit_curves: LimitCurves}} outline
   * @param {Grid | null} coarser
   */
  constructor(settings, outline, coarser) {
    this.settings = settings;
    this.columns = settings.columns;
    this.rows = rowsOf(settings.columns);
    this.values = new Float64Array(this.columns * this.rows).fill(NaN);
    this.outcomes = new Uint8Array(this.columns * this.rows);
    this.#arrived = new Uint8Array(this.rows);
    this.names = outline.outcome_names;
    this.limitCurves = outline.limit_curves;
    if (!coarser) return;
    this.isFiner = true;
    this.classes = coarser.classes;
    this.lacks = coarser.lacks;
    [this.low, this.high] = [coarser.low, coarser.high];
    this.#seen.set(coarser.#seen);
    for (let place = 0; place < this.values.length; place += 1) {
      const column = place % this.columns;
      const { column: at, row } = coarser.cellAround(this.x(column), this.y((place - column) / this.columns));
      this.values[place] = coarser.value(at, row);
      this.outcomes[place] = coarser.outcomes[row * coarser.columns + at];
    }
  }

  /** The value of a cell; NaN where there is none. @param {number} column @param {number} row */
  value(column, row) {
    return this.values[row * this.columns + column];
  }

  /** The name of its outcome. @param {number} column @param {number} row */
  outcome(column, row) {
    return this.names[this.outcomes[row * this.columns + column]] ?? 'none';
  }

  /** The cell around a point of the map; outside it the nearest. @param {number} x @param {number} y */
  cellAround(x, y) {
    const place = (/** @type {Side} */ { from, to }, /** @type {number} */ value, /** @type {number} */ count) =>
      Math.min(count - 1, Math.max(0, Math.round(((value - from) / (to - from)) * (count - 1))));
    return { column: place(this.settings.x, x, this.columns), row: place(this.settings.y, y, this.rows) };
  }

  /** The class of an outcome. @param {string} outcome */
  classOf(outcome) {
    return classOf(outcome, this.settings.quantity);
  }

  /** Finds out whether classes tell what the values do. */
  judge() {
    const { quantity, bounces } = this.settings;
    const values = this.values.filter((value) => !Number.isNaN(value));
    const between = values.filter((value) => value < bounces && value > bounces * EARLY);
    const few = bounces >= LONG && between.length <= values.length * FEW;
    this.classes = quantity === 'caught' || (quantity === 'survival' && few);
  }

  /** True when some cell that arrived is of this class. @param {Class} kind */
  holds(kind) {
    return this.names.some((name, index) => this.#seen[index] === 1 && this.classOf(name) === kind);
  }

  /** Share of the cells of each class, the largest first. @returns {[Class, number][]} */
  shares() {
    /** @type {Map<Class, number>} */
    const found = new Map();
    for (const [name, count] of Object.entries(this.counts ?? {}))
      if (count > 0)
        found.set(this.classOf(name), (found.get(this.classOf(name)) ?? 0) + count / (this.columns * this.rows));
    return [...found].sort(([, a], [, b]) => b - a);
  }

  /** @param {import('contract').RegionLine} line */
  take(line) {
    if ('end' in line) {
      this.counts = line.end.counts;
      this.lacks = this.values.some(Number.isNaN);
      return;
    }
    const from = line.row * this.columns;
    line.values.forEach((value, column) => {
      this.values[from + column] = value ?? NaN;
      if (value === null) this.lacks = true;
      else [this.low, this.high] = [Math.min(this.low, value), Math.max(this.high, value)];
    });
    this.outcomes.set(line.outcomes, from);
    for (const outcome of line.outcomes) this.#seen[outcome] = 1;
    this.arrived += 1 - this.#arrived[line.row];
    this.#arrived[line.row] = 1;
  }

  /** Rows that have arrived, and their number in all. */
  get progress() {
    return { done: this.arrived, of: this.rows, columns: this.columns };
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
    if (this.settings.quantity === 'survival') return { low: 0, high: this.settings.bounces };
    return this.low <= this.high ? { low: this.low, high: this.high } : { low: 0, high: 1 };
  }
}

/** @param {Side} side @param {number} index @param {number} count */
function valueOn({ from, to }, index, count) {
  const share = index / (count - 1);
  return share === 1 ? to : from + (to - from) * share;
}
