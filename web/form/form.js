// The form of a scene, made from the server's table of fields. It does not judge a scene: the server does.

import { remember, remembered } from '../api/remembered.js';
import { pathOf, same, valueAt } from '../api/scene-fields.js';
import { idOf, limitsOf, missing, textOf, told, typed as read, usual } from '../api/settings.js';
import { debounce } from '../dom/debounce.js';
import { drags } from '../dom/drag.js';
import { commits } from '../dom/number-input.js';
import { number, number as shortNumber, quantity, unitAfter } from '../dom/numbers.js';
import { parse, unitsFor } from '../dom/typed-number.js';
import { inWords } from '../dom/typeset.js';
import { UNITS, angles, shownFactor, shownUnit, shownValue } from '../dom/units.js';
import { useAnswer } from '../panels/ask.js';
import { Choice, sign } from '../panels/parts.js';
import { html, render, useLayoutEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';
import { firstValue, shownRange, sliderStep, steady } from './sliders.js';
import { TypedScene } from './typed-scene.js';

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
  /** Marks on the tracks of fields, by path. @type {Map<string, Mark | null>} */
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

  /** Marks a value on the track of a field. @param {string} path @param {Mark | null} mark */
  mark(path, mark) {
    this.#marks.set(path, mark);
    this.#render();
  }

  /** Marks the fields that lack a value that they need. */
  complain() {
    for (const field of this.typed.missing) this.#say(field, { words: missing(field), wrong: true });
    this.#render();
  }

  /** The server's errors beside their fields. @param {ProblemError[]} errors @returns {string[]} those that belong to no field here */
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

// A row of the form: a field with its label, its control, its help, its error, and the way back to the case.

/** @typedef {HTMLInputElement | HTMLTextAreaElement} Text */
/** Words beside a field: `wrong` for a fault, else a remark on an entry that was put back, with that entry where it can be edited. @typedef {{words: string, wrong: boolean, refused?: string}} Said */

/**
 * @typedef {object} RowProps
 * @property {Form} form
 * @property {Field} field
 * @property {unknown} value undefined for a field that is not set
 * @property {unknown} base the value in the case, for a value that differs
 * @property {boolean} differs
 * @property {boolean} off
 * @property {boolean} hidden
 * @property {Said | undefined} said
 * @property {Mark | null} [mark] on its track
 * @property {string | null} [scene] the query of the scene, for a track with a map
 */

/** Steps by keys have ended after so long without another, ms. */
const SETTLED_MS = 300;

/** True for a field with a slider; nobody finds a number among trillions with one. @param {Field} field */
const slides = ({ kind, maximum }) => kind === 'number' || (kind === 'integer' && (maximum ?? Infinity) <= 1e6);
/** True for a field that can be left open, and has no usual value then. @param {Field} field */
const isOptional = (field) => isNumber(field) && field.default == null && !field.required;
/** @param {Field} field */
const isNumber = ({ kind }) => kind === 'number' || kind === 'integer';

/** Sentences of the help. @param {Field} field @param {unknown} value */
function helpWords(field, value) {
  const { about, live, unit } = field;
  const [limits, standing] = [limitsOf(field), usual(field)];
  const words = about === '' ? [] : [inWords(about.endsWith('.') ? about : `${about}.`)];
  if (limits !== '') words.push(`Allowed: ${limits}.`);
  if (standing !== null) words.push(`Usually ${quantity(standing, unit)}.`);
  if (slides(field)) {
    const [from, to] = shownRange(field, typeof value === 'number' ? value : standing);
    words.push(`Slider: ${shortNumber(from)} to ${shortNumber(to)}${unitAfter(unit)}.`);
  }
  words.push(live ? 'Acts on a run from its next bounce.' : 'Acts when the run is restarted.');
  if (isNumber(field) && unit !== '1')
    words.push(`Type ${unitsFor(unit)}${unit === 'rad' ? ', as in “20°” and “pi/9”' : ''}.`);
  return words.join(' ');
}

/** A row, drawn anew only where it has changed. @param {RowProps} props */
export function Row(props) {
  const { value, base, differs, off, hidden, said, mark, scene } = props;
  const parts = [value, base, differs, off, hidden, said, mark, scene, angles()];
  return useMemo(() => html`<${Parts} ...${props} />`, parts);
}

/** @param {RowProps} props */
function Parts(props) {
  const { form, field, value, base, differs, off, hidden, said } = props;
  const { field: path, title, unit, kind } = field;
  const id = idOf(field);
  const [helps, help] = useState(false);
  const label = useRef(/** @type {HTMLElement | null} */ (null));
  useLayoutEffect(() => {
    if (label.current && isNumber(field)) dragLabel(label.current, form, field);
  }, []);
  const back = `Reset ${title} to ${told(field, base)}`;
  const unset = isOptional(field) && value !== undefined;
  const Control = CONTROLS[kind];
  const control = html`<${Control} ...${props} id=${id} />`;
  return html`<div class=${`field ${kind} ${differs ? 'differs' : ''} ${off ? 'off' : ''}`} hidden=${hidden}>
    <div class="field-head">
      ${kind === 'boolean' && control}
      <label for=${id} class=${isNumber(field) ? 'drags' : ''} ref=${label}
        onDblClick=${() => isNumber(field) && form.reset(field)}>${title}${field.symbol && [' ', sign(field.symbol)]}</label>
      <span class="unit">${unit === '1' || unit === null ? '' : shownUnit(unit)}</span><span class="gap" />
      <button type="button" class="reset icon" hidden=${!differs} aria-label=${back} title=${back}
        onClick=${() => form.reset(field, id)}>↺</button>
      ${
        isOptional(field) &&
        html`<button type="button" class="icon unset" aria-label=${`Unset ${title}`} hidden=${!unset}
          onClick=${() => form.set(path, undefined, true, `${id}-set`)}>×</button>`
      }
      <button type="button" class="icon help" aria-expanded=${String(helps)} aria-controls=${`${id}-help`}
        aria-label=${`About ${title}`} onClick=${() => help(!helps)}>?</button>
    </div>
    ${kind !== 'boolean' && control}
    <p class="field-help" id=${`${id}-help`} hidden=${!helps}>${helpWords(field, value)}</p>
    <p class=${`error ${said && !said.wrong ? 'remark' : ''}`} id=${`${id}-error`}>${said?.words}${
      said?.refused !== undefined &&
      html` <button type="button" onClick=${() => editAgain(id, said.refused ?? '')}>Edit it</button>`
    }</p>
  </div>`;
}

/** Half a polygon is no reason to type it all again. @param {string} id @param {string} refused */
function editAgain(id, refused) {
  const input = /** @type {HTMLTextAreaElement} */ (document.getElementById(id));
  input.focus();
  input.dispatchEvent(new InputEvent('beforeinput'));
  input.value = refused;
}

/** The attributes of every control. @param {RowProps & {id: string}} props */
const common = ({ id, off, said }) => ({
  id,
  disabled: off,
  'aria-describedby': `${id}-help ${id}-error`,
  'aria-invalid': said?.wrong ? 'true' : undefined,
});

/** @param {RowProps & {id: string}} props */
function OneOf(props) {
  const { form, field, value } = props;
  const named = (field.choices ?? []).map((choice) => [choice, choice.replaceAll('_', ' ')]);
  const choices = Object.fromEntries(field.default == null ? [['', 'not set'], ...named] : named);
  const choose = (/** @type {string} */ choice) => form.set(field.field, choice || undefined, true);
  return html`<${Choice} ...${common(props)} value=${String(value ?? field.default ?? '')} choices=${choices} changed=${choose} />`;
}

/** @param {RowProps & {id: string}} props */
function YesNo(props) {
  const { form, field, value } = props;
  const turn = (/** @type {Event} */ event) =>
    form.set(field.field, /** @type {HTMLInputElement} */ (event.currentTarget).checked || undefined, true);
  return html`<input type="checkbox" ...${common(props)} checked=${value === true} onChange=${turn} />`;
}

/** A text that is committed by Enter or by leaving it. @param {RowProps} props @returns {{current: Text | null}} */
function useText({ form, field, value }) {
  const text = useRef(/** @type {Text | null} */ (null));
  const show = () => {
    const input = /** @type {Text} */ (text.current);
    const [now, whole] = [form.typed.value(field), document.activeElement === input];
    input.value = textOf(field, now, whole);
    input.title = textOf(field, now, false) === textOf(field, now) ? '' : textOf(field, now);
  };
  useLayoutEffect(() => {
    const input = /** @type {Text} */ (text.current);
    const judge = (/** @type {string} */ typed) => form.judge(field, typed);
    const settle = debounce(SETTLED_MS, () => form.settle(field.field));
    const finish = commits(
      input,
      (typed) => ({ problem: judge(typed).problem }),
      (problem, refused) => {
        if (problem !== null) show();
        form.refuse(field, problem, refused);
      },
    );
    input.addEventListener('change', () => {
      form.set(field.field, judge(input.value).value, true);
      show();
    });
    input.addEventListener('focus', () => {
      show();
      if (isNumber(field)) input.select();
    });
    input.addEventListener('blur', show);
    input.addEventListener('keydown', (event) => {
      const { key, ctrlKey, metaKey, shiftKey } = /** @type {KeyboardEvent} */ (event);
      // A list has one line.
      if (key === 'Enter' && field.kind === 'numbers') {
        event.preventDefault();
        input.blur();
      }
      const way = { ArrowUp: 1, ArrowDown: -1 }[key];
      if (!isNumber(field) || !way || ctrlKey || metaKey) return;
      event.preventDefault();
      finish();
      const from = form.typed.value(field) ?? usual(field) ?? firstValue(field);
      form.set(field.field, moved(field, Number(from), way * (shiftKey ? 10 : 1)), false);
      settle();
    });
  }, []);
  useLayoutEffect(show, [value, angles()]);
  return text;
}

/** @param {RowProps & {id: string}} props */
function Lines(props) {
  const text = useText(props);
  return html`<textarea ...${common(props)} ref=${text} rows=${props.field.kind === 'numbers' ? 1 : 3}
    spellcheck="false" placeholder="not set" />`;
}

/** @param {RowProps & {id: string}} props */
function Numeric(props) {
  const { form, field, value, off, id, mark, scene } = props;
  const { field: path, title, unit } = field;
  const text = useText(props);
  const slider = useRef(/** @type {HTMLInputElement | null} */ (null));
  const standing = usual(field);
  const number = typeof value === 'number' ? value : null;
  const key = `${value} ${angles()}`;
  /** The key of the value that the slider itself has set: its ends and its step stay then. */
  const own = useRef('');
  const range = useRef({ ends: shownRange(field, number), step: sliderStep(field, number) });
  if (own.current !== key) {
    own.current = '';
    range.current = { ends: shownRange(field, number), step: sliderStep(field, number) };
  }
  const { ends, step } = range.current;
  const at = number ?? standing;
  const turn = (/** @type {Event} */ { type, currentTarget }) => {
    const set = parse(/** @type {HTMLInputElement} */ (currentTarget).value, unit);
    own.current = `${set} ${angles()}`;
    form.set(path, set, type === 'change');
  };
  useLayoutEffect(() => {
    if (!slider.current) return;
    steady(slider.current, () => {
      const before = form.typed.value(field);
      return () => form.set(path, before, false);
    });
  }, []);
  const open = isOptional(field) && value === undefined;
  return html`<div class="field-row">
    ${
      slides(field) &&
      html`<${Track} form=${form} field=${field} ends=${ends} mark=${mark} scene=${scene} hollow=${at === null}>
        <input type="range" id=${`${id}-slider`} ref=${slider} min=${ends[0]} max=${ends[1]} step=${step}
          value=${at === null ? (ends[0] + ends[1]) / 2 : shownValue(at, unit)} disabled=${at === null || off}
          aria-label=${`${title}, slider`} aria-valuetext=${told(field, value)} aria-describedby=${`${id}-slider-track`}
          onInput=${turn} onChange=${turn} />
      <//>`
    }
    <button type="button" class="set" id=${`${id}-set`} aria-label=${`Set ${title}`} hidden=${!open || off}
      onClick=${() => form.set(path, firstValue(field), true, id)}>Set</button>
    <input type="text" ...${common(props)} ref=${text} inputmode="decimal" autocomplete="off" spellcheck="false"
      placeholder=${standing === null ? 'not set' : shortNumber(shownValue(standing, unit))} />
  </div>`;
}

const CONTROLS = {
  choice: OneOf,
  boolean: YesNo,
  vertices: Lines,
  numbers: Lines,
  number: Numeric,
  integer: Numeric,
};

/** A value some steps from another, in round numbers of the shown unit and within the limits. @param {Field} field @param {number} from @param {number} steps */
function moved(field, from, steps) {
  const { unit, minimum, maximum } = field;
  const to = Number((shownValue(from, unit) + steps * sliderStep(field, from)).toPrecision(12));
  return Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, to / shownFactor(unit)));
}

/** Movement before a press is a drag, and for a step, px. */
const LEAST_PX = 4;
const STEP_PX = 3;

/** Drags a label left and right to change its number. @param {HTMLElement} label @param {Form} form @param {Field} field */
function dragLabel(label, form, field) {
  /** The value before, and how far it is moved. @type {unknown} */
  let before;
  let steps = 0;
  const from = () => before ?? usual(field);
  const move = (/** @type {boolean} */ final) =>
    form.set(field.field, steps === 0 ? before : moved(field, Number(from()), steps), final);
  drags(label, label, LEAST_PX, {
    press: () => {
      before = form.typed.value(field);
      steps = 0;
      return typeof from() === 'number' && !form.typed.isOff(field);
    },
    drag: ({ x }, start, _, { shiftKey }) => {
      steps = Math.round((x - start.x) / STEP_PX) * (shiftKey ? 10 : 1);
      move(false);
    },
    release: (_, dragged) => dragged && move(true),
    // A finger that scrolls the column away takes the value back with it.
    cancel: (dragged) => {
      steps = 0;
      if (dragged) move(true);
    },
  });
}

// The track of a slider, which shows what is known of its values: a mark, and a row of `/v1/regions`, which has a run of this scene at each of them.

/** A marked value, with its label and its words. @typedef {{at: number, label: unknown, words: string}} Mark */
/** Outcomes of runs: true for one that survives, null where there is no such scene. @typedef {(boolean | null)[]} Outcomes */

/** Cells of a row. */
const CELLS = 96;
/** Bounces of each run: few, so that the map is there at once. */
const BOUNCES = 500;
/** A field that every scene has, for the axis that stands still. */
const STILL = 'gravity';
/** Ranges that the words name. */
const TOLD = 4;

/** The request for a map. @param {import('./typed-scene.js').TypedScene} typed @param {Field} field @param {[number, number]} ends in the unit that the page shows @param {string} scene */
function trackRequest(typed, { field: path, unit }, [from, to], scene) {
  const query = new URLSearchParams(scene);
  const factor = shownFactor(unit);
  // The scene's own value of the field does not matter: the same map serves all of them.
  query.set(`scene.${path}`, String(from / factor));
  const gravity = typed.fields.find(({ field }) => field === STILL);
  const still = gravity && (typed.value(gravity) ?? gravity.default);
  const axes = { x: [path, from / factor, to / factor, CELLS], y: [STILL, still, still, 1] };
  for (const [axis, values] of Object.entries(axes))
    for (const [index, part] of ['field', 'from', 'to', 'count'].entries())
      query.set(`${axis}.${part}`, String(values[index]));
  query.set('bounces', String(BOUNCES));
  return `v1/regions?${query}`;
}

/** The ends of the map that a request is for. @param {string | null} request */
const endsOf = (request) => /x\.from=[^&]*&x\.to=[^&]*/.exec(request ?? '')?.[0];

/** The outcomes of a map; those of the scene before until they are there. @param {string | null} request @returns {Outcomes | null} */
function useOutcomes(request) {
  const { answer, of, problem } = useAnswer(request);
  // A scene without such runs has no map.
  if (!answer || !request || problem || endsOf(of) !== endsOf(request)) return null;
  const none = answer.outcome_names.indexOf('none');
  return answer.values[0].map((/** @type {number | null} */ contacts, /** @type {number} */ cell) =>
    answer.outcomes[0][cell] === none || contacts === null ? null : contacts >= BOUNCES,
  );
}

/** Neighbours of the same outcome. @param {Outcomes} outcomes */
function runsOf(outcomes) {
  /** @type {{kind: boolean | null, first: number, count: number}[]} */
  const runs = [];
  for (const [first, kind] of outcomes.entries()) {
    const last = runs.at(-1);
    if (last?.kind === kind) last.count += 1;
    else runs.push({ kind, first, count: 1 });
  }
  return runs;
}

/** The map in words. @param {Field} field @param {[number, number]} ends @param {ReturnType<typeof runsOf>} runs */
function trackWords({ title, unit }, [from, to], runs) {
  const at = (/** @type {number} */ cell) => number(from + ((to - from) * cell) / (CELLS - 1), 3);
  const ranges = runs
    .filter(({ kind }) => kind)
    .map(({ first, count }) => (count === 1 ? at(first) : `${at(first)} to ${at(first + count - 1)}`));
  if (ranges.length === 0) return `No run lasts ${BOUNCES} bounces on this track.`;
  const more = ranges.length > TOLD ? [`${ranges.length - TOLD} more`] : [];
  const told = [...ranges.slice(0, TOLD), ...more].join(', ');
  const printed = unit === '1' || unit === null ? '' : ` ${shownUnit(unit)}`;
  return `Runs last ${BOUNCES} bounces with ${title.toLowerCase()} ${told}${printed}; hatched values fall.`;
}

/**
 * @param {object} props
 * @param {{typed: import('./typed-scene.js').TypedScene, reset: (field: Field) => void}} props.form
 * @param {Field} props.field
 * @param {[number, number]} props.ends
 * @param {Mark | null} [props.mark] in the slider's numbers
 * @param {string | null} [props.scene] the query of the scene, for a field with a map
 * @param {boolean} props.hollow the field has no value
 * @param {unknown} props.children the slider
 */
function Track({ form, field, ends, mark, scene, hollow, children }) {
  const [from, to] = ends;
  const outcomes = useOutcomes(scene ? trackRequest(form.typed, field, ends, scene) : null);
  const runs = outcomes && runsOf(outcomes);
  const seen = mark && mark.at >= from && mark.at <= to ? mark : null;
  const words = [seen?.words, runs && trackWords(field, ends, runs)].filter(Boolean).join(' ');
  return html`<span class=${`track ${hollow ? 'hollow' : ''} ${runs ? 'known' : ''}`} onDblClick=${() => form.reset(field)}>
    <span class="track-map" aria-hidden="true" hidden=${!runs}>
      ${runs?.map(
        ({ kind, count }) =>
          html`<span class=${kind === null ? 'none' : kind ? 'survives' : 'falls'} style=${{ flexGrow: count }} />`,
      )}
    </span>
    <span class="track-rail" aria-hidden="true" />
    <span class="track-mark" aria-hidden="true" hidden=${!seen}
      style=${{ '--at': seen ? (seen.at - from) / (to - from) : 0 }}>
      <span>${seen?.label}</span>
    </span>
    ${children}
    <span class="unseen" id=${`${idOf(field)}-slider-track`}>${words}</span>
  </span>`;
}
