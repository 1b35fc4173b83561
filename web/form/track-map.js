// The map behind a slider: one row of `/v1/regions`, a run of this scene at each of its values.

import { get } from '../api/client.js';
import { LatestRequest } from '../api/latest-request.js';
import { debounce } from '../dom/debounce.js';
import { number } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */

/** Cells of a row. */
const CELLS = 96;
/** Bounces of each run: few, so that the map is there at once. */
const BOUNCES = 500;
/** Wait after a change of the scene, ms. */
const QUIET_MS = 250;
/** A field that every scene has, for the axis that stands still. */
const STILL = 'gravity';
/** Ranges that the words name. */
const TOLD = 4;

/** Runs once the browser has nothing more urgent to do. @param {() => void} run */
const whenIdle = (run) =>
  void ('requestIdleCallback' in globalThis ? requestIdleCallback(run, { timeout: 1000 }) : setTimeout(run, 50));

export class TrackMap {
  #field;
  #form;
  #scene;
  #latest = new LatestRequest();
  /** The request whose answer is shown or on its way. */
  #asked = '';
  /** Asks anew, once the scene has been the same for a moment, where the answer may be another one. */
  renew = debounce(QUIET_MS, () => whenIdle(() => void this.#ask()));

  /**
   * @param {Field} field
   * @param {import('./form.js').Form} form
   * @param {() => URLSearchParams | null} scene as typed; null while some of it is no value, and for one without this field
   */
  constructor(field, form, scene) {
    this.#field = field;
    this.#form = form;
    this.#scene = scene;
  }

  /** The request for the map of a range; null where there is no scene. @param {{from: number, to: number}} range */
  #request({ from, to }) {
    const query = this.#scene();
    if (!query) return null;
    const { field: path, unit } = this.#field;
    const factor = shownFactor(unit);
    // The scene's own value of the field does not matter: the same map serves all of them.
    query.set(`scene.${path}`, String(from / factor));
    const usual = this.#form.typed.fields.find(({ field }) => field === STILL)?.default;
    const still = query.get(`scene.${STILL}`) ?? String(usual);
    const axes = { x: [path, from / factor, to / factor, CELLS], y: [STILL, still, still, 1] };
    for (const [axis, values] of Object.entries(axes))
      for (const [index, part] of ['field', 'from', 'to', 'count'].entries())
        query.set(`${axis}.${part}`, String(values[index]));
    query.set('bounces', String(BOUNCES));
    return `v1/regions?${query}`;
  }

  async #ask() {
    const range = this.#form.rangeOf(this.#field);
    const request = this.#request(range);
    if (request === this.#asked) return;
    if (request === null) return this.#forget();
    this.#asked = request;
    const signal = this.#latest.next();
    try {
      const { values, outcomes, outcome_names: names } = await get(request, signal);
      const none = names.indexOf('none');
      const survived = values[0].map((/** @type {number | null} */ contacts, /** @type {number} */ cell) =>
        outcomes[0][cell] === none || contacts === null ? null : contacts >= BOUNCES,
      );
      this.#form.show(this.#field.field, {
        known: { ...range, outcomes: survived, words: this.#words(survived, range) },
      });
    } catch {
      if (signal.aborted) return;
      // A scene without such runs has no map; a server that was away is asked again with the next change.
      this.#forget();
    }
  }

  #forget() {
    this.#latest.cancel();
    this.#asked = '';
    this.#form.show(this.#field.field, { known: null });
  }

  /** The map in words. @param {(boolean | null)[]} survived @param {{from: number, to: number}} range */
  #words(survived, { from, to }) {
    const { title, unit } = this.#field;
    const at = (/** @type {number} */ cell) => number(from + ((to - from) * cell) / (CELLS - 1), 3);
    /** @type {[number, number][]} */
    const ranges = [];
    survived.forEach((survives, cell) => {
      if (!survives) return;
      const last = ranges.at(-1);
      if (last && last[1] === cell - 1) last[1] = cell;
      else ranges.push([cell, cell]);
    });
    if (ranges.length === 0) return `No run lasts ${BOUNCES} bounces on this track.`;
    const told = ranges.slice(0, TOLD).map(([low, high]) => (low === high ? at(low) : `${at(low)} to ${at(high)}`));
    if (ranges.length > TOLD) told.push(`${ranges.length - TOLD} more`);
    const printed = unit === '1' || unit === null ? '' : ` ${shownUnit(unit)}`;
    return `Runs last ${BOUNCES} bounces with ${title.toLowerCase()} ${told.join(', ')}${printed}; hatched values fall.`;
  }
}
