// The demand of the run on the table beside its limits, as the server computes it for the run up to now.

import { get } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { row, table } from '../../dom/tables.js';

/** @typedef {import('contract').Trajectory['demand']} Demand */

/** @type {{name: keyof Demand, title: string, unit: string}[]} */
const QUANTITIES = [
  { name: 'tilt', title: 'Tilt', unit: 'rad' },
  { name: 'tilt_rate', title: 'Tilt rate', unit: 'rad/s' },
  { name: 'speed', title: 'Speed', unit: 'm/s' },
  { name: 'stroke', title: 'Stroke', unit: 'm' },
];

/**
 * Rows of the largest values with their limits and shares.
 * @param {Partial<Record<keyof Demand, number | null>>} values
 * @param {Record<string, number | undefined>} limits
 */
export const loadRows = (values, limits) =>
  QUANTITIES.map(({ name, title, unit }) => {
    const [value, limit] = [values[name] ?? null, limits[name] ?? null];
    const share = value === null || !limit ? null : value / limit;
    const line = row(title, [
      quantity(value, unit, 3),
      limit === null ? 'none' : quantity(limit, unit, 3),
      share === null ? '' : `${number(100 * share, 3)}\u202f%`,
    ]);
    line.classList.toggle('beyond', share !== null && share > 1);
    return line;
  });

/** Names of their columns. */
export const LOAD_COLUMNS = ['quantity', 'largest', 'limit', 'share'];

/** While a run goes on, it is asked for anew after so much more of it, and not sooner than, ms. */
const GROWTH = 1.5;
const PACE_MS = 2000;
/** Impacts that it is asked for at most: the answer has them all. */
const MOST = 20_000;

export class TableDemand {
  element;
  #body = h('tbody');
  #told = h('p', { id: 'demand-told', class: 'muted small' });
  #page;
  /** @type {Demand | null} */
  #demand = null;
  /** The request that the shown numbers answer, and the impacts in it. */
  #shown = { query: '', impacts: 0 };
  #asked_ms = -Infinity;
  /** @type {AbortController | null} */
  #request = null;

  /**
   * @param {object} page
   * @param {import('../../run/run.js').Run} page.run
   * @param {() => URLSearchParams | null} page.query of the run with what was done to it
   */
  constructor(page) {
    this.#page = page;
    this.element = h(
      'div',
      { class: 'demand' },
      table('Largest values and limits', LOAD_COLUMNS, this.#body),
      this.#told,
    );
    this.retell();
  }

  /** Shows the same in another unit of angles, or beside other limits. */
  retell() {
    const { run } = this.#page;
    /** @type {Record<string, number | undefined>} */
    const limits = run.asked?.table?.limits ?? {};
    // A strike that a limit forbids is not among the impacts.
    const refused = run.outcome?.kind === 'beyond_limits' ? run.outcome : null;
    const asked = refused?.quantity ? { [refused.quantity]: refused.value } : {};
    this.#body.replaceChildren(...loadRows({ ...this.#demand, ...asked }, limits));
  }

  /** Another run: the numbers are void. */
  clear() {
    this.#request?.abort();
    this.#demand = null;
    this.#shown = { query: '', impacts: 0 };
    this.#asked_ms = -Infinity;
    this.#told.textContent = '';
    this.retell();
  }

  /** Asks for the numbers where they are behind the run. @param {number} now_ms @returns {boolean} true while they are behind */
  follow(now_ms) {
    const { run } = this.#page;
    const impacts = Math.min(MOST, run.impacts.last?.n ?? 0);
    const query = String(this.#page.query() ?? '');
    if (impacts === 0 || query === '') return false;
    const same = query === this.#shown.query;
    if (same && impacts === this.#shown.impacts) return false;
    const soon = same && run.phase === 'running' && impacts < GROWTH * this.#shown.impacts;
    if (soon || this.#request || now_ms - this.#asked_ms < PACE_MS) return true;
    this.#asked_ms = now_ms;
    void this.#ask(query, impacts);
    return true;
  }

  /** @param {string} query @param {number} impacts */
  async #ask(query, impacts) {
    const request = new AbortController();
    this.#request = request;
    const answer = await get(`v1/trajectories?${query}&bounces=${impacts}`, request.signal).catch(() => null);
    if (this.#request !== request) return;
    this.#request = null;
    if (request.signal.aborted || !answer) return;
    this.#demand = answer.demand;
    this.#shown = { query, impacts };
    this.#told.textContent = `Up to bounce ${number(impacts, 8)}.`;
    this.retell();
  }
}
