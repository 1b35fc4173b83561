// The controls of the run: run and pause, and in the time line step and restart. Speed, kick, catch and throw join them after the first picture.

import { h } from '../dom/elements.js';

/** @typedef {import('./sliders.js').Actions} Actions */

/** The action of the first button. */
const ACTION = {
  idle: 'Run',
  connecting: 'Connecting…',
  running: 'Pause',
  paused: 'Resume',
  lost: 'Connecting…',
  ended: 'Run again',
};

export class RunControls {
  #run;
  #step;
  #restart;
  /** @type {import('./sliders.js').RunSliders | null} */
  #sliders = null;
  #speed = 1;
  /** The replay of the past; null in the present. @type {'plays' | 'stands' | null} */
  #replay = null;
  /** @type {[import('./run-state.js').Phase, boolean, boolean]} */
  #shown = ['idle', false, false];
  actions;

  /**
   * @param {HTMLElement} root
   * @param {HTMLElement} time the time line
   * @param {Actions} actions
   */
  constructor(root, time, actions) {
    this.actions = actions;
    this.#run = h('button', { type: 'button', class: 'primary', id: 'run', click: actions.toggle }, 'Run');
    this.#step = h('button', { type: 'button', id: 'step', click: actions.step }, 'Step');
    this.#restart = h('button', { type: 'button', id: 'restart', click: actions.restart }, 'Restart');
    root.append(this.#run);
    time.append(h('div', { class: 'buttons' }, this.#step, this.#restart));
  }

  /** @param {import('./sliders.js').RunSliders} sliders */
  join(sliders) {
    this.#sliders = sliders;
    sliders.setSpeed(this.#speed);
    this.show(...this.#shown);
  }

  /** @param {number} speed */
  setSpeed(speed) {
    this.#speed = speed;
    this.#sliders?.setSpeed(speed);
  }

  kick() {
    this.#sliders?.kick();
  }

  /** @param {string} words */
  blameKick(words) {
    this.#sliders?.blameKick(words);
  }

  /** The replay of the past takes the first buttons; null gives them back to the run. @param {'plays' | 'stands' | null} replay */
  replay(replay) {
    if (replay === this.#replay) return;
    this.#replay = replay;
    this.show(...this.#shown);
  }

  /**
   * @param {import('./run-state.js').Phase} phase
   * @param {boolean} waiting parameters were changed that need a restart
   * @param {boolean} ready there is a scene to run
   */
  show(phase, waiting, ready) {
    this.#shown = [phase, waiting, ready];
    const live = phase === 'running' || phase === 'paused';
    const past = this.#replay !== null;
    this.#run.textContent = past ? (this.#replay === 'plays' ? 'Pause' : 'Play') : ACTION[phase];
    this.#run.disabled = !past && (!ready || phase === 'connecting' || phase === 'lost');
    this.#step.disabled = !past && !live;
    this.#restart.disabled = phase === 'idle' || !ready;
    this.#restart.classList.toggle('attention', waiting);
    // Another width would move its neighbours.
    this.#restart.title = this.#restart.ariaLabel = waiting ? 'Restart with changes' : 'Restart';
    this.#sliders?.show(live);
  }
}
