// The columns of a file, each with what it is taken for, which the reader may correct.

import { h } from '../../dom/elements.js';
import { table } from '../../dom/tables.js';
import { QUANTITIES, unitsOf } from './read.js';

/** @typedef {import('./read.js').Head} Head */
/** @typedef {import('./read.js').Picks} Picks */
/** @typedef {import('./read.js').Quantity} Quantity */

/** @type {Record<Quantity, string>} */
const NAMES = {
  n: 'n, number of the bounce',
  t: 't, time',
  theta: 'θ, angle',
  x_dot: 'ẋ, velocity across',
  y_dot: 'ẏ, velocity upwards',
  theta_dot: 'θ̇, angular velocity',
  x: 'x, place across',
};
/** Columns beyond these are no table of impacts. */
const MOST = 40;

export class ColumnPicker {
  #body = h('tbody');
  #summary = h('summary');
  #unused;
  element;
  #picked;

  /** @param {string} name the beginning of its ids @param {(picks: Picks) => void} picked the reader says what the columns are */
  constructor(name, picked) {
    this.#picked = picked;
    this.#unused = h('p', { class: 'muted', id: `${name}-unused` });
    this.element = h(
      'details',
      { class: 'measured-columns', id: `${name}-columns`, hidden: true },
      this.#summary,
      table('Columns of the file', ['Column', 'is', 'in'], this.#body),
      this.#unused,
    );
  }

  /** @param {Head[]} heads @param {string} unused in words */
  show(heads, unused) {
    const used = heads.filter(({ quantity }) => quantity !== null).length;
    this.element.hidden = heads.length === 0;
    this.#summary.textContent = `Columns: ${used} used, ${heads.length - used} not used`;
    this.#unused.textContent = unused;
    const rows = heads.slice(0, MOST).map(({ head, quantity, unit }, place) => {
      const label = head || `column ${place + 1}`;
      const choice = h(
        'select',
        { 'aria-label': `${label}: is`, 'data-place': place, change: () => this.#changed(heads, rows) },
        h('option', { value: '' }, 'not used'),
        ...QUANTITIES.map((name) => h('option', { value: name, selected: name === quantity }, NAMES[name])),
      );
      const units = quantity && quantity !== 'n' ? unitsOf(quantity) : [];
      const scale = h(
        'select',
        { 'aria-label': `${label}: unit`, disabled: units.length === 0, change: () => this.#changed(heads, rows) },
        ...units.map((name, index) =>
          h('option', { value: name, selected: unit === name || (index === 0 && !units.includes(unit)) }, name),
        ),
      );
      return {
        row: h('tr', {}, h('th', { scope: 'row' }, label), h('td', {}, choice), h('td', {}, scale)),
        choice,
        scale,
      };
    });
    this.#body.replaceChildren(...rows.map(({ row }) => row));
  }

  /** @param {Head[]} heads @param {{choice: HTMLSelectElement, scale: HTMLSelectElement}[]} rows */
  #changed(heads, rows) {
    /** @type {Picks} */
    const picks = new Map();
    const focused = document.activeElement?.getAttribute('aria-label');
    for (const [place, { choice, scale }] of rows.entries()) {
      const quantity = /** @type {Quantity | ''} */ (choice.value) || null;
      // A column that is taken for something else begins in the unit of SI.
      const unit = quantity === heads[place].quantity ? scale.value : quantity ? unitsOf(quantity)[0] : '';
      picks.set(place, { quantity, unit: quantity === 'n' ? '' : unit });
    }
    this.#picked(picks);
    /** @type {HTMLElement | null} */
    const again = this.element.querySelector(`[aria-label="${CSS.escape(focused ?? '')}"]`);
    again?.focus();
  }
}
