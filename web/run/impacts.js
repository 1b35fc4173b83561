// The impacts of a run in columns; the newest of them are kept.

/** The columns that charts show; they are kept for long. */
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
  'contact_speed',
  'table_speed',
  'mode',
  'clearance',
]);

/** @typedef {(typeof COLUMNS)[number]} Column */
/** @typedef {Record<Column, number>} Impact states just before the impact, `…_after` just after; NaN for what does not exist */

/** @typedef {(typeof LASTING)[number]} Lasting */

// Limits of memory, so that a day's run does not grow the page: 65,536 impacts with the columns of charts (4 MB), and all columns
// of the newest 1,024.
const KEPT = 1 << 16;
const NEWEST = 1 << 10;

/** @param {readonly string[]} names @param {number} room */
const allocate = (names, room) =>
  Object.fromEntries(
    names.map((name) => [
      name,
      name === 'n' ? new Uint32Array(room) : name === 'series' ? new Uint8Array(room) : new Float64Array(room),
    ]),
  );

export class Impacts {
  /** Counts every impact taken in, forgotten ones included: the place of the next one. */
  end = 0;
  /** Impacts the server skipped over. */
  missing = 0;
  #kept;
  #room = 256;
  /** @type {Record<string, Float64Array | Uint32Array | Uint8Array>} */
  #lasting = allocate(LASTING, this.#room);
  #newest = allocate(
    COLUMNS.filter((name) => !LASTING.some((one) => one === name)),
    NEWEST,
  );

  /** @param {number} [kept] a power of 4, at least 256 */
  constructor(kept = KEPT) {
    this.#kept = kept;
  }

  /** The first place still in memory. */
  get begin() {
    return Math.max(0, this.end - this.#kept);
  }

  /**
   * NaN where there is none, or none any more.
   * @param {Column} column
   * @param {number} place from `begin` to `end`
   */
  at(column, place) {
    const lasting = this.#lasting[column];
    if (lasting) return lasting[place % this.#room];
    return place >= this.end - NEWEST ? this.#newest[column][place % NEWEST] : NaN;
  }

  /** All that is kept of a column, for those who read much of it: a place is its index, less whole lengths. @param {Lasting} column */
  column(column) {
    return this.#lasting[column];
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
      const wider = allocate(LASTING, this.#room);
      for (const name of LASTING) wider[name].set(this.#lasting[name]);
      this.#lasting = wider;
    }
    for (const name of COLUMNS) {
      if (name in this.#lasting) this.#lasting[name][this.end % this.#room] = impact[name];
      else this.#newest[name][this.end % NEWEST] = impact[name];
    }
    this.end += 1;
  }

  clear() {
    this.end = 0;
    this.missing = 0;
  }
}
