// The run under way: catch it, throw it, juggle it.

import { h } from '../../dom/elements.js';
import { THROWN } from '../../physics/body.js';
import { numberInput } from '../../dom/number-input.js';
import { parse } from '../../dom/typed-number.js';
import { inWords } from '../../dom/typeset.js';
import { UNITS, shownUnit } from '../../dom/units.js';

/** @typedef {import('../card.js').Guide} Guide */

/** Heights of throws, in distances from contact point to centre of gravity. */
const HEIGHTS = { height: THROWN, low: 1.5, high: THROWN };
/** @typedef {'height' | 'theta' | 'low' | 'high'} Name */

/** @param {Name} name */
const unitOf = (name) => (name === 'theta' ? 'rad' : 'm');

export class LiveCatch {
  element;
  #guide;
  #told = h('p', { id: 'catch-live-told', role: 'status' });
  #error = h('p', { class: 'error', id: 'catch-live-error', role: 'alert' });
  /** @type {Record<Name, HTMLInputElement>} */
  #inputs;
  /** @type {HTMLButtonElement[]} */
  #buttons;

  /**
   * @param {Guide} guide
   * @param {object} around
   * @param {() => Record<string, string | number>} around.settings of the catch
   * @param {(errors: import('contract').ProblemError[]) => string[]} around.blame marks settings, gives the words on others
   * @param {() => void} around.changed
   */
  constructor(guide, { settings, blame, changed }) {
    this.#guide = guide;
    const typed = (/** @type {Name} */ name) =>
      numberInput({ id: `catch-${name}`, change: changed }, this.#error, { unit: unitOf(name), open: true });
    this.#inputs = { height: typed('height'), theta: typed('theta'), low: typed('low'), high: typed('high') };
    const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => void} */ click) =>
      h('button', { type: 'button', id, click }, words);
    const catcher = button('catch-run', 'Catch this run', () => {
      this.#send(() => guide.catchIt(settings()));
    });
    const thrower = button('catch-throw', 'Throw', () => {
      this.#send(() => guide.throwIt({ height: this.#read('height'), theta: this.#read('theta') }));
    });
    const juggler = button('catch-juggle', 'Juggle', () => {
      this.#send(() => guide.juggle([this.#read('low'), this.#read('high')]));
    });
    this.#buttons = [catcher, thrower, juggler];
    const unit = h('span', { class: 'unit' }, shownUnit('rad'));
    document.addEventListener(UNITS, () => {
      unit.textContent = shownUnit('rad');
      this.show();
    });
    const named = (/** @type {Name} */ name, /** @type {string} */ words) => [
      h('label', { for: `catch-${name}` }, words),
      this.#inputs[name],
    ];
    this.element = h(
      'fieldset',
      { class: 'catch-live' },
      h('legend', {}, 'The run under way'),
      h('p', { class: 'study-row' }, catcher, this.#told),
      h(
        'p',
        { class: 'study-row' },
        thrower,
        ...named('height', 'to'),
        h('span', { class: 'unit' }, 'm'),
        ...named('theta', 'at an angle of'),
        unit,
      ),
      h(
        'p',
        { class: 'study-row' },
        juggler,
        ...named('low', 'to'),
        h('span', { class: 'unit' }, 'm'),
        ...named('high', 'and'),
        h('span', { class: 'unit' }, 'm, in turn'),
      ),
      this.#error,
    );
    guide.watch({
      changed: () => this.show(),
      problem: ({ title, detail, errors }) => {
        const others = blame(errors);
        this.#error.textContent = inWords(errors.length > 0 ? others.join(' ') : detail || title);
      },
    });
    this.show();
  }

  /** @param {() => void} send */
  #send(send) {
    this.#error.textContent = '';
    send();
  }

  /** The usual value of an input, for the body of the scene. @param {Name} name */
  #usual(name) {
    return name === 'theta' ? 0 : Number((HEIGHTS[name] * this.#guide.length()).toPrecision(2));
  }

  /** The typed value, or the usual one. @param {Name} name */
  #read(name) {
    return parse(this.#inputs[name].value, unitOf(name)) ?? this.#usual(name);
  }

  /** Shows what can be done now. */
  show() {
    const [live, held] = [this.#guide.live(), this.#guide.held()];
    const [catcher, thrower, juggler] = this.#buttons;
    catcher.disabled = !live || held;
    thrower.disabled = juggler.disabled = !live;
    const words = held
      ? 'The table holds the body. A throw goes on from there.'
      : live
        ? 'Acts from the next strike on.'
        : 'No run is under way.';
    if (this.#told.textContent !== words) this.#told.textContent = words;
    for (const [name, input] of Object.entries(this.#inputs)) {
      const usual = String(this.#usual(/** @type {Name} */ (name)));
      if (input.placeholder !== usual) input.placeholder = usual;
    }
  }

  /** Part of the page’s address. @returns {[string, string][]} */
  query() {
    return Object.entries(this.#inputs).flatMap(([name, input]) => {
      const text = input.value.trim();
      return text ? [/** @type {[string, string]} */ ([`catch.${name}`, text])] : [];
    });
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped */
  restore(link) {
    const dropped = [];
    for (const [name, input] of Object.entries(this.#inputs)) {
      const text = link.get(`catch.${name}`) ?? '';
      const right = text === '' || parse(text, unitOf(/** @type {Name} */ (name))) !== null;
      if (!right) dropped.push(`${name} of the throw “${text.slice(0, 40)}”, which is not a number`);
      input.value = right ? text : '';
    }
    return dropped;
  }
}
