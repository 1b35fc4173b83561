// The impacts of a run in columns; the newest of them are kept.

/** The columns that charts show. */
export const LASTING = /** @type {const} */ ([
  'n',
  't',
  'x',
  'theta',
  'x_dot',
  'y_dot',
  'theta_dot',
  'energy',
  'series',
]);

export const COLUMNS = /** @type {const} */ ([
  ...LASTING,
  'x_dot_after',
  'y_dot_after',
  'theta_dot_after',
  'alpha',
  'flight_time',
  'contact_velocity',
  'table_speed',
  'mode',
  'clearance',
]);

/** @typedef {(typeof COLUMNS)[number]} Column */
/** @typedef {Record<Column, number>} Impact states just before the impact, `…_after` just after; NaN for what does not exist */

/** @typedef {(typeof LASTING)[number]} Lasting */

/** Limit of memory, so that a day's run does not grow the page: 65,536 impacts, in 9 MB. */
const KEPT = 1 << 16;

/** @param {string} name */
const kindOf = (name) => (name === 'n' ? Uint32Array : name === 'series' ? Uint8Array : Float64Array);

/** @param {number} room @returns {Record<string, Float64Array | Uint32Array | Uint8Array>} */
const allocate = (room) => Object.fromEntries(COLUMNS.map((name) => [name, new (kindOf(name))(room)]));

export class Impacts {
  /** Counts every impact taken in, forgotten ones included: the place of the next one. */
  end = 0;
  /** Impacts the server skipped over. */
  missing = 0;
  #kept;
  #room = 256;
  #columns = allocate(this.#room);

  /** @param {number} [kept] a power of 4, at least 256 */
  constructor(kept = KEPT) {
    this.#kept = kept;
  }

  /** The first place still in memory. */
  get begin() {
    return Math.max(0, this.end - this.#kept);
  }

  /**
   * NaN where there is none.
   * @param {Column} column
   * @param {number} place from `begin` to `end`
   */
  at(column, place) {
    return this.#columns[column][place % this.#room];
  }

  /**
   * The last place whose value is not beyond this one; `begin` − 1 where there is none. For columns that rise: `n` and `t`.
   * @param {'n' | 't'} column
   * @param {number} value
   */
  lastUpTo(column, value) {
    let [low, high] = [this.begin - 1, this.end - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.at(column, middle) <= value) low = middle;
      else high = middle - 1;
    }
    return low;
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
    if (this.end === this.#room && this.#room < this.#kept) {
      this.#room *= 4;
      const wider = allocate(this.#room);
      for (const name of COLUMNS) wider[name].set(this.#columns[name]);
      this.#columns = wider;
    }
    for (const name of COLUMNS) this.#columns[name][this.end % this.#room] = impact[name];
    this.end += 1;
  }

  clear() {
    this.end = 0;
    this.missing = 0;
  }
}
