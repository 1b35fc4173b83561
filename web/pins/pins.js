// Up to three runs that stay as references beside the present one: their dots, their outcome, their rods, their place in the address.

import { get, wordsOf } from '../api/client.js';
import { differences, valueAt } from '../api/scene-fields.js';
import { merged } from '../api/scene-query.js';
import { missing, titlesOf } from '../api/settings.js';
import { playedQuery, updateAddressSoon } from '../app/address-bar.js';
import { readLink } from '../app/link.js';
import { restart, start } from '../app/run-actions.js';
import { play } from '../app/scenes.js';
import { number, quantity } from '../dom/numbers.js';
import { UNITS } from '../dom/units.js';
import { endedAs } from '../panels/verdict/words.js';
import { interventionQuery, interventionsOf } from '../run/interventions.js';
import { recordedRun } from '../timeline/others.js';
import { html, render } from '../vendor/preact/preact.js';
import { Parting } from './parting.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/** @type {{name: string, sign: string, colour: import('../scene/bodies.js').RodColour}[]} */
const SLOTS = [
  { name: 'A', sign: '●', colour: 'series-3' },
  { name: 'B', sign: '■', colour: 'series-2' },
  { name: 'C', sign: '▲', colour: 'series-1' },
];

/** Impacts of a pinned run. */
const IMPACTS = 1000;
/** Bytes of path and query that the server takes, less what a run may add to its address later. */
const LINK_BYTES = 8 * 1024 - 1024;

/** A pinned run: the query that means it, and what the server computes for it. */
class Pin {
  /** @type {import('contract').Trajectory | null} */
  answer = null;
  /** @type {import('../run/run-state.js').RunState | null} */
  run = null;
  /** Largest |θ| at an impact, rad; null for a point mass. @type {number | null} */
  largest = null;
  /** The reason why there is no answer, in words. */
  failure = '';
  /** True while its rod is on the stage of the run. */
  staged = false;
  request = new AbortController();
  query;
  scene;
  interventions;

  /** @param {URLSearchParams} query a scene with interventions @param {Scene} scene the same scene, with what was set only */
  constructor(query, scene) {
    this.query = query;
    this.scene = scene;
    this.interventions = interventionsOf(query);
  }

  async compute() {
    try {
      const answer = await get(`v1/trajectories?${this.query}&bounces=${IMPACTS}`, this.request.signal);
      this.answer = answer;
      this.run = recordedRun(answer, this.interventions);
      const angles = answer.impacts.theta.filter((/** @type {number | null} */ theta) => theta !== null);
      this.largest = angles.length > 0 ? Math.max(...angles.map(Math.abs)) : null;
    } catch (error) {
      this.failure = wordsOf(error);
    }
  }
}

/** A part of the address of a pin. @param {number} place @param {URLSearchParams} query */
const part = (place, query) => new URLSearchParams([...query].map(([key, value]) => [`pin.${place}.${key}`, value]));

export class Pins {
  #root;
  #page;
  #others;
  #parting;
  /** @type {(Pin | null)[]} */
  #pins = SLOTS.map(() => null);
  #told = '';
  /** The runs to drop together. */
  #pair = '';

  /** @param {HTMLElement} root @param {import('../app/page.js').Page} page @param {import('../timeline/others.js').Others} others */
  constructor(root, page, others) {
    this.#root = root;
    this.#page = page;
    this.#others = others;
    this.#parting = new Parting(page.run);
    this.#show();
    root.append(this.#parting.element);
    const redraw = () => this.#parting.redraw();
    page.run.watch({ changed: redraw, struck: redraw, moved: redraw, cleared: () => this.#parting.forget() });
    document.addEventListener(UNITS, () => {
      this.#render();
      redraw();
    });
  }

  /** The typed scene is another one. */
  sceneChanged() {
    this.#render();
  }

  /** The run with what was done to it, else the typed scene. */
  get #played() {
    const { run, typed } = this.#page;
    const query = playedQuery(this.#page);
    return query && new Pin(query, structuredClone(run.released ?? typed ?? {}));
  }

  /** Keeps the run, or the typed scene where there is none. */
  pin() {
    const pin = this.#played;
    if (!pin) return this.#say(missing(this.#page.missing[0]));
    const free = this.#pins.indexOf(null);
    const twin = this.#pins.findIndex((other) => other && String(other.query) === String(pin.query));
    if (twin >= 0) return this.#say(`This run is pinned already, as ${SLOTS[twin].name}.`);
    if (free < 0) return this.#say('Three runs at most: remove one, or swap.');
    if (!this.#fits(pin)) return;
    this.#page.history?.record(`pin ${SLOTS[free].name}`);
    this.#put(free, pin);
    updateAddressSoon(this.#page);
  }

  /** @param {Pin} pin @returns {boolean} false for a run that the address has no room for; it is said */
  #fits({ query }) {
    const bytes = location.pathname.length + location.search.length + String(part(0, query)).length + 1;
    if (bytes <= LINK_BYTES) return true;
    this.#say(
      `Not pinned: the link would have ${number(bytes, 8)} characters, and there is room for ${number(LINK_BYTES, 8)}. Remove another pin.`,
    );
    return false;
  }

  /** @param {number} place @param {Pin | null} pin */
  async #put(place, pin) {
    this.#pins[place]?.request.abort();
    this.#pins[place] = pin;
    this.#told = '';
    this.#show();
    await pin?.compute();
    if (pin && this.#pins[place] === pin) this.#show();
  }

  /** @param {string} words */
  #say(words) {
    this.#told = words;
    this.#render();
  }

  /** Shows the pins in the list, in the planes and on the stage. */
  #show() {
    for (const [place, pin] of this.#pins.entries()) {
      const { name, sign, colour } = SLOTS[place];
      const { run, staged = false } = pin ?? {};
      this.#others.set(`pin-${place}`, run ? { run, symbol: sign, colour, label: name, staged } : null);
    }
    const staged = this.#pins.findIndex((pin) => pin?.staged && pin.run);
    this.#parting.show(this.#pins[staged]?.run ?? null, SLOTS[staged]?.name);
    this.#render();
  }

  #render() {
    const names = SLOTS.filter((_, place) => this.#pins[place]).map(({ name }) => name);
    const pairs = [
      ...names.map((name) => ['run', name]),
      ...names.flatMap((one, index) => names.slice(index + 1).map((other) => [one, other])),
    ];
    if (!pairs.some((pair) => pair.join(' ') === this.#pair)) this.#pair = pairs[0]?.join(' ') ?? '';
    const choose = (/** @type {Event} */ event) => {
      this.#pair = /** @type {HTMLSelectElement} */ (event.currentTarget).value;
    };
    const tree = html`<div class="pins-head">
        <button type="button" id="pin" onClick=${() => this.pin()}>Pin</button>
        <p id="pins-told" class="muted" role="status">${
          this.#told || (names.length === 0 && 'keeps this run as a reference: up to three')
        }</p>
        <div class="drop-pair" hidden=${names.length === 0}>
          <select id="drop-pair" aria-label="Runs to drop together" value=${this.#pair} onChange=${choose}>
            ${pairs.map(
              ([one, other]) =>
                html`<option value=${`${one} ${other}`}>${one === 'run' ? 'This run' : one} and ${other}</option>`,
            )}
          </select>
          <button type="button" id="double-drop" onClick=${() => this.#dropPair()}>Drop together</button>
        </div>
      </div>
      <ul class="pins-list">${this.#pins.map((pin, place) => pin && this.#row(pin, place))}</ul>`;
    render(tree, this.#root);
  }

  /** @param {Pin} pin @param {number} place */
  #row(pin, place) {
    const { fields, typed = {} } = this.#page;
    const { name, sign } = SLOTS[place];
    const gain = valueAt(pin.scene, 'table.tilt_gain');
    const others = differences(fields, pin.scene, typed);
    const deeds = pin.interventions.length;
    const outcome = pin.answer
      ? endedAs(pin.answer.outcome.kind, pin.answer.outcome.bounces)
      : pin.failure || 'computing…';
    const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => void} */ act) =>
      html`<button type="button" class=${id} aria-label=${`${words} ${name}`} onClick=${act}>${words}</button>`;
    return html`<li class="pin" data-pin=${name} key=${place}>
      <b class=${`pin-name pin-${name}`}>${name} <span aria-hidden="true">${sign}</span></b>
      <span class="pin-words">
        ${typeof gain === 'number' && html`<span><i class="symbol">κ</i> ${number(gain)}, </span>`}
        <i class="symbol">e</i> ${number(valueAt(pin.scene, 'contact.restitution') ?? 1)}: <b>${outcome}</b>${
          pin.largest !== null && `, largest θ ${quantity(pin.largest, 'rad', 3)}`
        }${deeds > 0 && `, with ${deeds === 1 ? 'a change' : `${deeds} changes`} on the way`}<span class="muted">${
          others.length === 0 ? '. The scene is the same' : `. Differs in ${titlesOf(others, 4)}`
        }</span>
      </span>
      <span class="pin-acts">
        ${button('back', 'Bring back', () => this.#bringBack(pin))}
        ${button('swap', 'Swap', () => this.#swap(pin, place))}
        <button type="button" class="rod" aria-pressed=${String(pin.staged)} aria-label=${`Rod of ${name} on the stage`}
          onClick=${() => this.#stage(pin)}>Rod</button>
        ${button('remove', 'Remove', () => this.#remove(place))}
      </span>
    </li>`;
  }

  /** @param {number} place */
  #remove(place) {
    this.#page.history?.record(`the removal of pin ${SLOTS[place].name}`);
    this.#put(place, null);
    updateAddressSoon(this.#page);
    document.getElementById('pin')?.focus({ preventScroll: true });
  }

  /** @param {Pin} pin */
  #stage(pin) {
    pin.staged = !pin.staged;
    this.#show();
  }

  /** Runs a pinned run again. @param {Pin} pin */
  #bringBack(pin) {
    const page = this.#page;
    play(page, pin.scene);
    if (pin.interventions.length === 0) return;
    const query = new URLSearchParams(pin.query);
    query.set('speed', String(page.speed));
    page.run.start(query);
  }

  /** The run takes the pin's place, and the pin that of the run. @param {Pin} pin @param {number} place */
  #swap(pin, place) {
    const played = this.#played;
    if (!played || !this.#fits(played)) return;
    this.#page.history?.record(`the swap with pin ${SLOTS[place].name}`);
    this.#bringBack(pin);
    this.#put(place, played);
    updateAddressSoon(this.#page);
  }

  /** Releases two runs at once, on one stage. */
  #dropPair() {
    const [first, second] = this.#pair
      .split(' ')
      .map((name) => this.#pins[SLOTS.findIndex((one) => one.name === name)]);
    for (const pin of this.#pins) if (pin) pin.staged = pin === second;
    if (first) this.#bringBack(first);
    else if (this.#page.run.phase === 'idle') start(this.#page);
    else restart(this.#page);
    this.#show();
  }

  /** The pins' part of the address. */
  query() {
    return new URLSearchParams(this.#pins.flatMap((pin, place) => (pin ? [...part(place, pin.query)] : [])));
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped, in words */
  restore(link) {
    const { fields, cases } = this.#page;
    return SLOTS.flatMap(({ name }, place) => {
      const start = `pin.${place}.`;
      const query = new URLSearchParams(
        [...link].filter(([key]) => key.startsWith(start)).map(([key, value]) => [key.slice(start.length), value]),
      );
      if (String(query) === String(this.#pins[place]?.query ?? '')) return [];
      // Interventions are read with the run that they belong to.
      const acted = [...query.keys()].some((key) => key.startsWith('interventions.'));
      const { preset, changes, run, dropped } = readLink(`?${query}${acted ? '&epoch_ms=0' : ''}`, fields, cases);
      const one = cases.find((other) => other.name === preset);
      const isScene = one || Object.keys(changes).length > 0;
      const kept = new URLSearchParams([...query].filter(([key]) => !key.startsWith('interventions.')));
      for (const [key, value] of interventionQuery(interventionsOf(run ?? new URLSearchParams()))) kept.set(key, value);
      this.#put(place, isScene && dropped.length === 0 ? new Pin(kept, merged(one?.scene ?? {}, changes)) : null);
      return dropped.map((what) => `of pin ${name}: ${what}`);
    });
  }
}
