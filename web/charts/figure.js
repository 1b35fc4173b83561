// The frame around a chart: title, sentence, picture with a name, readout, table of its numbers.

import { paced } from '../dom/debounce.js';
import { h } from '../dom/elements.js';
import { unbroken } from '../dom/numbers.js';
import { table as numberTable } from '../dom/tables.js';
import { UNITS } from '../dom/units.js';

/**
 * @typedef {object} Table the numbers behind a picture
 * @property {string[]} head
 * @property {(most: number) => string[][]} rows newest first
 */

/** Rows that a table lists. */
const LISTED = 50;

/** The picture's name and its table change at most so often, ms. */
const PACE_MS = 1000;

export class Figure {
  element;
  /** The box of the canvases. */
  box = h('div', { class: 'canvas-box', role: 'img', 'aria-label': 'Nothing to show yet' });
  #head;
  #readout = h('output', { class: 'readout', 'aria-live': 'off' });
  #table;
  #body = h('tbody');
  #disclosure;
  /** Describes the picture in words. */
  name = paced(PACE_MS, (/** @type {() => string} */ words) => this.box.setAttribute('aria-label', words()));
  /** Brings the table up to date while it is open. */
  list = paced(PACE_MS, () => this.#fill());

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
    document.addEventListener(UNITS, () => this.#fill());
    this.#disclosure = h(
      'details',
      { toggle: () => this.#fill() },
      h('summary', {}, 'Numbers'),
      numberTable(`Numbers: ${title}`, table.head, this.#body),
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

  /** Adds a button to its head. @param {HTMLElement} button */
  offer(button) {
    this.#head.append(button);
  }

  /** @param {string} text */
  read(text) {
    this.#readout.textContent = unbroken(text);
  }

  #fill() {
    if (!this.#disclosure.open) return;
    this.#body.replaceChildren(
      ...this.#table.rows(LISTED).map((cells) => h('tr', {}, ...cells.map((cell) => h('td', {}, cell)))),
    );
  }
}
