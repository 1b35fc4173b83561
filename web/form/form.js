// The form of a scene, made from the server's table of fields. Keeps what was typed, right or wrong; does not judge a scene: the server does.

import { aim } from './slider-range.js';
import { h } from '../dom/elements.js';
import { steady } from './steady-slider.js';
import { symbol } from '../dom/typeset.js';
import { number, parse, quantity, unitAfter } from '../dom/numbers.js';
import { pathOf, setAt, valueAt } from '../api/scene-fields.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/**
 * @typedef {object} Row
 * @property {Field} field
 * @property {HTMLElement} element
 * @property {HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} input
 * @property {HTMLInputElement | null} slider
 * @property {HTMLElement} error
 * @property {{text: string, value: number} | null} exact what a shortened text stands for, until it is edited
 */

// Fields that stand at the top of a scene, each a group of its own there, make one group here.
const TOP = 'World';

/** @param {Field} field */
function groupOf({ path, group }) {
  if (path.startsWith('table.feedback.')) return 'State feedback';
  if (path.startsWith('table.limits.')) return 'Limits of the table';
  return path.includes('.') ? group[0].toUpperCase() + group.slice(1) : TOP;
}

/** Vertices from lines of two numbers. @param {string} text @returns {{value: unknown, problem: string | null}} */
function places(text) {
  const lines = text
    .trim()
    .split('\n')
    .map((line) =>
      line
        .trim()
        .split(/[\s,;]+/)
        .map((part) => parse(part, 'm')),
    );
  const wrong = lines.findIndex((place) => place.length !== 2 || place.includes(null));
  return wrong < 0
    ? { value: lines, problem: null }
    : { value: undefined, problem: `Line ${wrong + 1} is not x and y, as in “0.1, 0.2”.` };
}

export class Form {
  /** @type {Map<string, Row>} */
  #rows = new Map();
  #onEdit;

  /**
   * @param {HTMLElement} root
   * @param {Field[]} fields
   * @param {(path: string, final: boolean) => void} onEdit final when a slider was let go or a text was left
   */
  constructor(root, fields, onEdit) {
    this.#onEdit = onEdit;
    for (const title of new Set(fields.map(groupOf))) {
      const members = fields.filter((field) => groupOf(field) === title);
      const fieldset = h('fieldset', {}, h('legend', {}, title));
      for (const field of members) fieldset.append(this.#row(field));
      root.append(fieldset);
    }
    root.addEventListener('submit', (event) => event.preventDefault());
  }

  /** @param {Field} field */
  #row(field) {
    const id = `field-${field.path.replaceAll('.', '-')}`;
    const error = h('p', { class: 'error', id: `${id}-error` });
    const about = h('span', { class: 'about', id: `${id}-about` }, field.about);
    const name = h('label', { for: id }, field.title, field.symbol && ' ', field.symbol ? symbol(field.symbol) : null);
    const described = `${id}-about ${id}-error`;
    /** @type {Row['input']} */
    let input;
    /** @type {HTMLInputElement | null} */
    let slider = null;
    if (field.kind === 'choice') {
      input = h(
        'select',
        { id, 'aria-describedby': described, change: () => this.#edited(field.path, true) },
        field.default == null && h('option', { value: '' }, 'not set'),
        ...(field.choices ?? []).map((choice) => h('option', { value: choice }, choice)),
      );
    } else if (field.kind === 'vertices') {
      input = h('textarea', {
        id,
        rows: 3,
        spellcheck: 'false',
        'aria-describedby': described,
        placeholder: 'not set',
        input: () => this.#edited(field.path, false),
        change: () => this.#edited(field.path, true),
      });
    } else if (field.kind === 'boolean') {
      input = h('input', {
        id,
        type: 'checkbox',
        'aria-describedby': described,
        change: () => this.#edited(field.path, true),
      });
    } else {
      const typed = h('input', {
        id,
        type: 'text',
        inputmode: 'decimal',
        autocomplete: 'off',
        spellcheck: 'false',
        'aria-describedby': described,
        placeholder: field.default == null ? 'not set' : number(Number(field.default)),
        input: () => this.#edited(field.path, false),
        change: () => this.#edited(field.path, true),
      });
      input = typed;
      // Nobody finds one number among trillions with a slider.
      const moved =
        field.kind === 'integer' && (field.maximum ?? Infinity) > 1e6
          ? null
          : h('input', { type: 'range', 'aria-label': `${field.title}, slider`, tabindex: 0 });
      if (moved) {
        steady(moved, () => {
          const row = /** @type {Row} */ (this.#rows.get(field.path));
          const { exact } = row;
          const text = typed.value;
          return () => {
            row.exact = exact;
            typed.value = text;
            this.#edited(field.path, false);
          };
        });
      }
      for (const [event, final] of /** @type {const} */ ([
        ['input', false],
        ['change', true],
      ])) {
        moved?.addEventListener(event, () => {
          typed.value = moved.value;
          this.#edited(field.path, final, true);
        });
      }
      slider = moved;
    }
    const unit = unitAfter(field.unit).trim();
    const range =
      field.minimum != null && field.maximum != null
        ? h('span', { class: 'range' }, `${number(field.minimum)} to ${quantity(field.maximum, field.unit)}`)
        : null;
    const element = h(
      'div',
      { class: `field ${field.kind}` },
      h('div', { class: 'field-head' }, name, field.live && h('span', { class: 'live-tag' }, 'live')),
      h(
        'div',
        { class: 'field-row' },
        slider ?? h('span'),
        input,
        field.kind !== 'choice' && field.kind !== 'boolean' && h('span', { class: 'unit' }, unit),
      ),
      h('p', { class: 'field-foot' }, about, field.about && range ? ' · ' : '', range),
      error,
    );
    this.#rows.set(field.path, { field, element, input, slider, error, exact: null });
    return element;
  }

  /**
   * @param {string} path
   * @param {boolean} final
   */
  #edited(path, final, bySlider = false) {
    const row = /** @type {Row} */ (this.#rows.get(path));
    // Leaving a text changes nothing: what is wrong with it stays said.
    if (!final || row.field.kind === 'choice' || row.field.kind === 'boolean') this.#say(row, null);
    const { value, problem } = this.#read(row);
    if (problem && final) this.#say(row, problem);
    if (row.slider && !problem) {
      if (bySlider) row.slider.setAttribute('aria-valuetext', quantity(Number(value), row.field.unit));
      else aim(row.slider, row.field, typeof value === 'number' ? value : null);
    }
    this.#reach();
    this.#onEdit(path, final);
  }

  /** A point has no extent and a polygon has the rod's lengths: what one cannot have beside it cannot be typed, and stays for later. */
  #reach() {
    const point = this.#rows.get('body.point');
    const isPoint = point?.input instanceof HTMLInputElement && point.input.checked;
    const isPolygon = !isPoint && this.#rows.get('body.vertices')?.input.value.trim() !== '';
    for (const { field, input, slider, element } of this.#rows.values()) {
      if (!field.path.startsWith('body.') || field.path === 'body.point') continue;
      const off = isPoint || (isPolygon && ['body.contact_distance', 'body.radius_of_gyration'].includes(field.path));
      input.disabled = off;
      if (slider) slider.disabled = off;
      element.classList.toggle('off', off);
    }
  }

  /** True when a state feedback tilts the table, which then needs no tilt gain. */
  #feedback() {
    return [...this.#rows.values()].some(
      ({ field, input }) => field.path.startsWith('table.feedback.') && input.value.trim() !== '',
    );
  }

  /** @param {Row} row @returns {{value: unknown, problem: string | null}} */
  #read({ field, input, exact }) {
    if (input.disabled) return { value: undefined, problem: null };
    if (field.kind === 'boolean')
      return { value: /** @type {HTMLInputElement} */ (input).checked || undefined, problem: null };
    if (field.kind === 'choice')
      return { value: input.value === (field.default ?? '') ? undefined : input.value, problem: null };
    if (input.value.trim() === '') {
      if (field.required && !field.path.startsWith('body.') && !(field.path === 'table.tilt_gain' && this.#feedback()))
        return { value: undefined, problem: `${field.title} is needed.` };
      return { value: undefined, problem: null };
    }
    if (field.kind === 'vertices') return places(input.value);
    if (input.value === exact?.text) return { value: exact.value, problem: null };
    const value = parse(input.value, field.unit);
    return value === null
      ? { value: undefined, problem: `“${input.value.trim()}” is not a number.` }
      : { value, problem: null };
  }

  /**
   * @param {Row} row
   * @param {string | null} problem
   */
  #say({ input, error }, problem) {
    if (problem === null) input.removeAttribute('aria-invalid');
    else input.setAttribute('aria-invalid', 'true');
    error.textContent = problem ?? '';
  }

  /** Fills in a scene; what it leaves open shows its default. @param {Scene} scene */
  fill(scene) {
    for (const row of this.#rows.values()) {
      const value = valueAt(scene, row.field.path);
      this.#put(row, value === row.field.default ? null : value);
      this.#say(row, null);
    }
    this.#reach();
  }

  /**
   * @param {Row} row
   * @param {unknown} value
   */
  #put(row, value) {
    const { field, input, slider } = row;
    row.exact = null;
    if (input instanceof HTMLInputElement && field.kind === 'boolean') input.checked = value === true;
    else if (Array.isArray(value)) input.value = value.map((place) => place.join(', ')).join('\n');
    else if (field.kind === 'choice') input.value = String(value ?? field.default ?? '');
    else if (typeof value !== 'number') input.value = '';
    else {
      const text = String(value);
      row.exact = text.length > 8 ? { text: String(Number(value.toPrecision(5))), value } : null;
      input.value = row.exact?.text ?? text;
      input.title = row.exact ? text : '';
    }
    if (slider) aim(slider, field, typeof value === 'number' ? value : null);
  }

  /**
   * One value from elsewhere, such as the gain beside the scene.
   * @param {string} path
   * @param {unknown} value
   */
  put(path, value) {
    const row = this.#rows.get(path);
    if (!row || this.#read(row).value === value) return;
    this.#put(row, value);
    this.#say(row, null);
  }

  /** The typed scene without defaults; `complete` when every text is a value. */
  read() {
    /** @type {Scene} */
    const scene = {};
    let complete = true;
    for (const row of this.#rows.values()) {
      const { value, problem } = this.#read(row);
      if (problem) complete = false;
      else if (value !== undefined) setAt(scene, row.field.path, value);
    }
    return { scene, complete };
  }

  /** Shows beside every number that is none what is wrong with it. */
  complain() {
    for (const row of this.#rows.values()) {
      const { problem } = this.#read(row);
      if (problem) this.#say(row, problem);
    }
  }

  /**
   * The server's errors beside their fields.
   * @param {import('contract').ProblemError[]} errors
   * @returns {string[]} those that belong to no field here
   */
  blame(errors) {
    for (const row of this.#rows.values()) if (this.#read(row).problem === null) this.#say(row, null);
    /** @type {string[]} */
    const elsewhere = [];
    for (const { pointer, detail } of errors) {
      const path = pathOf(pointer);
      const row =
        this.#rows.get(path) ??
        [...this.#rows.values()].find(
          ({ field }) => field.path.startsWith(`${path}.`) || path.startsWith(`${field.path}.`),
        );
      if (row && path !== '') this.#say(row, detail);
      else elsewhere.push(detail);
    }
    return elsewhere;
  }

  /** The first field with an error gets the focus. */
  focusError() {
    for (const { input } of this.#rows.values()) {
      if (input.getAttribute('aria-invalid') === 'true') return input.focus();
    }
  }
}
