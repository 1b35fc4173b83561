// Rows of fields that are no single numbers: a choice, yes or no, the vertices of a polygon, a list of numbers.

import { h } from '../dom/elements.js';
import { commits } from '../dom/number-input.js';
import { parse } from '../dom/typed-number.js';
import { Row } from './row.js';

/** @typedef {import('./row.js').Field} Field */
/** @typedef {import('./row.js').Host} Host */

export class ChoiceRow extends Row {
  /** @param {Field} field @param {Host} host */
  constructor(field, host) {
    const select = h(
      'select',
      {},
      field.default == null && h('option', { value: '' }, 'not set'),
      ...(field.choices ?? []).map((choice) => h('option', { value: choice }, choice.replaceAll('_', ' '))),
    );
    super(field, host, select);
    this.head.after(select);
    select.addEventListener('change', () =>
      this.take(select.value === (field.default ?? '') ? undefined : select.value, true),
    );
  }

  show() {
    this.input.value = String(this.value ?? this.field.default ?? '');
  }
}

export class BooleanRow extends Row {
  #box;

  /** @param {Field} field @param {Host} host */
  constructor(field, host) {
    const box = h('input', { type: 'checkbox' });
    super(field, host, box);
    this.#box = box;
    this.head.prepend(box);
    box.addEventListener('change', () => this.take(box.checked || undefined, true));
  }

  show() {
    this.#box.checked = this.value === true;
  }
}

export class VerticesRow extends Row {
  /** @param {Field} field @param {Host} host */
  constructor(field, host) {
    const area = h('textarea', { rows: field.kind === 'numbers' ? 1 : 3, spellcheck: 'false', placeholder: 'not set' });
    super(field, host, area);
    this.head.after(area);
    commits(
      area,
      (text) => {
        const { problem } = this.#meaning(text);
        return problem === null ? {} : { problem };
      },
      (problem, refused) => this.#refuse(problem, refused),
    );
    area.addEventListener('change', () => this.take(this.#meaning(area.value).value, true));
    // A list has one line.
    if (field.kind === 'numbers')
      area.addEventListener('keydown', (event) => {
        if (event.key !== 'Enter') return;
        event.preventDefault();
        area.blur();
      });
  }

  /** @param {string} text @returns {{value: unknown, problem: string | null}} */
  #meaning(text) {
    return text.trim() === '' ? { value: undefined, problem: null } : this.meant(text);
  }

  /** @param {string} text */
  meant(text) {
    return places(text);
  }

  /** Says why an entry was refused; half a polygon is no reason to type it all again. @param {string | null} problem @param {string} refused */
  #refuse(problem, refused) {
    this.say(problem && `It was put back. ${problem}`, false);
    if (problem === null) return;
    this.host.tell(`${this.field.title}: ${this.error.textContent}`);
    const again = () => {
      this.input.focus();
      this.input.dispatchEvent(new InputEvent('beforeinput'));
      this.input.value = refused;
    };
    this.error.append(' ', h('button', { type: 'button', click: again }, 'Edit it'));
  }

  show() {
    this.input.value = Array.isArray(this.value) ? this.value.map((place) => place.join(', ')).join('\n') : '';
  }
}

export class NumbersRow extends VerticesRow {
  /** @param {string} text */
  meant(text) {
    const value = numbers(text, this.field.unit);
    return value.includes(null)
      ? { value: undefined, problem: `“${text.trim()}” is not a list of numbers, as in “0.2, 0.3”.` }
      : { value, problem: null };
  }

  show() {
    this.input.value = Array.isArray(this.value) ? this.value.join(', ') : '';
  }
}

/** Numbers apart by commas, semicolons or blanks. @param {string} text @param {string} unit */
const numbers = (text, unit) =>
  text
    .trim()
    .split(/\s*[,;]\s*|\s+(?=[-+.\d\u2212])/)
    .map((part) => parse(part, unit));

/** Vertices from lines of two numbers. @param {string} text @returns {{value: unknown, problem: string | null}} */
function places(text) {
  const lines = text
    .trim()
    .split('\n')
    .map((line) => numbers(line, 'm'));
  const wrong = lines.findIndex((place) => place.length !== 2 || place.includes(null));
  return wrong < 0
    ? { value: lines, problem: null }
    : { value: undefined, problem: `Line ${wrong + 1} is not x and y, as in “0.1, 0.2”.` };
}
