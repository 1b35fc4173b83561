// The controls beside the scene: run, step, speed, gain, kick.

import { aim } from '../form/slider-range.js';
import { h } from '../dom/elements.js';
import { steady } from '../form/steady-slider.js';
import { symbol } from '../dom/typeset.js';
import { fixed, number, parse } from '../dom/numbers.js';
import { FASTEST, SLOWEST } from './speed.js';

/**
 * @typedef {object} Actions
 * @property {() => void} toggle
 * @property {() => void} step
 * @property {() => void} restart
 * @property {(speed: number) => void} speed
 * @property {(gain: number | null, final: boolean) => void} gain
 * @property {(velocities: Record<string, number>) => void} kick
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

export class RunControls {
  #run = h('button', { type: 'button', class: 'primary', id: 'run' }, 'Run');
  #step = h('button', { type: 'button', id: 'step' }, 'Step');
  #restart = h('button', { type: 'button', id: 'restart' }, 'Restart');
  #speed = h('input', { type: 'range', id: 'speed', min: 0, max: SLIDER_STEPS, step: 1 });
  #speedShown = h('output', { class: 'value', for: 'speed' });
  #gain = h('input', { type: 'range', id: 'gain' });
  #gainShown = h('output', { class: 'value', for: 'gain' });
  #gainBox;
  #kick = h('button', { type: 'button', id: 'kick' }, 'Kick');
  #kickWhat = h(
    'select',
    { 'aria-label': 'What the kick changes' },
    ...KICKS.map(({ name, label }) => h('option', { value: name }, label)),
  );
  #kickBy = h('input', {
    type: 'text',
    inputmode: 'decimal',
    autocomplete: 'off',
    'aria-label': 'By how much the kick changes it',
    value: KICKS[0].usual,
  });
  #kickUnit = h('span', { class: 'unit' }, KICKS[0].unit);
  #kickError = h('p', { class: 'error', id: 'kick-error' });
  #actions;
  /** @type {import('../api/scene-fields.js').Field | null} */
  #gainField = null;
  /** @type {number | null} */
  #gainSet = null;
  #speedSet = 1;
  /** The kicks with a direction, once they are there. @type {HTMLButtonElement[]} */
  #directions = [];
  /** The replay of the past; null in the present. @type {'plays' | 'stands' | null} */
  #replay = null;
  /** @type {[import('./run-state.js').Phase, boolean, boolean]} */
  #shown = ['idle', false, false];

  /**
   * @param {HTMLElement} root
   * @param {Actions} actions
   */
  constructor(root, actions) {
    this.#actions = actions;
    this.#run.addEventListener('click', actions.toggle);
    this.#step.addEventListener('click', actions.step);
    this.#restart.addEventListener('click', actions.restart);
    steady(this.#speed, () => {
      const speed = this.#speedSet;
      return () => this.setSpeed(speed);
    });
    steady(this.#gain, () => {
      const gain = this.#gainSet;
      return () => {
        this.setGain(gain);
        this.#actions.gain(gain, false);
      };
    });
    this.#speed.addEventListener('input', () => this.#showSpeed(speedAt(this.#speed.valueAsNumber)));
    this.#speed.addEventListener('change', () => actions.speed(speedAt(this.#speed.valueAsNumber)));
    this.#gain.addEventListener('input', () => this.#gained(false));
    this.#gain.addEventListener('change', () => this.#gained(true));
    this.#kick.addEventListener('click', () => this.kick());
    this.#kickBy.setAttribute('aria-describedby', 'kick-error');
    this.#kickWhat.addEventListener('change', () => {
      const chosen = KICKS[this.#kickWhat.selectedIndex];
      this.#kickBy.value = chosen.usual;
      this.#kickUnit.textContent = chosen.unit;
      this.#kickError.textContent = '';
    });
    this.#gainBox = h(
      'div',
      { class: 'control wide' },
      h('label', { for: 'gain' }, 'Tilt gain ', symbol('κ')),
      this.#gain,
      this.#gainShown,
    );
    const buttons = h('div', { class: 'buttons' }, this.#run, this.#step, this.#restart);
    (document.getElementById('timeline') ?? root).append(buttons);
    root.append(
      this.#gainBox,
      h('div', { class: 'control' }, h('label', { for: 'speed' }, 'Speed'), this.#speed, this.#speedShown),
      h('div', { class: 'control kick' }, this.#kick, this.#kickWhat, this.#kickBy, this.#kickUnit, this.#kickError),
    );
    this.setSpeed(1);
  }

  #gained(/** @type {boolean} */ final) {
    const gain = this.#gain.valueAsNumber;
    this.#gainShown.textContent = fixed(gain, 3);
    this.#gain.setAttribute('aria-valuetext', number(gain));
    this.#actions.gain(gain, final);
  }

  /** @param {import('../api/scene-fields.js').Field | null} field of the tilt gain */
  knowGain(field) {
    this.#gainField = field;
    this.#gainBox.hidden = !field;
  }

  /** @param {number | null} gain */
  setGain(gain) {
    this.#gainSet = gain;
    if (!this.#gainField || (document.activeElement === this.#gain && gain === this.#gain.valueAsNumber)) return;
    aim(this.#gain, this.#gainField, gain);
    this.#gainShown.textContent = fixed(gain, 3);
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

  kick() {
    this.#kickWith((by) => by);
  }

  /** Kicks by as much as is typed. @param {string} name of the velocity @param {1 | -1} sign */
  kickTowards(name, sign) {
    const index = KICKS.findIndex((one) => one.name === name);
    if (index !== this.#kickWhat.selectedIndex) {
      this.#kickWhat.selectedIndex = index;
      this.#kickWhat.dispatchEvent(new Event('change'));
    }
    this.#kickWith((by) => sign * Math.abs(by));
  }

  /** @param {(by: number) => number} signed */
  #kickWith(signed) {
    const { name, unit } = KICKS[this.#kickWhat.selectedIndex];
    const by = parse(this.#kickBy.value, unit);
    this.#kickError.textContent = by === null ? `“${this.#kickBy.value}” is not a number.` : '';
    this.#kickBy.setAttribute('aria-invalid', String(by === null));
    if (by !== null) this.#actions.kick({ [name]: signed(by) });
  }

  /** @param {HTMLButtonElement[]} buttons that kick in a direction */
  offerDirections(buttons) {
    this.#directions = buttons;
    this.#kick.after(h('div', { class: 'directions', role: 'group', 'aria-label': 'Kick towards' }, ...buttons));
    this.show(...this.#shown);
  }

  /** The replay of the past takes the first buttons; null gives them back to the run. @param {'plays' | 'stands' | null} replay */
  replay(replay) {
    if (replay === this.#replay) return;
    this.#replay = replay;
    this.show(...this.#shown);
  }

  /** @param {string} words */
  blameKick(words) {
    this.#kickError.textContent = words;
  }

  /**
   * @param {import('./run-state.js').Phase} phase
   * @param {boolean} waiting parameters were changed that need a restart
   * @param {boolean} ready there is a scene to run
   */
  show(phase, waiting, ready) {
    this.#shown = [phase, waiting, ready];
    const live = phase === 'running' || phase === 'paused';
    this.#run.textContent =
      phase === 'running'
        ? 'Pause'
        : phase === 'paused'
          ? 'Resume'
          : phase === 'ended'
            ? 'Run again'
            : phase === 'idle'
              ? 'Run'
              : 'Connecting…';
    this.#run.disabled = !ready || phase === 'connecting' || phase === 'lost';
    this.#step.disabled = !live;
    this.#restart.disabled = phase === 'idle' || !ready;
    this.#restart.classList.toggle('attention', waiting);
    this.#restart.textContent = waiting ? 'Restart with changes' : 'Restart';
    for (const button of [this.#kick, ...this.#directions]) button.disabled = !live;
    if (this.#replay === null) return;
    this.#run.textContent = this.#replay === 'plays' ? 'Pause' : 'Play';
    this.#run.disabled = false;
    this.#step.disabled = false;
  }
}
