// Speed, kick, catch and throw under the scene; they come after the first picture. A kick of a chosen size stands in the time line.

import { h } from '../dom/elements.js';
import { steady } from '../form/sliders.js';
import { UNITS, shownUnit, shownValue } from '../dom/units.js';
import { numberInput } from '../dom/number-input.js';
import { number } from '../dom/numbers.js';
import { parse } from '../dom/typed-number.js';
import { FASTEST, SLOWEST } from './interventions.js';

/**
 * @typedef {object} Actions
 * @property {() => void} toggle
 * @property {() => void} step
 * @property {() => void} restart
 * @property {(speed: number) => void} speed
 * @property {(velocities: Record<string, number>) => void} kick
 * @property {() => void} [catchIt] where there is a table to catch with
 * @property {() => void} [throwIt] the same for a throw
 */

const KICKS = [
  { name: 'theta_dot', label: 'spin θ̇', unit: 'rad/s', usual: '0.5' },
  { name: 'x_dot', label: 'sideways ẋ', unit: 'm/s', usual: '0.1' },
  { name: 'y_dot', label: 'upwards ẏ', unit: 'm/s', usual: '0.1' },
];

// The slider of the speed is logarithmic, with 1 where one finds it again.
const SLIDER_STEPS = 100;
const slow = Math.log(SLOWEST);
const span = Math.log(FASTEST) - slow;

/** @param {number} place */
function speedAt(place) {
  const speed = Math.exp(slow + (span * place) / SLIDER_STEPS);
  return Math.abs(Math.log(speed)) < span / SLIDER_STEPS ? 1 : Number(speed.toPrecision(2));
}

/** @type {{sign: string, label: string, name: string, by: 1 | -1}[]} */
const DIRECTIONS = [
  { sign: '←', label: 'Kick to the left', name: 'x_dot', by: -1 },
  { sign: '→', label: 'Kick to the right', name: 'x_dot', by: 1 },
  { sign: '↑', label: 'Kick upwards', name: 'y_dot', by: 1 },
  { sign: '↺', label: 'Kick counter-clockwise', name: 'theta_dot', by: 1 },
  { sign: '↻', label: 'Kick clockwise', name: 'theta_dot', by: -1 },
];

export class RunSliders {
  #speed = h('input', { type: 'range', id: 'speed', min: 0, max: SLIDER_STEPS, step: 1 });
  #speedShown = h('output', { class: 'value', for: 'speed' });
  #kickWhat = h(
    'select',
    { 'aria-label': 'What the kick changes' },
    ...KICKS.map(({ name, label }) => h('option', { value: name }, label)),
  );
  #kickUnit = h('span', { class: 'unit' }, KICKS[0].unit);
  #kickError = h('p', { class: 'error', id: 'kick-error' });
  #kickBy = numberInput({ 'aria-label': 'By how much the kick changes it', value: KICKS[0].usual }, this.#kickError, {
    unit: () => this.#kind.unit,
  });
  #actions;
  #speedSet = 1;
  /** The buttons that act on a run. */
  #buttons;

  /**
   * @param {HTMLElement} root
   * @param {HTMLElement} exact place of the kick's size and direction
   * @param {Actions} actions
   */
  constructor(root, exact, actions) {
    this.#actions = actions;
    steady(this.#speed, () => {
      const speed = this.#speedSet;
      return () => this.setSpeed(speed);
    });
    this.#speed.addEventListener('input', () => this.#showSpeed(speedAt(this.#speed.valueAsNumber)));
    this.#speed.addEventListener('change', () => actions.speed(speedAt(this.#speed.valueAsNumber)));
    this.#kickWhat.addEventListener('change', () => {
      this.blameKick('');
      this.#showKick();
    });
    document.addEventListener(UNITS, () => this.#showKick());
    this.#showKick();
    /** @param {string} id @param {string} name @param {(() => void) | undefined} act */
    const button = (id, name, act) => {
      const click = () => {
        this.blameKick('');
        act?.();
      };
      return act ? [h('button', { type: 'button', id, click }, name)] : [];
    };
    const acts = [
      ...button('kick', 'Kick', () => this.kick()),
      ...button('catch-it', 'Catch', actions.catchIt),
      ...button('throw-it', 'Throw', actions.throwIt),
    ];
    const directions = DIRECTIONS.map(({ sign, label, name, by }) =>
      h('button', { type: 'button', 'aria-label': label, click: () => this.#kickTowards(name, by) }, sign),
    );
    this.#buttons = [...acts, ...directions];
    root.append(
      h('div', { class: 'control speed' }, h('label', { for: 'speed' }, 'Speed'), this.#speed, this.#speedShown),
      h('div', { class: 'acts' }, ...acts),
      this.#kickError,
    );
    exact.append(
      h('div', { class: 'directions', role: 'group', 'aria-label': 'Kick towards' }, ...directions),
      this.#kickWhat,
      this.#kickBy,
      this.#kickUnit,
    );
    this.setSpeed(1);
  }

  /** The chosen kind of kick. */
  get #kind() {
    return KICKS[this.#kickWhat.selectedIndex];
  }

  /** Shows how much a kick changes, in the unit of angles of the page. */
  #showKick() {
    const { usual, unit } = this.#kind;
    this.#kickBy.value = String(Number(shownValue(Number(usual), unit).toPrecision(2)));
    this.#kickUnit.textContent = shownUnit(unit);
  }

  /** @param {number} speed */
  setSpeed(speed) {
    this.#speedSet = speed;
    this.#speed.value = String(Math.round(((Math.log(speed) - slow) / span) * SLIDER_STEPS));
    this.#showSpeed(speed);
  }

  /** @param {number} speed */
  #showSpeed(speed) {
    this.#speedShown.textContent = `×${number(speed, 3)}`;
    this.#speed.setAttribute('aria-valuetext', `${number(speed, 3)} times real time`);
  }

  /** Kicks by as much as is typed. @param {(by: number) => number} [signed] */
  kick(signed = (by) => by) {
    const { name, unit } = this.#kind;
    const by = parse(this.#kickBy.value, unit);
    this.blameKick('');
    if (by !== null) this.#actions.kick({ [name]: signed(by) });
  }

  /** @param {string} name of the velocity @param {1 | -1} sign */
  #kickTowards(name, sign) {
    if (this.#kickWhat.value !== name) {
      this.#kickWhat.value = name;
      this.#showKick();
    }
    this.kick((by) => sign * Math.abs(by));
  }

  /** @param {string} words */
  blameKick(words) {
    this.#kickError.textContent = words;
  }

  /** @param {boolean} live there is a run to kick */
  show(live) {
    for (const button of this.#buttons) button.disabled = !live;
  }
}
