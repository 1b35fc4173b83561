// The frame around a chart: title, sentence, picture with a name, readout, table of its numbers.

import { paced } from '../dom/debounce.js';
import { h } from '../dom/elements.js';
import { unbroken } from '../dom/numbers.js';
import { UNITS } from '../dom/units.js';
import { Table } from '../panels/parts.js';
import { html, render } from '../vendor/preact/preact.js';

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
  #numbers = h('details', { toggle: () => this.#fill() }, h('summary', {}, 'Numbers'));
  #table = h('div');
  #columns;
  #rows;
  /** Describes the picture in words. */
  name = paced(PACE_MS, (/** @type {() => string} */ words) => this.box.setAttribute('aria-label', words()));
  /** Brings the table up to date while it is open. */
  list = paced(PACE_MS, () => this.#fill());

  /**
   * @param {string} id
   * @param {string} title
   * @param {string | Node} about one sentence
   * @param {string[]} columns of the table of its numbers
   * @param {(most: number) => (string | number)[][]} rows newest first
   */
  constructor(id, title, about, columns, rows) {
    this.id = id;
    this.title = title;
    this.#columns = columns;
    this.#rows = rows;
    document.addEventListener(UNITS, () => this.#fill());
    this.#numbers.append(this.#table);
    this.#head = h('div', { class: 'card-head' }, h('h3', {}, title));
    this.element = h(
      'figure',
      { class: 'card chart', id },
      h('figcaption', {}, this.#head, h('p', { class: 'muted' }, about)),
      this.box,
      this.#readout,
      this.#numbers,
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
    if (!this.#numbers.open) return;
    const rows = this.#rows(LISTED).map((cells) => html`<tr>${cells.map((cell) => html`<td>${cell}</td>`)}</tr>`);
    const table = html`<${Table} label=${`Numbers: ${this.title}`} head=${this.#columns} children=${rows} />`;
    render(table, this.#table);
  }
}
