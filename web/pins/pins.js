// Up to three runs that stay as references beside the present one: their dots, their outcome, their rods, their place in the address.

import { wordsOf } from '../api/client.js';
import { differences, valueAt } from '../api/scene-fields.js';
import { missing, titlesOf } from '../api/settings.js';
import { sceneOf } from '../app/link.js';
import { play } from '../app/scenes.js';
import { byId } from '../dom/elements.js';
import { number, quantity } from '../dom/numbers.js';
import { UNITS } from '../dom/units.js';
import { endedAs } from '../panels/verdict/words.js';
import { interventionQuery, interventionsOf } from '../run/interventions.js';
import { computedRun } from '../timeline/others.js';
import { html, render } from '../vendor/preact/preact.js';
import { bringParting } from './parting.js';

/** Names and marks. @type {(Pick<Reference, 'symbol' | 'colour'> & {name: string})[]} */
const SLOTS = [
  { name: 'A', symbol: '●', colour: 'series-3' },
  { name: 'B', symbol: '■', colour: 'series-2' },
  { name: 'C', symbol: '▲', colour: 'series-1' },
];

/** Impacts of a pinned run. */
const IMPACTS = 1000;
/** Bytes of path and query that the server takes, less what a run may add to its address later. */
const LINK_BYTES = 8 * 1024 - 1024;

/** A pinned run: the query that means it, and what the server computes for it. */
class Pin {
  /** @type {RunState | null} */
  run = null;
  /** The reason why there is no answer, in words. */
  failure = '';
  /** True while its rod is on the stage of the run. */
  staged = false;
  request = new AbortController();

  /** @param {URLSearchParams} query a scene with interventions @param {Scene} scene the same scene, with what was set only */
  constructor(query, scene) {
    this.query = query;
    this.scene = scene;
    this.interventions = interventionsOf(query);
  }

  async compute() {
    try {
      this.run = await computedRun(this.query, IMPACTS, this.request.signal);
    } catch (error) {
      this.failure = wordsOf(error);
    }
  }
}

/** A part of the address of a pin. @param {number} place @param {URLSearchParams} query */
const part = (place, query) => new URLSearchParams([...query].map(([key, value]) => [`pin.${place}.${key}`, value]));

/** @param {string} key */
const isIntervention = (key) => key.startsWith('interventions.');

/** @param {Page} page */
export function bringPins(page) {
  const parting = bringParting(page.run);
  /** @type {(Pin | null)[]} */
  const pins = SLOTS.map(() => null);
  let told = '';
  /** The runs to drop together. */
  let together = '';

  /** The run with what was done to it, else the typed scene. */
  const played = () => {
    const { run, typed } = page;
    const query = page.playedQuery;
    return query && new Pin(query, structuredClone(run.released ?? typed ?? {}));
  };

  /** Keeps the run, or the typed scene where there is none. */
  const keep = () => {
    const pin = played();
    if (!pin) return say(missing(page.missing[0]));
    const free = pins.indexOf(null);
    const twin = pins.findIndex((other) => other && String(other.query) === String(pin.query));
    if (twin >= 0) return say(`This run is pinned already, as ${SLOTS[twin].name}.`);
    if (free < 0) return say('Three runs at most: remove one, or swap.');
    if (fits(pin)) act(`pin ${SLOTS[free].name}`, () => put(free, pin));
  };

  /** Does something that undo names. @param {string} words @param {() => void} deed */
  const act = (words, deed) => {
    page.history?.record(words);
    deed();
    page.updateAddressSoon();
  };

  /** @param {Pin} pin @returns {boolean} false for a run that the address has no room for; it is said */
  const fits = ({ query }) => {
    const bytes = location.pathname.length + location.search.length + String(part(0, query)).length + 1;
    if (bytes <= LINK_BYTES) return true;
    say(
      `Not pinned: the link would have ${number(bytes, 8)} characters, and there is room for ${number(LINK_BYTES, 8)}. Remove another pin.`,
    );
    return false;
  };

  /** @param {number} place @param {Pin | null} pin */
  const put = async (place, pin) => {
    pins[place]?.request.abort();
    pins[place] = pin;
    told = '';
    show();
    await pin?.compute();
    if (pin && pins[place] === pin) show();
  };

  /** @param {string} words */
  const say = (words) => {
    told = words;
    draw();
  };

  /** Shows the pins in the list, in the planes and on the stage. */
  const show = () => {
    for (const [place, pin] of pins.entries()) {
      const { name: label, symbol, colour } = SLOTS[place];
      const { run, staged = false } = pin ?? {};
      page.others(`pin-${place}`, run ? { run, symbol, colour, label, staged } : null);
    }
    const staged = pins.findIndex((pin) => pin?.staged && pin.run);
    parting.show(pins[staged]?.run ?? null, SLOTS[staged]?.name);
    draw();
  };

  const draw = () => {
    const names = SLOTS.filter((_, place) => pins[place]).map(({ name }) => name);
    const pairs = ['run', ...names].flatMap((one, index) => names.slice(index).map((other) => [one, other]));
    if (!pairs.some((pair) => pair.join(' ') === together)) together = pairs[0]?.join(' ') ?? '';
    const choose = (/** @type {Event} */ event) => {
      together = /** @type {HTMLSelectElement} */ (event.currentTarget).value;
    };
    const tree = html`<div class="pins-head">
        <button type="button" id="pin" onClick=${keep}>Pin</button>
        <p id="pins-told" class="muted" role="status">${
          told || (names.length === 0 && 'keeps this run as a reference: up to three')
        }</p>
        <div class="drop-pair" hidden=${names.length === 0}>
          <select id="drop-pair" aria-label="Runs to drop together" value=${together} onChange=${choose}>
            ${pairs.map(
              ([one, other]) =>
                html`<option value=${`${one} ${other}`}>${one === 'run' ? 'This run' : one} and ${other}</option>`,
            )}
          </select>
          <button type="button" id="double-drop" onClick=${() => dropPair()}>Drop together</button>
        </div>
      </div>
      <ul class="pins-list">${pins.map((pin, place) => pin && row(pin, place))}</ul>`;
    render(tree, byId('pins'));
  };

  /** @param {Pin} pin @param {number} place */
  const row = (pin, place) => {
    const { fields, typed = {} } = page;
    const { name, symbol } = SLOTS[place];
    const { scene, run, interventions } = pin;
    const angles = run?.impacts.column('theta').subarray(0, run.impacts.end);
    const largest = Math.max(...(angles ?? []).map(Math.abs));
    const gain = valueAt(scene, 'table.tilt_gain');
    const others = differences(fields, scene, typed);
    const deeds = interventions.length;
    const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => void} */ act) =>
      html`<button type="button" class=${id} aria-label=${`${words} ${name}`} onClick=${act}>${words}</button>`;
    return html`<li class="pin" data-pin=${name} key=${place}>
      <b class=${`pin-name pin-${name}`}>${name} <span aria-hidden="true">${symbol}</span></b>
      <span class="pin-words">
        ${typeof gain === 'number' && html`<span><i class="symbol">κ</i> ${number(gain)}, </span>`}
        <i class="symbol">e</i> ${number(valueAt(scene, 'contact.restitution') ?? 1)}: <b>${
          run?.outcome ? endedAs(run.outcome.kind, run.outcome.bounces) : pin.failure || 'computing…'
        }</b>${largest >= 0 && `, largest θ ${quantity(largest, 'rad', 3)}`}${
          deeds > 0 && `, with ${deeds === 1 ? 'a change' : `${deeds} changes`} on the way`
        }<span class="muted">${
          others.length === 0 ? '. The scene is the same' : `. Differs in ${titlesOf(others, 4)}`
        }</span>
      </span>
      <span class="pin-acts">
        ${button('back', 'Bring back', () => bringBack(pin))}
        ${button('swap', 'Swap', () => swap(pin, place))}
        <button type="button" class="rod" aria-pressed=${String(pin.staged)} aria-label=${`Rod of ${name} on the stage`}
          onClick=${() => {
            pin.staged = !pin.staged;
            show();
          }}>Rod</button>
        ${button('remove', 'Remove', () => {
          act(`the removal of pin ${name}`, () => put(place, null));
          byId('pin').focus({ preventScroll: true });
        })}
      </span>
    </li>`;
  };

  /** Runs a pinned run again. @param {Pin} pin */
  const bringBack = ({ scene, interventions }) => play(page, scene, interventionQuery(interventions));

  /** The run takes the pin's place, and the pin that of the run. @param {Pin} pin @param {number} place */
  const swap = (pin, place) => {
    const now = played();
    if (!now || !fits(now)) return;
    act(`the swap with pin ${SLOTS[place].name}`, () => {
      bringBack(pin);
      put(place, now);
    });
  };

  /** Releases two runs at once, on one stage. */
  const dropPair = () => {
    const [first, second] = together.split(' ').map((name) => pins[SLOTS.findIndex((one) => one.name === name)]);
    for (const pin of pins) if (pin) pin.staged = pin === second;
    if (first) bringBack(first);
    else if (page.run.phase === 'idle') page.start();
    else page.restart();
    show();
  };

  /** The pins' part of the address. */
  const query = () => new URLSearchParams(pins.flatMap((pin, place) => (pin ? [...part(place, pin.query)] : [])));

  /** @param {URLSearchParams} link @returns {string[]} what was dropped, in words */
  const restore = (link) => {
    const { fields, cases } = page;
    return SLOTS.flatMap(({ name }, place) => {
      const start = `pin.${place}.`;
      const query = new URLSearchParams(
        [...link].filter(([key]) => key.startsWith(start)).map(([key, value]) => [key.slice(start.length), value]),
      );
      if (String(query) === String(pins[place]?.query ?? '')) return [];
      // Interventions are read with the run that they belong to.
      const acted = [...query.keys()].some(isIntervention);
      const named = sceneOf(`?${query}${acted ? '&epoch_ms=0' : ''}`, fields, cases);
      const { preset, changes, run, dropped } = named.link;
      const isScene = preset !== null || Object.keys(changes).length > 0;
      const deeds = interventionQuery(interventionsOf(run ?? new URLSearchParams()));
      const kept = new URLSearchParams([...[...query].filter(([key]) => !isIntervention(key)), ...deeds]);
      put(place, isScene && dropped.length === 0 ? new Pin(kept, named.scene) : null);
      return dropped.map((what) => `of pin ${name}: ${what}`);
    });
  };

  show();
  byId('pins').append(parting.element);
  document.addEventListener(UNITS, draw);
  // The rows tell how the typed scene differs.
  return { pin: keep, query, restore, sceneChanged: draw };
}
