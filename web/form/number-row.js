// The row of a number: its text, its slider on a track, arrow keys, a label that can be dragged, setting and unsetting.

import { debounce } from '../dom/debounce.js';
import { h } from '../dom/elements.js';
import { commits } from '../dom/number-input.js';
import { number, quantity, unitAfter } from '../dom/numbers.js';
import { parse, read, unitsFor } from '../dom/typed-number.js';
import { shownFactor, shownValue } from '../dom/units.js';
import { dragLabel } from './label-drag.js';
import { Row } from './row.js';
import { aim, firstValue, shownRange, sliderStep } from './slider-range.js';
import { steady } from './steady-slider.js';
import { Track } from './track.js';

/** Longest text of a number that is shown whole without focus. */
const SHORT = 8;
const DIGITS = 4;

export class NumberRow extends Row {
  /** None for a number among trillions, which nobody finds with a slider. @type {Track | null} */
  track = null;
  /** The text field. */
  #text;
  /** The field can be left open, and has no usual value then. */
  #optional;
  #unset;
  #set;
  #settle;

  /** @param {import('./row.js').Field} field @param {import('./row.js').Host} host */
  constructor(field, host) {
    const text = h('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', spellcheck: 'false' });
    super(field, host, text);
    this.#text = text;
    this.#optional = field.default == null && !field.required;
    this.#unset = h(
      'button',
      { type: 'button', class: 'icon unset', 'aria-label': `Unset ${field.title}`, hidden: true },
      '×',
    );
    this.#set = h('button', { type: 'button', class: 'set', 'aria-label': `Set ${field.title}`, hidden: true }, 'Set');
    this.head.lastElementChild?.before(this.#unset);
    const row = h('div', { class: 'field-row' }, text);
    this.head.after(row);
    if (field.kind !== 'integer' || (field.maximum ?? Infinity) <= 1e6) {
      const slider = h('input', { type: 'range', id: `${this.id}-slider`, 'aria-label': `${field.title}, slider` });
      row.prepend(slider);
      this.#listenToSlider(slider);
      this.track = new Track(slider);
      this.track.element.addEventListener('dblclick', () => this.reset());
    }
    text.before(this.#set);
    this.#set.addEventListener('click', () => {
      this.set(firstValue(field), true);
      text.focus();
    });
    this.#unset.addEventListener('click', () => {
      this.set(undefined, true);
      this.#set.focus();
    });
    this.#settle = debounce(300, () => host.edited(field.field, true));
    this.#listenToText();
    this.label.addEventListener('dblclick', () => this.reset());
    this.label.classList.add('drags');
    dragLabel(this.label, () => this.#drag());
    this.describe();
  }

  #listenToText() {
    const text = this.#text;
    const finish = commits(
      text,
      (typed) => this.#judge(typed),
      (problem) => this.#refuse(problem),
    );
    text.addEventListener('change', () => {
      this.take(this.#judge(text.value).value, true);
      this.show();
    });
    text.addEventListener('focus', () => {
      this.show();
      text.select();
    });
    text.addEventListener('blur', () => this.show());
    text.addEventListener('keydown', (event) => {
      const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!way || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      finish();
      this.#step(way * (event.shiftKey ? 10 : 1));
    });
  }

  /** @param {HTMLInputElement} slider */
  #listenToSlider(slider) {
    steady(slider, () => {
      const { value } = this;
      return () => this.set(value, false);
    });
    for (const [event, final] of /** @type {const} */ ([
      ['input', false],
      ['change', true],
    ]))
      slider.addEventListener(event, () => {
        const value = parse(slider.value, this.field.unit);
        if (value === null) return;
        this.value = value;
        this.#showText();
        slider.setAttribute('aria-valuetext', quantity(value, this.field.unit));
        this.take(value, final);
      });
  }

  /** The value that stands where none is set. */
  get #usual() {
    return typeof this.field.default === 'number' ? this.field.default : null;
  }

  /** Value, or the usual one. */
  get #number() {
    return typeof this.value === 'number' ? this.value : this.#usual;
  }

  helpWords() {
    const { field } = this;
    const words = super.helpWords();
    if (this.track) {
      const [from, to] = shownRange(field, this.#number);
      words.splice(-1, 0, `Slider: ${number(from)} to ${number(to)}${unitAfter(field.unit)}.`);
    }
    if (field.unit !== '1')
      words.push(`Type ${unitsFor(field.unit)}${field.unit === 'rad' ? ', as in “20°” and “pi/9”' : ''}.`);
    return words;
  }

  /** @param {string} text @returns {import('../dom/typed-number.js').Reading} */
  #judge(text) {
    const { field } = this;
    const { minimum, maximum, unit } = field;
    if (text.trim() === '') return this.host.needs(field) ? { problem: this.missing } : {};
    const isWhole = field.kind === 'integer';
    const { value, problem } = read(text, isWhole ? null : unit);
    const range = this.limits && ` from ${this.limits}`;
    if (value === undefined) return { problem: problem?.replace(/(is not a number)\.$/, `$1${range}.`) };
    if (isWhole && !Number.isInteger(value)) return { problem: `“${text.trim()}” is not a whole number${range}.` };
    if ((minimum == null || value >= minimum) && (maximum == null || value <= maximum)) return { value };
    return { problem: `${quantity(value, unit)} is outside its limits, ${this.limits}.` };
  }

  /** Says why an entry was refused. @param {string | null} problem */
  #refuse(problem) {
    if (problem === null) return this.say(null);
    this.show();
    const back =
      this.value === undefined ? `It is ${this.told(undefined)} again` : `${this.told(this.value)} was put back`;
    const all = `${back}: ${problem}`;
    this.say(all, false);
    this.host.tell(`${this.field.title}: ${all}`);
  }

  /** @param {number} steps */
  #step(steps) {
    const from = this.#number ?? firstValue(this.field);
    this.set(this.#moved(from, steps), false);
    this.#settle();
  }

  /** A value some steps from another, in round numbers of the shown unit and within the limits. @param {number} from @param {number} steps */
  #moved(from, steps) {
    const { field } = this;
    const { unit, minimum, maximum } = field;
    const step = sliderStep(field, from);
    const to = Number((shownValue(from, unit) + steps * step).toPrecision(12));
    return Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, to / shownFactor(unit)));
  }

  #drag() {
    const from = this.value === undefined ? this.#usual : this.value;
    if (typeof from !== 'number' || this.#text.disabled) return null;
    const before = this.value;
    return (/** @type {number} */ steps, /** @type {boolean} */ final) =>
      this.set(steps === 0 ? before : this.#moved(from, steps), final);
  }

  show() {
    this.#showText();
    this.#aim(typeof this.value === 'number' ? this.value : null);
    const open = this.#optional && this.value === undefined;
    this.#set.hidden = !open || this.#text.disabled;
    this.#unset.hidden = !this.#optional || open;
  }

  #showText() {
    const { unit } = this.field;
    const text = this.#text;
    text.placeholder = this.#usual === null ? 'not set' : number(shownValue(this.#usual, unit));
    if (typeof this.value !== 'number') {
      text.value = '';
      text.title = '';
      return;
    }
    const whole = String(shownValue(this.value, unit));
    const short = whole.length > SHORT ? String(Number(shownValue(this.value, unit).toPrecision(DIGITS))) : whole;
    text.value = document.activeElement === text ? whole : short;
    text.title = short === whole ? '' : whole;
  }

  /** @param {number | null} value */
  #aim(value) {
    if (!this.track) return;
    aim(this.track.slider, this.field, value);
    this.track.hollow = value === null && this.#usual === null;
    this.track.refresh();
  }

  /** @param {boolean} off */
  disable(off) {
    super.disable(off);
    this.show();
    if (off && this.track) this.track.slider.disabled = true;
  }

  describe() {
    super.describe();
    if (this.track) this.show();
  }
}
