// The form of a scene, made from the server's table of fields. Keeps what was typed; does not judge a scene: the server does.

import { pathOf, setAt, valueAt } from '../api/scene-fields.js';
import { h } from '../dom/elements.js';
import { inWords } from '../dom/typeset.js';
import { UNITS } from '../dom/units.js';
import { FIRST, Group, grouped } from './groups.js';
import { NumberRow } from './number-row.js';
import { BooleanRow, ChoiceRow, NumbersRow, VerticesRow } from './other-rows.js';
import { SettingsBar } from './search.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./row.js').Row} Row */

const KINDS = {
  choice: ChoiceRow,
  boolean: BooleanRow,
  vertices: VerticesRow,
  numbers: NumbersRow,
  number: NumberRow,
  integer: NumberRow,
};

/** Digits of numbers in errors. */
const DIGITS = 4;

/** A sentence with numbers no longer than one reads; one that is a least or a most value is still allowed. @param {string} text */
const shortened = (text) =>
  text.replace(/(at (?:least|most) )?(-?\d+\.\d{5,})(?![\d.e])/g, (_, bound = '', digits) => {
    const value = Number(digits);
    const step = 10 ** (Math.floor(Math.log10(Math.abs(value) || 1)) - DIGITS + 1);
    const round = bound === 'at least ' ? Math.ceil : bound === 'at most ' ? Math.floor : Math.round;
    return bound + String(Number((round(value / step) * step).toPrecision(DIGITS)));
  });

export class Form {
  /** @type {Map<string, Row>} */
  #rows = new Map();
  /** The groups that fold, with their fields. @type {Map<Group, Row[]>} */
  #groups = new Map();
  /** Fields that a search does not hide. @type {Row[]} */
  #apart = [];
  /** The scene that the fields are compared with. @type {Scene | null} */
  #case = null;
  #spoken = h('p', { class: 'unseen', role: 'status' });
  #bar = new SettingsBar(
    (words) => this.#search(words),
    () => this.#resetAll(),
  );
  #onEdit;

  /**
   * @param {HTMLElement} root
   * @param {Field[]} fields
   * @param {(path: string, final: boolean) => void} onEdit final when a slider was let go or a text was left
   * @param {{first: string[], into: HTMLElement} | null} [apart] fields that stand elsewhere, out of reach of the search
   */
  constructor(root, fields, onEdit, apart = null) {
    this.#onEdit = onEdit;
    const host = {
      edited: (/** @type {string} */ path, /** @type {boolean} */ final) => this.#edited(path, final),
      needs: (/** @type {Field} */ field) => this.#needs(field),
      tell: (/** @type {string} */ words) => {
        this.#spoken.textContent = words;
      },
    };
    const parts = grouped(fields, apart?.first ?? FIRST).map(([title, members]) => {
      const rows = members.map((field) => {
        const row = new KINDS[field.kind](field, host);
        this.#rows.set(field.field, row);
        return row;
      });
      const elements = rows.map(({ element }) => element);
      if (title === '') {
        this.#apart = apart ? rows : [];
        apart?.into.append(...elements);
        return apart ? '' : h('div', { class: 'first' }, ...elements);
      }
      const group = new Group(title, elements);
      this.#groups.set(group, rows);
      return group.element;
    });
    root.replaceChildren(this.#bar.element, ...parts, this.#spoken);
    root.addEventListener('submit', (event) => event.preventDefault());
    document.addEventListener(UNITS, () => {
      for (const row of this.#rows.values()) row.describe();
    });
  }

  /** The row of a field, where there is one. @param {string} path */
  row(path) {
    return this.#rows.get(path) ?? null;
  }

  /** @param {string} path @param {boolean} final */
  #edited(path, final) {
    this.#reach();
    this.#count();
    this.#onEdit(path, final);
  }

  /** A point has no extent and a polygon has the rod's lengths: what one cannot have beside it cannot be typed, and stays for later. */
  #reach() {
    const isPoint = this.#rows.get('body.point')?.value === true;
    const isPolygon = !isPoint && this.#rows.get('body.vertices')?.value !== undefined;
    for (const row of this.#rows.values()) {
      const { field: path } = row.field;
      if (!path.startsWith('body.') || path === 'body.point') continue;
      const off = isPoint || (isPolygon && ['body.contact_distance', 'body.radius_of_gyration'].includes(path));
      if (off !== row.input.disabled) row.disable(off);
    }
  }

  /** True when an enabled field has to have a value; a table that a state feedback tilts needs no tilt gain. @param {Field} field */
  #needs({ field: path, required }) {
    if (!required) return false;
    const feedback = [...this.#rows.values()].some(
      ({ field, value }) => field.field.startsWith('table.feedback.') && value !== undefined,
    );
    return path !== 'table.tilt_gain' || !feedback;
  }

  /** Counts what differs from the case. */
  #count() {
    let all = 0;
    for (const row of this.#rows.values()) if (row.differs) all += 1;
    for (const [group, rows] of this.#groups) group.differ(rows.filter(({ differs }) => differs).length);
    this.#bar.differ(all);
  }

  /** @param {string[]} words @returns {number | null} fields with all of the words; null without a search */
  #search(words) {
    const found = (/** @type {Row} */ row) => words.every((word) => row.words.includes(word));
    let all = 0;
    for (const row of this.#rows.values()) {
      if (this.#apart.includes(row)) continue;
      const hit = found(row);
      row.element.hidden = !hit;
      if (hit) all += 1;
    }
    for (const [group, rows] of this.#groups)
      group.search(words.length === 0 ? null : rows.filter(({ element }) => !element.hidden).length);
    return words.length === 0 ? null : all;
  }

  #resetAll() {
    const differing = [...this.#rows.values()].filter(({ differs }) => differs);
    for (const row of differing) row.fill(row.base);
    this.#reach();
    for (const { field } of differing) this.#edited(field.field, true);
  }

  /** The scene that the fields are compared with; null where there is none. @param {Scene | null} scene */
  compare(scene) {
    if (scene === this.#case) return;
    this.#case = scene;
    for (const row of this.#rows.values()) row.against(scene && valueAt(scene, row.field.field), scene !== null);
    this.#count();
  }

  /** Fills in a scene; what it leaves open shows its default. @param {Scene} scene */
  fill(scene) {
    for (const row of this.#rows.values()) row.fill(valueAt(scene, row.field.field));
    this.#reach();
    this.#count();
  }

  /**
   * One value from elsewhere, such as the gain beside the scene.
   * @param {string} path
   * @param {unknown} value
   */
  put(path, value) {
    const row = this.#rows.get(path);
    if (!row || (row.problem === null && row.value === value)) return;
    row.fill(value);
    this.#count();
  }

  /** The typed scene without defaults, of a text that is no value the last that was one; `complete` when every text is a value. */
  read() {
    /** @type {Scene} */
    const scene = {};
    let complete = true;
    for (const row of this.#rows.values()) {
      const { value, problem } = row.read();
      if (problem) complete = false;
      if (value !== undefined) setAt(scene, row.field.field, value);
    }
    return { scene, complete };
  }

  /** Shows beside every field without a value what is wrong with it. */
  complain() {
    for (const row of this.#rows.values()) {
      const { problem } = row.read();
      if (problem) this.#blameRow(row, problem);
    }
  }

  /** @param {Row} row @param {string} words */
  #blameRow(row, words) {
    row.say(words);
    for (const [group, rows] of this.#groups) if (rows.includes(row)) group.reveal();
  }

  /**
   * The server's errors beside their fields.
   * @param {import('contract').ProblemError[]} errors
   * @returns {string[]} those that belong to no field here
   */
  blame(errors) {
    for (const row of this.#rows.values())
      if (row.input.getAttribute('aria-invalid') === 'true' && row.read().problem === null) row.say(null);
    /** @type {string[]} */
    const elsewhere = [];
    for (const error of errors) {
      const path = pathOf(error.pointer);
      const rows = [...this.#rows.values()];
      const row =
        this.#rows.get(path) ??
        rows.find((one) => one.field.field.startsWith(`${path}.`) || path.startsWith(`${one.field.field}.`));
      if (row && path !== '') this.#blameRow(row, inWords(shortened(error.detail)));
      else elsewhere.push(inWords(error.detail));
    }
    return elsewhere;
  }

  /** The first field with an error gets the focus. */
  focusError() {
    for (const { input, element } of this.#rows.values()) {
      if (input.getAttribute('aria-invalid') !== 'true') continue;
      // A search for others may hide it.
      if (element.hidden) this.#bar.clear();
      return input.focus();
    }
  }
}
