// The form of a scene, made from the server's table of fields. It does not judge a scene: the server does.

import { pathOf, same, valueAt } from '../api/scene-fields.js';
import { idOf, missing, told, typed as read } from '../api/settings.js';
import { remember, remembered } from '../api/remembered.js';
import { inWords } from '../dom/typeset.js';
import { UNITS } from '../dom/units.js';
import { html, render } from '../vendor/preact/preact.js';
import { Row } from './row.js';
import { TypedScene } from './typed-scene.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./row.js').Said} Said */

/** The fields that come first and never fold. */
const FIRST = ['table.tilt_gain', 'release.theta', 'contact.restitution', 'contact.friction', 'noise.timing_sd'];

/** The groups in their order; a field is of the longest start of its path. */
const GROUPS = /** @type {const} */ ([
  ['Release', 'release.'],
  ['Body', 'body.'],
  ['Table', 'table.'],
  ['Feedback', 'table.feedback.'],
  ['Limits', 'table.limits.'],
  ['Noise', 'noise.'],
  ['World', ''],
]);

/** @param {Field} field */
const groupOf = ({ field }) =>
  GROUPS.filter(([, start]) => field.startsWith(start)).sort(([, one], [, other]) => other.length - one.length)[0][0];

const STORED = 'equipoise.groups';

/** Titles of the groups that the reader left open. @returns {Set<string>} */
function openGroups() {
  try {
    const titles = JSON.parse(remembered(STORED, '[]'));
    return new Set(Array.isArray(titles) ? titles : []);
  } catch {
    return new Set();
  }
}

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

/** The words that a search looks in. @param {Field} field */
const searched = ({ title, symbol, field: path, about, group }) =>
  `${title} ${symbol} ${path} ${path.replace(/[._]/g, ' ')} ${about} ${group}`.toLowerCase();

export class Form {
  typed;
  #root;
  #apart;
  /** The fields that stand first. @type {Field[]} */
  #first;
  /** The others by group. @type {[string, Field[]][]} */
  #groups;
  #onEdit;
  /** The scene that the fields are compared with. @type {Scene | null} */
  #case = null;
  /** The words beside fields, by path. @type {Map<string, Said>} */
  #said = new Map();
  /** Marks on the tracks of fields, by path. @type {Map<string, import('./track.js').Mark | null>} */
  #marks = new Map();
  #maps;
  /** The text of the search, and its words. */
  #text = '';
  /** @type {string[]} */
  #words = [];
  #spoken = '';
  /** Titles of the groups with a field that differs from the case. @type {Set<string>} */
  #differing = new Set();
  /** The groups that stand open, by the reader's wish or since a field of theirs differs. */
  #open = openGroups();

  /**
   * @param {HTMLElement} root
   * @param {Field[]} fields
   * @param {(path: string, final: boolean) => void} onEdit final when a slider was let go or a text was left
   * @param {{first?: string[], into?: HTMLElement, typed?: TypedScene, before?: (path: string, final: boolean) => void, maps?: Record<string, () => string | null>}} [parts]
   * fields that stand first, and elsewhere, out of reach of the search; the scene that is edited; a listener before an edit; the scene whose runs a track shows, as a query
   */
  constructor(root, fields, onEdit, { first = FIRST, into, typed = new TypedScene(), before, maps = {} } = {}) {
    typed.fields = fields;
    typed.retyped = (path) => this.#retyped(path);
    this.typed = typed;
    this.#maps = maps;
    this.#root = root;
    this.#first = first.flatMap((path) => fields.find(({ field }) => field === path) ?? []);
    const rest = fields.filter((field) => !this.#first.includes(field));
    this.#groups = GROUPS.map(([title]) => [title, rest.filter((field) => groupOf(field) === title)]);
    this.#apart = into ?? null;
    this.#onEdit = { before, after: onEdit };
    root.addEventListener('submit', (event) => event.preventDefault());
    document.addEventListener(UNITS, () => this.#render());
    this.#render();
  }

  #render() {
    const { fields } = this.typed;
    const leading = this.#first.map((field) => this.#row(field));
    if (this.#apart) render(leading, this.#apart);
    const differing = fields.filter((field) => this.#differs(field)).length;
    const found = fields.filter((field) => this.#finds(field)).length - (this.#apart ? leading.length : 0);
    const search = (/** @type {Event} */ event) =>
      this.#search(/** @type {HTMLInputElement} */ (event.currentTarget).value);
    const leave = (/** @type {KeyboardEvent} */ event) => {
      if (event.key !== 'Escape' || this.#text === '') return;
      event.preventDefault();
      this.#search('');
    };
    const tree = html`<div class="settings-bar">
        <input type="search" id="settings-search" placeholder="Find a setting" aria-label="Find a setting"
          autocomplete="off" spellcheck="false" value=${this.#text} onInput=${search} onKeyDown=${leave} />
        <button type="button" id="settings-reset" hidden=${differing === 0}
          onClick=${() => this.#resetAll()}>Reset all (${differing})</button>
        <p class="muted found" role="status">${
          this.#words.length > 0 &&
          (found === 0 ? 'No setting has these words.' : `${found} ${found === 1 ? 'setting' : 'settings'}`)
        }</p>
      </div>
      ${!this.#apart && html`<div class="first">${leading}</div>`}
      ${this.#groups.map(([title, fields]) => this.#group(title, fields))}
      <p class="unseen" role="status">${this.#spoken}</p>`;
    render(tree, this.#root);
  }

  /** @param {string} title @param {Field[]} fields */
  #group(title, fields) {
    if (fields.length === 0) return null;
    const count = fields.filter((field) => this.#differs(field)).length;
    const searching = this.#words.length > 0;
    const found = fields.some((field) => this.#finds(field));
    const id = `group-${title.toLowerCase()}`;
    const turn = (/** @type {Event} */ event) => {
      const { open } = /** @type {HTMLDetailsElement} */ (event.currentTarget);
      if (this.#words.length > 0 || open === this.#open.has(title)) return;
      this.#open[open ? 'add' : 'delete'](title);
      const stored = openGroups();
      stored[open ? 'add' : 'delete'](title);
      remember(STORED, JSON.stringify([...stored]));
    };
    return html`<details class="group" key=${title} hidden=${!found} open=${searching || this.#open.has(title)}
      onToggle=${turn}>
      <summary id=${id}>${title} <span class="differing">${
        count > 0 && html`(${count}•)<span class="unseen"> changed from the case</span>`
      }</span></summary>
      <div role="group" aria-labelledby=${id}>${fields.map((field) => this.#row(field))}</div>
    </details>`;
  }

  /** @param {Field} field */
  #row(field) {
    const { field: path } = field;
    const differs = this.#differs(field);
    return html`<${Row} key=${path} form=${this} field=${field} value=${this.typed.value(field)} differs=${differs}
      base=${differs ? this.#base(field) : undefined} off=${this.typed.isOff(field)} hidden=${!this.#finds(field)}
      said=${this.#said.get(path)} mark=${this.#marks.get(path)} scene=${this.#maps[path]?.()} />`;
  }

  /** The value in the case; undefined where it has none. @param {Field} field */
  #base(field) {
    const value = this.#case && valueAt(this.#case, field.field);
    return same(value, field.default) ? undefined : (value ?? undefined);
  }

  /** @param {Field} field */
  #differs(field) {
    const usual = field.default ?? undefined;
    return (
      this.#case !== null &&
      !this.typed.isOff(field) &&
      !same(this.typed.value(field) ?? usual, this.#base(field) ?? usual)
    );
  }

  /** True for a field that the search does not hide. @param {Field} field */
  #finds(field) {
    if (this.#apart && this.#first.includes(field)) return true;
    return this.#words.every((word) => searched(field).includes(word));
  }

  /** @param {string} text */
  #search(text) {
    this.#text = text;
    this.#words = text.toLowerCase().split(/\s+/).filter(Boolean);
    this.#render();
  }

  /** @param {string | null} path of the field; null for another scene */
  #retyped(path) {
    if (path === null) this.#said.clear();
    else this.#said.delete(path);
    this.#compare();
  }

  /** Opens the groups in which a field began to differ. */
  #compare() {
    const differing = new Set(this.typed.fields.filter((field) => this.#differs(field)).map(groupOf));
    for (const title of differing) if (!this.#differing.has(title)) this.#open.add(title);
    this.#differing = differing;
    this.#render();
  }

  /** Sets the value of a field as a reader does. @param {string} path @param {unknown} value @param {boolean} final @param {string} [focus] id of the control that has the focus after it */
  set(path, value, final, focus) {
    this.#onEdit.before?.(path, final);
    this.typed.put(path, value);
    this.#onEdit.after(path, final);
    if (focus) document.getElementById(focus)?.focus();
  }

  /** Tells of an edit that has ended. @param {string} path */
  settle(path) {
    this.#onEdit.before?.(path, true);
    this.#onEdit.after(path, true);
  }

  /** Returns to the value of the case. @param {Field} field @param {string} [focus] */
  reset(field, focus) {
    if (this.#differs(field)) this.set(field.field, this.#base(field), true, focus);
  }

  #resetAll() {
    const differing = this.typed.fields.filter((field) => this.#differs(field));
    if (differing.length > 0) this.#onEdit.before?.(differing[0].field, true);
    for (const field of differing) this.typed.put(field.field, this.#base(field));
    for (const { field: path } of differing) this.#onEdit.after(path, true);
    document.getElementById('settings-search')?.focus();
  }

  /** Reads a typed text. @param {Field} field @param {string} text */
  judge(field, text) {
    return read(field, text, this.typed.needs(field));
  }

  /** Says why an entry was refused; null takes the words away. @param {Field} field @param {string | null} problem @param {string} refused */
  refuse(field, problem, refused) {
    const value = this.typed.value(field);
    if (problem === null) {
      if (!this.#said.delete(field.field)) return;
    } else if (field.kind === 'vertices' || field.kind === 'numbers')
      this.#say(field, { words: `It was put back. ${problem}`, wrong: false, refused });
    else {
      const back = value === undefined ? `It is ${told(field, value)} again` : `${told(field, value)} was put back`;
      this.#say(field, { words: `${back}: ${problem}`, wrong: false });
    }
    this.#render();
  }

  /** @param {Field} field @param {Said} said */
  #say(field, said) {
    this.#said.set(field.field, said);
    if (said.wrong) this.#open.add(groupOf(field));
    else this.#spoken = `${field.title}: ${said.words}`;
  }

  /** The scene that the fields are compared with; null where there is none. @param {Scene | null} scene */
  compare(scene) {
    if (scene === this.#case) return;
    this.#case = scene;
    this.#compare();
  }

  /** Marks a value on the track of a field. @param {string} path @param {import('./track.js').Mark | null} mark */
  mark(path, mark) {
    this.#marks.set(path, mark);
    this.#render();
  }

  /** Marks the fields that lack a value that they need. */
  complain() {
    for (const field of this.typed.missing) this.#say(field, { words: missing(field), wrong: true });
    this.#render();
  }

  /**
   * The server's errors beside their fields.
   * @param {import('contract').ProblemError[]} errors
   * @returns {string[]} those that belong to no field here
   */
  blame(errors) {
    const { fields } = this.typed;
    for (const [path, { wrong }] of this.#said)
      if (wrong && !this.typed.missing.some(({ field }) => field === path)) this.#said.delete(path);
    /** @type {string[]} */
    const elsewhere = [];
    for (const error of errors) {
      const path = pathOf(error.pointer);
      const field =
        fields.find((one) => one.field === path) ??
        fields.find((one) => one.field.startsWith(`${path}.`) || path.startsWith(`${one.field}.`));
      if (field && path !== '') this.#say(field, { words: inWords(shortened(error.detail)), wrong: true });
      else elsewhere.push(inWords(error.detail));
    }
    this.#render();
    return elsewhere;
  }

  /** The first field with an error gets the focus. */
  focusError() {
    const field = this.typed.fields.find(({ field: path }) => this.#said.get(path)?.wrong);
    if (!field) return;
    // A search for others may hide it.
    if (!this.#finds(field)) this.#search('');
    document.getElementById(idOf(field))?.focus();
  }
}
