// The settings of a catch: how the table moves, and the numbers that this way has.

import { h } from '../../dom/elements.js';
import { numberInput } from '../../dom/number-input.js';
import { number } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { inWords } from '../../dom/typeset.js';

/** The strategies by their names in requests; without one the server chooses. */
export const STRATEGIES = { '': 'Choose for me', bounce_down: 'Bounce down', plan: 'Plan', brake: 'Brake' };

/** @typedef {{name: string, label: string, unit: string, hint: string, of: (keyof typeof STRATEGIES)[]}} Setting */

/** The numbers, with the strategies that have them. @type {Setting[]} */
const NUMBERS = [
  { name: 'ratio', label: 'Ratio of speeds', unit: '1', hint: '0.5', of: ['bounce_down'] },
  { name: 'ratio', label: 'Ratio of speeds', unit: '1', hint: '0.8', of: ['plan'] },
  { name: 'strikes', label: 'Strikes before the stop', unit: '1', hint: '8', of: ['plan'] },
  { name: 'brake', label: 'Deceleration', unit: 'm/s²', hint: 'gravity', of: ['brake'] },
  { name: 'hold', label: 'Hold for', unit: 's', hint: '6', of: ['', 'bounce_down', 'plan', 'brake'] },
];

/** Names of the numbers, each once. */
const NAMES = [...new Set(NUMBERS.map(({ name }) => name))];

export class CatchSettings {
  element;
  #key;
  #strategy;
  /** @type {Map<string, {input: HTMLInputElement, row: HTMLElement, error: HTMLElement, label: HTMLElement}>} */
  #rows = new Map();

  /**
   * @param {() => void} changed
   * @param {{id: string, key: string, automatic: boolean}} [place] beginning of its ids and of its keys in the address; true where the server may choose
   */
  constructor(changed, { id, key, automatic } = { id: 'catch', key: 'catch.', automatic: true }) {
    this.#key = key;
    const turned = () => {
      this.#show();
      changed();
    };
    this.#strategy = h(
      'select',
      { id: `${id}-strategy`, change: turned },
      ...Object.entries(STRATEGIES)
        .filter(([value]) => automatic || value)
        .map(([value, words]) => h('option', { value }, words)),
    );
    for (const name of NAMES) {
      const { unit } = /** @type {Setting} */ (NUMBERS.find((one) => one.name === name));
      const error = h('p', { class: 'error', id: `${id}-${name}-error` });
      const input = numberInput({ id: `${id}-${name}`, change: changed }, error, { unit, open: true });
      const label = h('label', { for: input.id });
      const row = h(
        'div',
        { class: 'study-row' },
        label,
        input,
        unit !== '1' && h('span', { class: 'unit' }, unit),
        error,
      );
      this.#rows.set(name, { input, row, error, label });
    }
    this.element = h(
      'fieldset',
      { class: 'study-settings' },
      h('legend', {}, 'How'),
      h('div', { class: 'study-row' }, h('label', { for: this.#strategy.id }, 'Strategy'), this.#strategy),
      ...[...this.#rows.values()].map(({ row }) => row),
    );
    this.#show();
  }

  /** The numbers of the chosen strategy. */
  get #numbers() {
    const chosen = /** @type {keyof typeof STRATEGIES} */ (this.#strategy.value);
    return NUMBERS.filter(({ of }) => of.includes(chosen));
  }

  #show() {
    for (const [name, { row, input, label }] of this.#rows) {
      const setting = this.#numbers.find((one) => one.name === name);
      row.hidden = !setting;
      if (!setting) continue;
      label.textContent = setting.label;
      input.placeholder = setting.hint;
    }
    this.blame([]);
  }

  /** The settings of a request or a message. @returns {Record<string, string | number>} */
  read() {
    /** @type {Record<string, string | number>} */
    const settings = this.#strategy.value ? { strategy: this.#strategy.value } : {};
    for (const { name, unit } of this.#numbers) {
      const value = parse(this.#rows.get(name)?.input.value ?? '', unit);
      if (value !== null) settings[name] = value;
    }
    // The server judges anew.
    this.blame([]);
    return settings;
  }

  /** Marks the fields that errors are about. @param {import('contract').ProblemError[]} errors @returns {string[]} what the others say */
  blame(errors) {
    /** @type {string[]} */
    const elsewhere = [];
    for (const { input, error } of this.#rows.values()) {
      if (!input.hasAttribute('aria-invalid')) continue;
      input.removeAttribute('aria-invalid');
      error.textContent = '';
    }
    /** @type {HTMLElement | null} */
    let first = null;
    for (const { pointer, detail } of errors) {
      const row = this.#rows.get(pointer.slice(1));
      if (!row || row.row.hidden) {
        elsewhere.push(detail);
        continue;
      }
      row.input.setAttribute('aria-invalid', 'true');
      row.error.textContent = inWords(detail);
      first ??= row.input;
    }
    first?.focus();
    return elsewhere;
  }

  /** Part of the page’s address. */
  query() {
    const query = new URLSearchParams();
    if (this.#strategy.value) query.set(`${this.#key}strategy`, this.#strategy.value);
    for (const { name } of this.#numbers) {
      const text = this.#rows.get(name)?.input.value.trim();
      if (text) query.set(this.#key + name, text);
    }
    return query;
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped */
  restore(link) {
    const dropped = [];
    const strategy = link.get(`${this.#key}strategy`) ?? '';
    const [usual] = this.#strategy.options;
    this.#strategy.value = strategy in STRATEGIES && strategy ? strategy : usual.value;
    if (!(strategy in STRATEGIES)) dropped.push(`the strategy “${strategy.slice(0, 40)}”`);
    for (const [name, { input }] of this.#rows) {
      const text = link.get(this.#key + name) ?? '';
      const right = text === '' || parse(text, null) !== null;
      if (!right) dropped.push(`${name} of the catch “${text.slice(0, 40)}”, which is not a number`);
      input.value = right ? text : '';
    }
    this.#show();
    return dropped;
  }
}

/** A strategy with its numbers. @param {Pick<import('contract').CatchUsed, 'strategy' | 'ratio' | 'strikes' | 'brake'>} used */
export function described({ strategy, ratio, strikes, brake }) {
  const numbers = [
    strikes === null ? '' : `${strikes} strikes`,
    ratio === null ? '' : `ratio ${number(ratio)}`,
    brake === null ? '' : `${number(brake)}\u202fm/s²`,
  ].filter(Boolean);
  return `${STRATEGIES[strategy]}, ${numbers.join(' of ')}`;
}
