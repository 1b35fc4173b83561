// Up to three runs that stay as references beside the present one: their dots, their outcome, their rods, their place in the address.

import { wordsOf } from '../api/client.js';
import { valueAt } from '../api/scene-fields.js';
import { h } from '../dom/elements.js';
import { number, quantity } from '../dom/numbers.js';
import { symbol } from '../dom/typeset.js';
import { UNITS } from '../dom/units.js';
import { endedAs } from '../panels/verdict/plain-words.js';
import { Parting } from './parting.js';
import { Pin, readPin } from './pin.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {{name: string, sign: string, colour: import('../scene/bodies.js').RodColour}} Slot */

/**
 * @typedef {object} PinsPage
 * @property {import('../api/scene-fields.js').Field[]} fields
 * @property {import('contract').Preset[]} cases
 * @property {import('../run/run.js').Run} run
 * @property {import('../timeline/others.js').Others} others
 * @property {() => Scene} typed
 * @property {() => {query: URLSearchParams, scene: Scene} | null} played the run with what was done to it, else the typed scene
 * @property {(pin: Pin) => void} bringBack runs a pinned run again
 * @property {() => void} drop releases the run anew
 * @property {(label: string) => void} record the state before an edit, for undo
 * @property {() => void} changed the address
 */

/** @type {Slot[]} */
const SLOTS = [
  { name: 'A', sign: '●', colour: 'series-3' },
  { name: 'B', sign: '■', colour: 'series-2' },
  { name: 'C', sign: '▲', colour: 'series-1' },
];

/** Bytes of path and query that the server takes, less what a run may add to its address later. */
const LINK_BYTES = 8 * 1024 - 1024;

export class Pins {
  #page;
  /** @type {(Pin | null)[]} */
  #pins = SLOTS.map(() => null);
  #pin = h('button', { type: 'button', id: 'pin', click: () => this.pin() }, 'Pin');
  #told = h('p', { id: 'pins-told', class: 'muted', role: 'status' });
  #list = h('ul', { class: 'pins-list' });
  #pair = h('select', { id: 'drop-pair', 'aria-label': 'Runs to drop together' });
  #drop = h('button', { type: 'button', id: 'double-drop', click: () => this.#dropPair() }, 'Drop together');
  #dropBox = h('div', { class: 'drop-pair', hidden: true }, this.#pair, this.#drop);
  #parting;
  /** @type {WeakMap<Pin, AbortController>} */
  #requests = new WeakMap();

  /** @param {HTMLElement} root @param {PinsPage} page */
  constructor(root, page) {
    this.#page = page;
    this.#parting = new Parting(page.run);
    root.append(
      h('div', { class: 'pins-head' }, this.#pin, this.#told, this.#dropBox),
      this.#list,
      this.#parting.element,
    );
    page.run.watch({
      changed: () => this.#parting.redraw(),
      struck: () => this.#parting.redraw(),
      cleared: () => this.#parting.forget(),
    });
    document.addEventListener(UNITS, () => {
      this.sceneChanged();
      this.#parting.redraw();
    });
    this.#show();
  }

  /** The time shown is another one. */
  moved() {
    this.#parting.redraw();
  }

  /** The typed scene is another one. */
  sceneChanged() {
    this.#list.replaceChildren(...this.#rows());
  }

  /** Keeps the run, or the typed scene where there is none. */
  pin() {
    const played = this.#page.played();
    if (!played) return this.#say('A setting is no number.');
    const free = this.#pins.indexOf(null);
    const twin = this.#pins.findIndex((pin) => pin?.query.toString() === played.query.toString());
    if (twin >= 0) return this.#say(`This run is pinned already, as ${SLOTS[twin].name}.`);
    if (free < 0) return this.#say('Three runs at most: remove one, or swap.');
    if (!this.#fits(played.query)) return;
    this.#page.record(`pin ${SLOTS[free].name}`);
    this.#put(free, new Pin(played.query, played.scene));
    this.#page.changed();
  }

  /** @param {URLSearchParams} query @returns {boolean} false for a run that the address has no room for; it is said */
  #fits(query) {
    const bytes = location.pathname.length + location.search.length + part(0, query).toString().length + 1;
    if (bytes <= LINK_BYTES) return true;
    this.#say(
      `Not pinned: the link would have ${number(bytes, 8)} characters, and there is room for ${number(LINK_BYTES, 8)}. Remove another pin.`,
    );
    return false;
  }

  /** @param {number} place @param {Pin | null} pin */
  #put(place, pin) {
    const before = this.#pins[place];
    if (before) this.#requests.get(before)?.abort();
    this.#pins[place] = pin;
    this.#page.others.set(`pin-${place}`, null);
    this.#say('');
    this.#show();
    if (pin) void this.#compute(place, pin);
  }

  /** @param {number} place @param {Pin} pin */
  async #compute(place, pin) {
    const request = new AbortController();
    this.#requests.set(pin, request);
    try {
      pin.failure = '';
      await pin.compute(request.signal);
    } catch (error) {
      if (request.signal.aborted) return;
      pin.failure = wordsOf(error);
    }
    if (this.#pins[place] === pin) this.#show();
  }

  /** @param {string} words */
  #say(words) {
    const count = this.#pins.filter((pin) => pin).length;
    this.#told.textContent = words || (count === 0 ? 'keeps this run as a reference: up to three' : '');
  }

  #show() {
    if (this.#told.textContent === '') this.#say('');
    this.#pins.forEach((pin, place) => {
      const { run, answer } = pin ?? {};
      const { name, sign, colour } = SLOTS[place];
      this.#page.others.set(
        `pin-${place}`,
        run && answer && pin
          ? {
              run,
              columns: /** @type {Record<string, (number | null)[]>} */ (/** @type {unknown} */ (answer.impacts)),
              symbol: sign,
              colour,
              label: name,
              staged: pin.staged,
            }
          : null,
      );
    });
    this.#list.replaceChildren(...this.#rows());
    const names = SLOTS.filter((_, place) => this.#pins[place]).map(({ name }) => name);
    const pairs = [
      ...names.map((name) => ['run', name]),
      ...names.flatMap((one, index) => names.slice(index + 1).map((other) => [one, other])),
    ];
    const chosen = this.#pair.value;
    this.#dropBox.hidden = names.length === 0;
    this.#pair.replaceChildren(
      ...pairs.map(([one, other]) =>
        h('option', { value: `${one} ${other}` }, `${one === 'run' ? 'This run' : one} and ${other}`),
      ),
    );
    if (pairs.some((pair) => pair.join(' ') === chosen)) this.#pair.value = chosen;
    const staged = this.#pins.findIndex((pin) => pin?.staged && pin.run);
    this.#parting.show(this.#pins[staged]?.run ?? null, SLOTS[staged]?.name);
  }

  #rows() {
    return this.#pins.flatMap((pin, place) => (pin ? [this.#row(pin, place)] : []));
  }

  /** @param {Pin} pin @param {number} place */
  #row(pin, place) {
    const { fields, typed } = this.#page;
    const { name, sign } = SLOTS[place];
    const gain = valueAt(pin.scene, 'table.tilt_gain');
    const others = pin.differences(typed(), fields).map((field) => field.title.toLowerCase());
    const rest = others.length > 4 ? ` and ${others.length - 4} more` : '';
    const deeds = pin.interventions.length;
    const outcome = pin.answer
      ? endedAs(pin.answer.outcome.kind, pin.answer.outcome.bounces)
      : pin.failure || 'computing…';
    /** @param {string} words @param {string} id @param {() => void} act @param {Record<string, any>} [more] */
    const button = (words, id, act, more = {}) =>
      h('button', { type: 'button', class: id, 'aria-label': `${words} ${name}`, click: act, ...more }, words);
    return h(
      'li',
      { class: 'pin', 'data-pin': name },
      h('b', { class: `pin-name pin-${name}` }, `${name} `, h('span', { 'aria-hidden': 'true' }, sign)),
      h(
        'span',
        { class: 'pin-words' },
        typeof gain === 'number' && h('span', {}, symbol('κ'), ` ${number(gain)}, `),
        h('span', {}, symbol('e'), ` ${number(valueAt(pin.scene, 'contact.restitution') ?? 1)}: `),
        h('b', {}, outcome),
        pin.largest === null ? '' : `, largest θ ${quantity(pin.largest, 'rad', 3)}`,
        deeds === 0 ? '' : `, with ${deeds === 1 ? 'a change' : `${deeds} changes`} on the way`,
        h(
          'span',
          { class: 'muted' },
          others.length === 0 ? '. The scene is the same' : `. Differs in ${others.slice(0, 4).join(', ')}${rest}`,
        ),
      ),
      h(
        'span',
        { class: 'pin-acts' },
        button('Bring back', 'back', () => this.#bringBack(place)),
        button('Swap', 'swap', () => this.#swap(place)),
        button('Rod', 'rod', () => this.#stage(place, !pin.staged), {
          'aria-pressed': String(pin.staged),
          'aria-label': `Rod of ${name} on the stage`,
        }),
        button('Remove', 'remove', () => this.#remove(place)),
      ),
    );
  }

  /** @param {number} place @param {string} act */
  #focus(place, act) {
    const name = SLOTS[place].name;
    const button = this.#list.querySelector(`[data-pin="${name}"] .${act}`) ?? this.#pin;
    /** @type {HTMLElement} */ (button).focus({ preventScroll: true });
  }

  /** @param {number} place */
  #remove(place) {
    this.#page.record(`the removal of pin ${SLOTS[place].name}`);
    this.#put(place, null);
    this.#page.changed();
    this.#pin.focus({ preventScroll: true });
  }

  /** @param {number} place @param {boolean} staged */
  #stage(place, staged) {
    const pin = this.#pins[place];
    if (!pin) return;
    pin.staged = staged;
    this.#show();
    this.#focus(place, 'rod');
  }

  /** @param {number} place */
  #bringBack(place) {
    const pin = this.#pins[place];
    if (!pin) return;
    this.#page.bringBack(pin);
    this.#focus(place, 'back');
  }

  /** The run takes the pin's place, and the pin that of the run. @param {number} place */
  #swap(place) {
    const pin = this.#pins[place];
    const played = this.#page.played();
    if (!pin || !played || !this.#fits(played.query)) return;
    this.#page.record(`the swap with pin ${SLOTS[place].name}`);
    this.#page.bringBack(pin);
    this.#put(place, new Pin(played.query, played.scene));
    this.#page.changed();
    this.#focus(place, 'swap');
  }

  /** Releases two runs at once, on one stage. */
  #dropPair() {
    const [one, other] = this.#pair.value.split(' ');
    const place = SLOTS.findIndex(({ name }) => name === other);
    const first = this.#pins[SLOTS.findIndex(({ name }) => name === one)];
    this.#pins.forEach((pin, index) => {
      if (pin) pin.staged = index === place;
    });
    if (first) this.#page.bringBack(first);
    else this.#page.drop();
    this.#show();
    this.#drop.focus({ preventScroll: true });
  }

  /** The pins' part of the address. */
  query() {
    return new URLSearchParams(this.#pins.flatMap((pin, place) => (pin ? [...part(place, pin.query)] : [])));
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped, in words */
  restore(link) {
    const { fields, cases } = this.#page;
    /** @type {string[]} */
    const dropped = [];
    SLOTS.forEach(({ name }, place) => {
      const start = `pin.${place}.`;
      const query = new URLSearchParams(
        [...link].filter(([key]) => key.startsWith(start)).map(([key, value]) => [key.slice(start.length), value]),
      );
      if (query.toString() === (this.#pins[place]?.query.toString() ?? '')) return;
      const { pin, dropped: lost } = readPin(query, fields, cases);
      dropped.push(...lost.map((what) => `of pin ${name}: ${what}`));
      this.#put(place, pin);
    });
    return dropped;
  }
}

/** @param {number} place @param {URLSearchParams} query */
const part = (place, query) => new URLSearchParams([...query].map(([key, value]) => [`pin.${place}.${key}`, value]));
