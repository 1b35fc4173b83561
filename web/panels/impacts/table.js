// The newest impacts of the run as a table: rows are added as the run goes on, and can be copied.

import { copy } from '../../dom/clipboard.js';
import { h } from '../../dom/elements.js';
import { fixed, fixedIn } from '../../dom/numbers.js';
import { table } from '../../dom/tables.js';

/** @typedef {import('../../run/impacts.js').Column} Column */

/** Rows that are kept. */
const LISTED = 200;

/** Columns with their names, units and decimals. @type {{column: Column, name: string, unit: string | null, decimals: number}[]} */
const COLUMNS = [
  { column: 'n', name: 'n', unit: null, decimals: 0 },
  { column: 't', name: 't / s', unit: 's', decimals: 4 },
  { column: 'x', name: 'x / m', unit: 'm', decimals: 4 },
  { column: 'theta', name: 'θ / rad', unit: 'rad', decimals: 4 },
  { column: 'x_dot', name: 'ẋ / m s⁻¹', unit: 'm/s', decimals: 4 },
  { column: 'y_dot', name: 'ẏ / m s⁻¹', unit: 'm/s', decimals: 4 },
  { column: 'theta_dot', name: 'θ̇ / rad s⁻¹', unit: 'rad/s', decimals: 4 },
  { column: 'alpha', name: 'α / rad', unit: 'rad', decimals: 4 },
  { column: 'table_speed', name: 'table / m s⁻¹', unit: 'm/s', decimals: 4 },
  { column: 'contact_velocity', name: 'contact / m s⁻¹', unit: 'm/s', decimals: 4 },
  { column: 'flight_time', name: 'flight / s', unit: 's', decimals: 4 },
  { column: 'energy', name: 'E/m / J kg⁻¹', unit: null, decimals: 4 },
];

export class ImpactTable {
  element;
  #body = h('tbody');
  #impacts;
  /** Places of the newest row and of the row after the oldest; none before the first. */
  #newest = -1;

  /** @param {import('../../run/impacts.js').Impacts} impacts */
  constructor(impacts) {
    this.#impacts = impacts;
    this.element = table(
      'Impacts of this run, the newest first',
      COLUMNS.map(({ name }) => name),
      this.#body,
    );
  }

  /** The first place that has a row. */
  get #oldest() {
    return Math.max(this.#impacts.begin, this.#impacts.end - LISTED);
  }

  /** Forgets all rows, for another run or another unit. */
  clear() {
    this.#newest = -1;
    this.#body.replaceChildren();
  }

  /** Adds the rows of new impacts and drops the oldest. */
  fill() {
    const { end } = this.#impacts;
    if (end - 1 < this.#newest) this.clear();
    const rows = [];
    for (let place = end - 1; place > this.#newest && place >= this.#oldest; place -= 1) rows.push(this.#row(place));
    this.#newest = end - 1;
    this.#body.prepend(...rows);
    while (this.#body.childElementCount > LISTED) this.#body.lastElementChild?.remove();
  }

  /** @param {number} place */
  #row(place) {
    const impacts = this.#impacts;
    return h(
      'tr',
      {},
      ...COLUMNS.map(({ column, unit, decimals }) => {
        const value = impacts.at(column, place);
        return h('td', {}, unit ? fixedIn(value, unit, decimals) : fixed(value, decimals));
      }),
    );
  }

  /** Copies the rows, in SI units with all digits, parted by tabs as spreadsheets take them. @param {HTMLElement} button */
  copy(button) {
    const lines = [COLUMNS.map(({ name }) => name).join('\t')];
    for (let place = this.#impacts.end - 1; place >= this.#oldest; place -= 1)
      lines.push(
        COLUMNS.map(({ column }) => {
          const value = this.#impacts.at(column, place);
          return Number.isFinite(value) ? String(value) : '';
        }).join('\t'),
      );
    return copy(button, lines.join('\n'));
  }

  /** The rows in words. */
  get words() {
    const { end } = this.#impacts;
    const count = end - this.#oldest;
    return count < end ? `The last ${count} of ${fixed(end, 0)} impacts.` : '';
  }
}
