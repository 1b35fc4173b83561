// Speed, kick, catch and throw under the scene; they come after the first picture. A kick of a chosen size stands in the time line.

import { byId, h } from '../dom/elements.js';
import { number } from '../dom/numbers.js';
import { parse } from '../dom/typed-number.js';
import { UNITS, shownValue } from '../dom/units.js';
import { steady } from '../form/sliders.js';
import { Choice, NumberField } from '../panels/parts.js';
import { html, render } from '../vendor/preact/preact.js';
import { FASTEST, SLOWEST, VELOCITIES } from './interventions.js';

// The slider of the speed is logarithmic, with 1 where one finds it again.
const STEPS = 100;
const slow = Math.log(SLOWEST);
const span = Math.log(FASTEST) - slow;

/** @param {number} speed */
const placeOf = (speed) => Math.round(((Math.log(speed) - slow) / span) * STEPS);

/** @param {number} place */
function speedAt(place) {
  const speed = Math.exp(slow + (span * place) / STEPS);
  return Math.abs(Math.log(speed)) < span / STEPS ? 1 : Number(speed.toPrecision(2));
}

const CHOICES = Object.fromEntries(Object.entries(VELOCITIES).map(([name, { way, sign }]) => [name, `${way} ${sign}`]));

/** @type {[sign: string, label: string, name: string, by: 1 | -1][]} */
const DIRECTIONS = [
  ['←', 'Kick to the left', 'x_dot', -1],
  ['→', 'Kick to the right', 'x_dot', 1],
  ['↑', 'Kick upwards', 'y_dot', 1],
  ['↺', 'Kick counter-clockwise', 'theta_dot', 1],
  ['↻', 'Kick clockwise', 'theta_dot', -1],
];

/** The usual size of a kick, round in the unit that the page shows. @param {string} name of the velocity */
function usualOf(name) {
  const { usual, unit } = VELOCITIES[name];
  return parse(String(Number(shownValue(usual, unit).toPrecision(2))), unit) ?? usual;
}

export class RunSliders {
  #controls;
  #deeds;
  // Beside elements that others have made.
  #root = h('div', { class: 'contents' });
  #exact = h('div', { class: 'contents' });
  /** The speed as it was drawn last, and the place of its slider, which a hand may have moved since. */
  #speed = NaN;
  #place = 0;
  /** The velocity that a kick changes, and by how much. */
  #name = 'theta_dot';
  #by = usualOf('theta_dot');

  /**
   * @param {HTMLElement} root
   * @param {HTMLElement} exact place of the kick's size and direction
   * @param {import('./controls.js').RunControls} controls
   * @param {{catchIt: () => void, throwIt: () => void}} deeds of the table
   */
  constructor(root, exact, controls, deeds) {
    this.#controls = controls;
    this.#deeds = deeds;
    root.append(this.#root);
    exact.append(this.#exact);
    document.addEventListener(UNITS, () => this.#choose(this.#name));
    this.draw();
  }

  draw() {
    const { speed, live, actions } = this.#controls;
    if (speed !== this.#speed) this.#place = placeOf(speed);
    this.#speed = speed;
    const shown = number(speedAt(this.#place), 3);
    const turn = (/** @type {Event} */ { type, currentTarget }) => {
      this.#place = /** @type {HTMLInputElement} */ (currentTarget).valueAsNumber;
      if (type === 'change') actions.speed(speedAt(this.#place));
      else this.draw();
    };
    const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => void} */ act) => {
      const click = () => {
        this.blame('');
        act();
      };
      return html`<button type="button" id=${id} disabled=${!live} onClick=${click}>${words}</button>`;
    };
    const { unit } = VELOCITIES[this.#name];
    render(
      html`<div class="control speed">
          <label for="speed">Speed</label>
          <input type="range" id="speed" min="0" max=${STEPS} step="1" value=${this.#place} ref=${this.#steady}
            aria-valuetext=${`${shown} times real time`}
            onInput=${turn} onChange=${turn} />
          <output class="value" for="speed">×${shown}</output>
        </div>
        <div class="acts">
          ${button('kick', 'Kick', () => this.kick())}
          ${button('catch-it', 'Catch', this.#deeds.catchIt)}
          ${button('throw-it', 'Throw', this.#deeds.throwIt)}
        </div>
        <p class="error" id="kick-error" role="status" />`,
      this.#root,
    );
    render(
      html`<div class="directions" role="group" aria-label="Kick towards">
          ${DIRECTIONS.map(
            ([sign, label, name, by]) =>
              html`<button type="button" aria-label=${label} disabled=${!live} onClick=${() => this.#kickTowards(name, by)}>${sign}</button>`,
          )}
        </div>
        <${Choice} id="kick-what" label="What the kick changes" value=${this.#name} choices=${CHOICES}
          changed=${(/** @type {string} */ name) => this.#choose(name)} />
        <${NumberField} id="kick-by" label="By how much the kick changes it" unit=${unit} value=${this.#by}
          changed=${(/** @type {number} */ by) => {
            this.#by = by;
          }} />`,
      this.#exact,
    );
  }

  /** @param {HTMLInputElement | null} slider */
  #steady = (slider) => {
    const giveBack = () => {
      this.#place = placeOf(this.#speed);
      this.draw();
    };
    if (slider) steady(slider, () => giveBack);
  };

  /** @param {string} name of the velocity that a kick changes, by its usual size */
  #choose(name) {
    this.#name = name;
    this.#by = usualOf(name);
    this.blame('');
    this.draw();
  }

  /** Kicks by as much as is typed, or by another size. */
  kick(by = this.#by) {
    this.blame('');
    this.#controls.actions.kick({ [this.#name]: by });
  }

  /** @param {string} name of the velocity @param {1 | -1} way */
  #kickTowards(name, way) {
    if (name !== this.#name) this.#choose(name);
    this.kick(way * Math.abs(this.#by));
  }

  /** @param {string} words on what was done last */
  blame(words) {
    byId('kick-error').textContent = words;
  }
}
