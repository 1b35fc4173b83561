// The measured columns with their standard deviations: typed where they are known, else estimated by the fit.

import { SYMBOLS } from '../measured/compare.js';
import { h } from '../../dom/elements.js';
import { numberInput } from '../../dom/number-input.js';
import { number } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { shownUnit } from '../../dom/units.js';
import { symbol } from '../../dom/typeset.js';
import { inputText } from './fields.js';

/** @typedef {keyof typeof SYMBOLS} Column */
/** @typedef {import('../measured/read.js').Measured} Measured */

/** The columns that a fit takes, besides n. */
export const COLUMNS = /** @type {Column[]} */ (['t', 'theta', 'x_dot', 'y_dot', 'theta_dot', 'x']);
/** The server's limits, in the unit of the column. */
const [LEAST, GREATEST] = [1e-9, 1e3];

/** A column with its standard deviation. */
class Deviation {
  element;
  input;
  /** As typed, in SI units; undefined to estimate it. @type {number | undefined} */
  typed;
  #unit = h('span', { class: 'unit' });
  #count = h('span', { class: 'muted' });
  #error;
  #column;

  /** @param {Column} column @param {() => void} changed */
  constructor(column, changed) {
    this.#column = column;
    const [sign, unit] = SYMBOLS[column];
    const id = `fit-sd-${column}`;
    this.#error = h('p', { class: 'error', id: `${id}-error` });
    this.input = numberInput(
      {
        id,
        placeholder: 'estimated',
        change: () => {
          this.typed = parse(this.input.value, unit) ?? undefined;
          changed();
        },
      },
      this.#error,
      {
        unit,
        open: true,
        fault: (value) =>
          value >= LEAST && value <= GREATEST ? null : 'It must be a number above 0, or empty to estimate it.',
      },
    );
    this.element = h(
      'li',
      { class: 'fit-field', hidden: true },
      h('label', { for: id }, 'of ', symbol(sign)),
      h('span', { class: 'fit-value' }, this.input, this.#unit),
      this.#count,
      this.#error,
    );
  }

  /** @param {number} count of the measured values @param {boolean} anew in another unit too */
  show(count, anew) {
    const [, unit] = SYMBOLS[this.#column];
    this.element.hidden = count === 0;
    this.#count.textContent = `${number(count, 7)} values`;
    this.#unit.textContent = shownUnit(unit);
    if (anew && this.typed !== undefined) this.input.value = inputText(this.typed, unit);
    if (anew && this.typed === undefined) this.input.value = '';
  }

  /** @param {string} words */
  blame(words) {
    this.#error.textContent = words;
    this.input.setAttribute('aria-invalid', String(words !== ''));
  }
}

export class Deviations {
  /** @type {Map<Column, Deviation>} */
  #all = new Map();
  /** @type {Map<Column, number>} */
  #counts = new Map();
  #none = h('p', { class: 'muted small' }, 'The columns of the data appear here.');
  #hint = h(
    'p',
    { class: 'muted small' },
    'Give those that you know. Only if all are given can χ² say that the model is wrong.',
  );
  element;

  /** @param {() => void} changed */
  constructor(changed) {
    for (const column of COLUMNS) this.#all.set(column, new Deviation(column, changed));
    this.element = h(
      'fieldset',
      { class: 'fit-deviations' },
      h('legend', {}, 'Standard deviations of the data'),
      this.#none,
      h('ul', { class: 'fit-fields' }, ...[...this.#all.values()].map(({ element }) => element)),
      this.#hint,
    );
    this.take([]);
  }

  /** Shows the columns of these impacts. @param {Measured[]} impacts */
  take(impacts) {
    for (const column of COLUMNS)
      this.#counts.set(column, impacts.filter((one) => Number.isFinite(one[column])).length);
    this.#none.hidden = impacts.length > 0;
    this.#hint.hidden = impacts.length === 0;
    this.show();
  }

  /** @param {boolean} [anew] in another unit too */
  show(anew = false) {
    for (const [column, one] of this.#all) one.show(this.#counts.get(column) ?? 0, anew);
  }

  /** The standard deviations given for measured columns. */
  read() {
    this.clear();
    /** @type {Partial<Record<Column, number>>} */
    const given = {};
    for (const [column, { typed }] of this.#all)
      if (this.#counts.get(column) && typed !== undefined) given[column] = typed;
    return given;
  }

  clear() {
    for (const one of this.#all.values()) one.blame('');
  }

  /** Marks the columns that the server blames. @param {import('contract').ProblemError[]} errors @param {(row: number) => string} named @returns {import('contract').ProblemError[]} the others */
  blame(errors, named) {
    /** @type {Map<Deviation, string[]>} */
    const words = new Map();
    const others = errors.filter(({ pointer, detail }) => {
      const [, column, row] = /^\/(?:measured|sd)\/(\w+)(?:\/(\d+))?/.exec(pointer) ?? [];
      const one = this.#all.get(/** @type {Column} */ (column));
      if (!one || one.element.hidden) return true;
      const told = words.get(one) ?? [];
      told.push(row === undefined ? detail : `${named(Number(row))}: ${detail}`);
      words.set(one, told);
      return false;
    });
    for (const [one, [first, ...more]] of words)
      one.blame(`${first}${more.length > 0 ? ` And ${number(more.length)} more.` : ''}`);
    return others;
  }

  /** The part of the address. */
  query() {
    return new URLSearchParams(
      [...this.#all]
        .filter(([, { typed }]) => typed !== undefined)
        .map(([column, { typed }]) => [`fit.sd.${column}`, String(typed)]),
    );
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped of it */
  restore(link) {
    const dropped = [];
    for (const [column, one] of this.#all) {
      const text = link.get(`fit.sd.${column}`);
      const value = text === null || text.trim() === '' ? NaN : Number(text);
      one.typed = value >= LEAST && value <= GREATEST ? value : undefined;
      if (text !== null && one.typed === undefined)
        dropped.push(`the standard deviation “${text.slice(0, 40)}”, which is not a number above 0`);
    }
    this.show(true);
    return dropped;
  }
}
