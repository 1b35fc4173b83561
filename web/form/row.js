// A row of the settings: a field with its label, its help, its error, and the way back to the case. Kinds of fields extend it.

import { same } from '../api/scene-fields.js';
import { h } from '../dom/elements.js';
import { number, quantity } from '../dom/numbers.js';
import { inWords, symbol } from '../dom/typeset.js';
import { shownUnit, shownValue } from '../dom/units.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */

/**
 * The form around a row.
 * @typedef {object} Host
 * @property {(path: string, final: boolean) => void} edited
 * @property {(field: Field) => boolean} needs true when the field has to have a value in the scene as it is typed
 * @property {(words: string) => void} tell says something politely
 */

export class Row {
  field;
  host;
  id;
  /** The last value that was one; undefined for a field that is not set. @type {unknown} */
  value;
  /** The fault of the text that stands in the field. @type {string | null} */
  problem = null;
  /** The value in the case; undefined where it has none. @type {unknown} */
  base;
  /** True while there is a case to differ from. */
  comparable = false;
  /** @type {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} */
  input;
  label;
  error;
  element;
  head;
  #reset;
  #help;
  #unit;

  /**
   * @param {Field} field
   * @param {Host} host
   * @param {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} input
   */
  constructor(field, host, input) {
    this.field = field;
    this.host = host;
    this.input = input;
    this.id = idOf(field);
    input.id = this.id;
    input.setAttribute('aria-describedby', `${this.id}-help ${this.id}-error`);
    this.error = h('p', { class: 'error', id: `${this.id}-error` });
    this.label = h(
      'label',
      { for: this.id },
      field.title,
      field.symbol && ' ',
      field.symbol ? symbol(field.symbol) : null,
    );
    this.#unit = h('span', { class: 'unit' });
    this.#reset = h('button', { type: 'button', class: 'reset icon', hidden: true }, '↺');
    this.#reset.addEventListener('click', () => {
      this.reset();
      // The button is gone now.
      this.input.focus();
    });
    this.#help = h('p', { class: 'field-help', id: `${this.id}-help`, hidden: true });
    const about = h(
      'button',
      {
        type: 'button',
        class: 'icon help',
        'aria-expanded': 'false',
        'aria-controls': `${this.id}-help`,
        'aria-label': `About ${field.title}`,
      },
      '?',
    );
    about.addEventListener('click', () => {
      this.#help.hidden = !this.#help.hidden;
      about.setAttribute('aria-expanded', String(!this.#help.hidden));
    });
    this.head = h(
      'div',
      { class: 'field-head' },
      this.label,
      this.#unit,
      h('span', { class: 'gap' }),
      this.#reset,
      about,
    );
    this.element = h('div', { class: `field ${field.kind}` }, this.head, this.#help, this.error);
    this.describe();
  }

  /** Writes unit and help, in the unit of angles that the page shows. */
  describe() {
    const { unit } = this.field;
    this.#unit.textContent = unit === '1' || unit === null ? '' : shownUnit(unit);
    this.#help.replaceChildren(this.helpWords().join(' '));
  }

  /** The limits with the unit; '' for a field without them. */
  get limits() {
    const { minimum, maximum, unit } = this.field;
    return minimum == null || maximum == null
      ? ''
      : `${number(shownValue(minimum, unit))} to ${quantity(maximum, unit)}`;
  }

  /** The fault of an empty field. */
  get missing() {
    return `${this.field.title} is needed${this.limits && `: ${this.limits}`}.`;
  }

  /** Sentences of the help. */
  helpWords() {
    const { about, live, unit, default: usual } = this.field;
    const { limits } = this;
    const words = about === '' ? [] : [inWords(about.endsWith('.') ? about : `${about}.`)];
    if (limits !== '') words.push(`Allowed: ${limits}.`);
    if (usual != null && typeof usual === 'number') words.push(`Usually ${quantity(usual, unit)}.`);
    words.push(live ? 'Acts on a run from its next bounce.' : 'Acts when the run is restarted.');
    return words;
  }

  /**
   * @param {string | null} problem
   * @param {boolean} [wrong] false for a remark on a value that is right
   */
  say(problem, wrong = true) {
    if (problem !== null && wrong) this.input.setAttribute('aria-invalid', 'true');
    else this.input.removeAttribute('aria-invalid');
    this.error.classList.toggle('remark', !wrong);
    this.error.textContent = problem ?? '';
  }

  /** The value, and the reason why it is none. @returns {{value: unknown, problem: string | null}} */
  read() {
    if (this.input.disabled) return { value: undefined, problem: null };
    if (this.problem === null && this.value === undefined && this.host.needs(this.field))
      return { value: undefined, problem: this.missing };
    return { value: this.value, problem: this.problem };
  }

  /** Takes a value from elsewhere. @param {unknown} value */
  fill(value) {
    this.value = value === this.field.default ? undefined : (value ?? undefined);
    this.problem = null;
    this.say(null);
    this.show();
    this.compare();
  }

  /** Shows the value in the control. */
  show() {}

  /** Sets the value as a reader would. @param {unknown} value @param {boolean} final */
  set(value, final) {
    this.fill(value);
    this.host.edited(this.field.field, final);
  }

  /** Takes a value that was typed or chosen in the control. @param {unknown} value @param {boolean} final */
  take(value, final) {
    this.value = value;
    this.problem = null;
    this.say(null);
    this.compare();
    this.host.edited(this.field.field, final);
  }

  /** @param {unknown} base value of the field in the case @param {boolean} comparable */
  against(base, comparable) {
    this.base = base ?? undefined;
    this.comparable = comparable;
    this.compare();
  }

  get differs() {
    const usual = this.field.default ?? undefined;
    return this.comparable && !this.input.disabled && !same(this.value ?? usual, this.base ?? usual);
  }

  /** Shows the dot and the way back where the field differs from the case. */
  compare() {
    const { differs } = this;
    this.element.classList.toggle('differs', differs);
    this.#reset.hidden = !differs;
    if (differs) {
      const words = `Reset ${this.field.title} to ${this.told(this.base)}`;
      this.#reset.setAttribute('aria-label', words);
      this.#reset.title = words;
    }
  }

  /** Returns to the value of the case; without a case to the usual one. */
  reset() {
    if (!this.comparable || !this.differs) return;
    this.set(this.base, true);
  }

  /** A value in words. @param {unknown} value @returns {string} */
  told(value) {
    if (value === undefined || value === null) {
      const { default: usual } = this.field;
      return usual == null ? 'not set' : this.told(usual);
    }
    return typeof value === 'number'
      ? quantity(value, this.field.unit)
      : Array.isArray(value)
        ? 'those of the case'
        : String(value);
  }

  /** @param {boolean} off true while the body cannot have it */
  disable(off) {
    this.input.disabled = off;
    this.element.classList.toggle('off', off);
    this.compare();
  }

  /** The words that a search looks in. */
  get words() {
    const { title, symbol: sign, field: path, about, group } = this.field;
    return `${title} ${sign} ${path} ${path.replace(/[._]/g, ' ')} ${about} ${group}`.toLowerCase();
  }
}

/** @param {Field} field */
export const idOf = ({ field }) => `field-${field.replaceAll('.', '-')}`;
