// The impacts of a run in columns, the newest of them kept; and impacts of the live stream as rows of them.

/** @typedef {import('contract').LiveImpacts['columns']} Columns */
/** @typedef {{[name in keyof Columns]: Columns[name][number]}} FlatImpact one row of the columns */

/** The state just before an impact. */
const BEFORE = /** @type {const} */ (['x', 'theta', 'x_dot', 'y_dot', 'theta_dot']);
/** The velocities just after it. */
const AFTER = /** @type {const} */ (['x_dot_after', 'y_dot_after', 'theta_dot_after']);
/** The contact and its table. */
const CONTACT = /** @type {const} */ (['alpha', 'contact_velocity', 'table_speed', 'mode', 'clearance']);

/** The columns that charts show. */
export const LASTING = /** @type {const} */ (['n', 't', ...BEFORE, 'energy', 'series']);

export const COLUMNS = /** @type {const} */ ([...LASTING, ...AFTER, ...CONTACT, 'flight_time']);

/** @typedef {(typeof COLUMNS)[number]} Column */
/** @typedef {Record<Column, number>} Impact states just before the impact, `…_after` just after; NaN for what does not exist */

/** @typedef {(typeof LASTING)[number]} Lasting */

/** Modes of contact by their number in the column `mode`, which is NaN where the message names none. */
export const MODES = ['frictionless', 'slide', 'stick', 'reverse_slide', 'slide_through'];

/** Limit of memory, so that a day's run does not grow the page: 65,536 impacts, in 9 MB. */
const KEPT = 1 << 16;

/** @param {string} name */
const kindOf = (name) => (name === 'n' ? Uint32Array : name === 'series' ? Uint8Array : Float64Array);

/** The last place from `low` to `high` whose value is not beyond this one; `low` − 1 where there is none. @param {(place: number) => number} rising @param {number} value @param {number} low @param {number} high */
export function lastUpTo(rising, value, low, high) {
  low -= 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (rising(middle) <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

export class Impacts {
  /** Counts every impact taken in, forgotten ones included: the place of the next one. */
  end = 0;
  /** Impacts the server skipped over. */
  missing = 0;
  #kept;
  /** @type {Record<string, Float64Array | Uint32Array | Uint8Array>} */
  #columns;

  /** @param {number} [kept] rounded up to a power of two */
  constructor(kept = KEPT) {
    this.#kept = 2 ** Math.ceil(Math.log2(Math.max(1, kept)));
    this.#columns = Object.fromEntries(COLUMNS.map((name) => [name, new (kindOf(name))(this.#kept)]));
  }

  /** The first place still in memory. */
  get begin() {
    return Math.max(0, this.end - this.#kept);
  }

  /** NaN where there is none. @param {Column} column @param {number} place from `begin` to `end` */
  at(column, place) {
    return this.#columns[column][place % this.#kept];
  }

  /**
   * The last place whose value is not beyond this one; `begin` − 1 where there is none. For columns that rise: `n` and `t`.
   * @param {'n' | 't'} column
   * @param {number} value
   */
  lastUpTo(column, value) {
    return lastUpTo((place) => this.at(column, place), value, this.begin, this.end - 1);
  }

  /** All that is kept of a column, for those who read much of it: a place is its index, less whole lengths. @param {Lasting} column */
  column(column) {
    return this.#columns[column];
  }

  /** @param {number} place @returns {Impact} */
  row(place) {
    return /** @type {Impact} */ (Object.fromEntries(COLUMNS.map((name) => [name, this.at(name, place)])));
  }

  /** @returns {Impact | null} */
  get last() {
    return this.end ? this.row(this.end - 1) : null;
  }

  /** @param {Impact} impact */
  append(impact) {
    for (const name of COLUMNS) this.#columns[name][this.end % this.#kept] = impact[name];
    this.end += 1;
  }

  clear() {
    this.end = 0;
    this.missing = 0;
  }
}

/** A vector's part along the normal of a table. @param {{x: number, y: number}} vector @param {number} alpha tilt of the table, rad */
export const alongNormal = ({ x, y }, alpha) => y * Math.cos(alpha) - x * Math.sin(alpha);

/** @param {FlatImpact} flat @returns {Impact} */
export function impactOf(flat) {
  const { alpha, table_velocity_x: x, table_velocity_y: y } = flat;
  const told = /** @type {Record<string, unknown>} */ (flat);
  const mode = MODES.indexOf(flat.contact_mode ?? '');
  return {
    .../** @type {Impact} */ (Object.fromEntries(COLUMNS.map((name) => [name, Number(told[name] ?? NaN)]))),
    table_speed: x === null || y === null ? NaN : alongNormal({ x, y }, alpha),
    mode: mode < 0 ? NaN : mode,
    series: 0,
  };
}

/** @param {Columns} columns of a message of type `impacts` @returns {Impact[]} */
export const fromColumns = (columns) =>
  columns.n.map((_, row) => {
    const flat = Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, values[row]]));
    return impactOf(/** @type {FlatImpact} */ (/** @type {unknown} */ (flat)));
  });
