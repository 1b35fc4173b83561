// The cells of a map: asked for from coarse to fine, drawn as they stream, row by row, and kept.

import { lines } from '../../api/answers.js';
import { Problem, get } from '../../api/client.js';
import { classOf } from './classes.js';
import { bouncesOf, outlineQuery, passesOf, requestQuery, rowsOf } from './settings.js';

/** @typedef {import('contract').Region['limit_curves']} LimitCurves */
/** @import { Class } from './classes.js' */

/** A run that ends within this share of its bounces falls early. */
const EARLY = 0.25;
/** A map has two values where no more than this share of its cells lies between. */
const FEW = 0.08;
/** Runs of fewer bounces are too short for two classes. */
const LONG = 20;

/** The cells as they arrive. Until then a row has those of the coarser map before. */
export class Grid {
  settings;
  columns;
  rows;
  /** Not a number where there is none. */
  values;
  outcomes;
  /** The names of outcomes. */
  names;
  limitCurves;
  /** 1 for each row that has arrived. */
  #arrived;
  /** True when there was a coarser map before. */
  isFiner;
  /** True when some cell that arrived has no value. */
  lacks = false;
  low = Infinity;
  high = -Infinity;
  /** True when its runs last to the end or fall early, so that it has classes in place of a scale. */
  classes = false;
  /** The number of cells of each outcome; null until the answer is whole. @type {Record<string, number> | null} */
  counts = null;

  /** @param {MapSettings} settings @param {{outcome_names: string[], limit_curves: LimitCurves}} outline @param {Grid | null} coarser */
  constructor(settings, { outcome_names: names, limit_curves: limitCurves }, coarser) {
    this.settings = settings;
    this.columns = settings.columns;
    this.rows = rowsOf(settings.columns);
    this.values = new Float64Array(this.columns * this.rows).fill(NaN);
    this.outcomes = new Uint8Array(this.columns * this.rows);
    this.names = names;
    this.limitCurves = limitCurves;
    this.#arrived = new Uint8Array(this.rows);
    this.isFiner = coarser !== null;
    if (!coarser) return;
    const { classes, lacks, low, high } = coarser;
    Object.assign(this, { classes, lacks, low, high });
    for (let place = 0; place < this.values.length; place += 1) {
      const column = place % this.columns;
      const cell = coarser.cellAround({ x: this.x(column), y: this.y((place - column) / this.columns) });
      const before = cell.row * coarser.columns + cell.column;
      this.values[place] = coarser.values[before];
      this.outcomes[place] = coarser.outcomes[before];
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

  /** The cell around values of the two fields; outside of the map the nearest. @param {{x: number, y: number}} values */
  cellAround({ x, y }) {
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

  /** Share of the cells of each class, the largest first. @returns {[Class, number][]} */
  shares() {
    /** @type {Map<Class, number>} */
    const found = new Map();
    for (const [name, count] of Object.entries(this.counts ?? {}).filter(([, count]) => count > 0))
      found.set(this.classOf(name), (found.get(this.classOf(name)) ?? 0) + count / this.values.length);
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
    this.#arrived[line.row] = 1;
  }

  /** Rows that have arrived, and their number in all. */
  get progress() {
    return { done: this.#arrived.filter(Boolean).length, of: this.rows, columns: this.columns };
  }

  /** True for a row that has arrived. @param {number} row */
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

/** A pass of more bounces than this waits until somebody asks for it: about a second of one core. */
const UNASKED_BOUNCES = 1e8;
/** Answers kept, to go back without asking again: eight maps with their passes. */
const KEPT = 24;
/** @type {Map<string, Grid>} */
const known = new Map();

/**
 * Asks for a map, finer and finer.
 * @param {MapSettings} settings
 * @param {URLSearchParams} scene
 * @param {object} how
 * @param {AbortSignal} how.signal
 * @param {boolean} how.unasked true when nobody has pressed a button for it
 * @param {(progress: {done: number, of: number, columns: number}) => void} how.heard rows of a pass
 * @param {(grid: Grid, request: URLSearchParams) => void} how.show a pass has its first rows, or all
 * @returns {Promise<{grid: Grid | null, refused: Problem | null, waits: MapSettings | null}>} as fine as wanted, or as the server allows; or up to a pass that waits for somebody to ask for it
 */
export async function refine(settings, scene, { signal, unasked, heard, show }) {
  const passes = passesOf(settings.columns).map((columns) => ({ ...settings, columns }));
  /** @type {Grid | null} */
  let grid = null;
  /** @type {Problem | null} */
  let refused = null;
  /** @type {any} */
  let outline = null;
  // A map that is kept needs no coarser one before it.
  const from = passes.findLastIndex((pass) => known.has(String(requestQuery(pass, scene))));
  for (let index = Math.max(0, from); index < passes.length && !signal.aborted; index += 1) {
    const pass = passes[index];
    const request = requestQuery(pass, scene);
    const kept = known.get(String(request));
    if (kept) {
      grid = kept;
      heard(kept.progress);
      show(kept, request);
      continue;
    }
    if (unasked && bouncesOf(pass) > UNASKED_BOUNCES) return { grid, refused, waits: pass };
    heard({ done: 0, of: rowsOf(pass.columns), columns: pass.columns });
    try {
      outline ??= await get(`v1/regions?${outlineQuery(request)}`, signal);
      const next = new Grid(pass, outline, grid);
      // The cells of before stay until there are new ones.
      let shown = false;
      await fill(next, request, signal, () => {
        heard(next.progress);
        if (!shown) show(next, request);
        shown = true;
      });
      grid = next;
    } catch (error) {
      if (!grid || !(error instanceof Problem) || error.status !== 422) throw error;
      // The price of this pass is too high; one of half as many columns may do.
      refused = error;
      const columns = pass.columns / 2;
      if (columns > grid.columns) passes.splice(index + 1, Infinity, { ...pass, columns });
      else passes.length = index;
    }
  }
  return { grid, refused, waits: null };
}

/** @param {Grid} grid @param {URLSearchParams} request @param {AbortSignal} signal @param {() => void} grown */
async function fill(grid, request, signal, grown) {
  for await (const line of lines(`v1/regions?${request}&format=ndjson`, { signal })) {
    if (signal.aborted) return;
    grid.take(line);
    if (!grid.isFiner) grid.judge();
    grown();
  }
  if (!grid.counts) throw new Problem('', 'The answer was cut off.', [], 0);
  known.set(String(request), grid);
  for (const key of known.keys()) if (known.size > KEPT) known.delete(key);
}
