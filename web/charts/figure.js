// The frame around a chart: title, sentence, picture with a name, readout, table of its numbers.

import { h } from '../dom/elements.js';
import { unbroken } from '../dom/numbers.js';
import { UNITS } from '../dom/units.js';

/**
 * @typedef {object} Table the numbers behind a picture
 * @property {string[]} head
 * @property {() => string[][]} rows newest first
 */

/** Does something at most once a second. The newest call of a second comes at its end, so that none is the last and lost. */
class EverySecond {
  #done_ms = -Infinity;
  #later = 0;

  /** @param {number} now_ms Infinity: at once @param {() => void} act */
  ask(now_ms, act) {
    clearTimeout(this.#later);
    const left = this.#done_ms + 1000 - now_ms;
    if (left > 0) {
      this.#later = setTimeout(() => this.ask(now_ms + left, act), left);
      return;
    }
    this.#done_ms = now_ms === Infinity ? -Infinity : now_ms;
    act();
  }

  /** Lets the next call act at once. */
  free() {
    this.#done_ms = -Infinity;
  }
}

export class Figure {
  element;
  /** The box of the canvases. */
  box;
  #head;
  #readout;
  #table;
  /** The table, once it was opened. @type {import('./figure-numbers.js').FigureNumbers | null} */
  #numbers = null;
  #disclosure;
  #naming = new EverySecond();
  #listing = new EverySecond();

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
    document.addEventListener(UNITS, () => {
      this.#naming.free();
      this.list(Infinity);
    });
    this.#disclosure = h('details', { toggle: () => void this.#open() }, h('summary', {}, 'Numbers'));
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

  /** Fills the table, which loads when it is opened for the first time. */
  async #open() {
    const late = await import('./figure-numbers.js').catch(() => null);
    if (!late) return;
    this.#numbers ??= new late.FigureNumbers(this.#disclosure, this.title, this.#table);
    this.list(Infinity);
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
    this.#naming.ask(now_ms, () => this.box.setAttribute('aria-label', words()));
  }

  /** Brings the table up to date when it is open, at most once a second. @param {number} now_ms */
  list(now_ms) {
    if (this.#disclosure.open) this.#listing.ask(now_ms, () => this.#numbers?.fill());
  }
}
