// The table of the numbers behind a chart.

import { table as numberTable } from '../dom/tables.js';
import { h } from '../dom/elements.js';
import { shownUnit } from '../dom/units.js';

const LISTED = 50;

export class FigureNumbers {
  #table;
  #heads;
  #body = h('tbody');

  /** @param {HTMLElement} place @param {string} title of the chart @param {{head: string[], rows: () => string[][]}} table */
  constructor(place, title, table) {
    this.#table = table;
    this.#heads = table.head.map(() => h('span'));
    place.append(numberTable(`Numbers: ${title}`, this.#heads, this.#body));
  }

  /** Shows the rows of now, in the unit of angles of now. */
  fill() {
    for (const [index, name] of this.#table.head.entries()) this.#heads[index].textContent = shownUnit(name);
    this.#body.replaceChildren(
      ...this.#table
        .rows()
        .slice(0, LISTED)
        .map((cells) => h('tr', {}, ...cells.map((cell) => h('td', {}, cell)))),
    );
  }
}
