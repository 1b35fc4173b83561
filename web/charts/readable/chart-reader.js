// Reads a chart by pointer and keys: the box of the chart, the values in words below it, and the same spoken.

import { h } from '../../dom/elements.js';
import { unbroken } from '../../dom/numbers.js';

/** Items that keys go in a row of many. @type {Record<string, number | undefined>} */
export const KEY_STEPS = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: 10,
  PageDown: -10,
  Home: -Infinity,
  End: Infinity,
};

/**
 * @typedef {object} Readable
 * @property {(event: PointerEvent) => number | null} nearest the item at a place on the screen
 * @property {(key: string, at: number | null) => number | null | undefined} moved the item that a key leads to; undefined for other keys
 * @property {(item: number | null) => void} mark
 * @property {(item: number) => string} words
 */

/**
 * The item that a key leads to among items in a row: arrows go one on, page up and page down a tenth.
 * @param {string} key
 * @param {number | null} at
 * @param {number} first
 * @param {number} last
 * @returns {number | null | undefined}
 */
export function movedInRow(key, at, first, last) {
  const tenth = Math.max(1, Math.round((last - first + 1) / 10));
  const by = (/** @type {number} */ step) =>
    Math.max(first, Math.min(last, (at ?? (step > 0 ? first - 1 : last + 1)) + step));
  return {
    ArrowRight: by(1),
    ArrowLeft: by(-1),
    PageUp: by(tenth),
    PageDown: by(-tenth),
    Home: first,
    End: last,
    Escape: null,
  }[key];
}

export class ChartReader {
  box;
  readout;
  // Speaks when keys move, but not while a pointer goes over the chart.
  spoken = h('p', { class: 'unseen', role: 'status' });
  /** @type {number | null} */
  #at = null;
  /** @type {Readable | null} */
  #chart = null;

  /** @param {string} name its class, and the beginning of its ids @param {string} label */
  constructor(name, label) {
    this.box = h('div', {
      class: `${name}-box`,
      id: `${name}-box`,
      tabindex: 0,
      role: 'application',
      'aria-roledescription': 'chart',
      'aria-label': label,
      'aria-describedby': `${name}-hint`,
    });
    this.readout = h('output', { class: 'readout', id: `${name}-readout`, 'aria-live': 'off' });
  }

  /** @param {Readable} chart */
  read(chart) {
    this.#chart = chart;
    this.box.addEventListener('pointermove', (event) => this.point(chart.nearest(event), false));
    this.box.addEventListener('pointerleave', () => this.point(null, false));
    this.box.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const item = chart.moved(event.key, this.#at);
      if (item === undefined) return;
      event.preventDefault();
      this.point(item, true);
    });
  }

  /** @param {number | null} item @param {boolean} byKey */
  point(item, byKey) {
    this.#at = item;
    this.#chart?.mark(item);
    const words = item === null ? '' : (this.#chart?.words(item) ?? '');
    this.readout.textContent = unbroken(words);
    if (byKey) this.spoken.textContent = words;
  }
}
