// The frame around a chart: title, sentence, picture with a name, readout, table of its numbers.

import { table as numberTable } from '../dom/tables.js';
import { enlarger } from '../export/enlarge-button.js';
import { h } from '../dom/elements.js';
import { unbroken } from '../dom/numbers.js';
import { UNITS, shownUnit } from '../dom/units.js';

/**
 * @typedef {object} Table the numbers behind a picture
 * @property {string[]} head
 * @property {() => string[][]} rows newest first
 */

const LISTED = 50;

export class Figure {
  element;
  /** The box of the canvases. */
  box;
  #head;
  #readout;
  #table;
  #body;
  #disclosure;
  #named_ms = -Infinity;
  #listed_ms = -Infinity;

  /**
   * @param {string} id
   * @param {string} title
   * @param {string | Node} about one sentence
   * @param {Table} table
   */
  constructor(id, title, about, table) {
    this.id = id;
    this.title = title;
    this.#table = table;
    this.box = h('div', { class: 'canvas-box', role: 'img', 'aria-label': 'Nothing to show yet' });
    this.#readout = h('output', { class: 'readout', 'aria-live': 'off' });
    this.#body = h('tbody');
    const heads = table.head.map((name) => h('span', {}, shownUnit(name)));
    document.addEventListener(UNITS, () => {
      for (const [index, name] of table.head.entries()) heads[index].textContent = shownUnit(name);
      this.#named_ms = -Infinity;
      this.#listed_ms = -Infinity;
      this.list(Infinity);
    });
    this.#disclosure = h(
      'details',
      { toggle: () => this.list(Infinity) },
      h('summary', {}, 'Numbers'),
      numberTable(`Numbers: ${title}`, heads, this.#body),
    );
    this.#head = h('div', { class: 'card-head' }, h('h3', {}, title));
    this.element = h(
      'figure',
      { class: 'card chart', id },
      h('figcaption', {}, this.#head, h('p', { class: 'muted' }, about)),
      this.box,
      this.#readout,
      this.#disclosure,
    );
  }

  /** Offers to save and to enlarge it. @param {() => import('../export/save-actions.js').Saves} saves */
  offer(saves) {
    this.#head.append(enlarger(this.element, this.title, saves));
  }

  /** @param {string} text */
  read(text) {
    this.#readout.textContent = unbroken(text);
  }

  /**
   * Describes the picture in words, at most once a second.
   * @param {number} now_ms
   * @param {() => string} words
   */
  name(now_ms, words) {
    if (now_ms - this.#named_ms < 1000) return;
    this.#named_ms = now_ms;
    this.box.setAttribute('aria-label', words());
  }

  /** Brings the table up to date when it is open, at most once a second. @param {number} now_ms */
  list(now_ms) {
    if (!this.#disclosure.open || now_ms - this.#listed_ms < 1000) return;
    this.#listed_ms = now_ms === Infinity ? -Infinity : now_ms;
    this.#body.replaceChildren(
      ...this.#table
        .rows()
        .slice(0, LISTED)
        .map((cells) => h('tr', {}, ...cells.map((cell) => h('td', {}, cell)))),
    );
  }
}
