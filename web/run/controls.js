// The controls of the run: run and pause, and in the time line step and restart. Speed, kick, catch and throw join them after the first picture.

import { h } from '../dom/elements.js';

/**
 * @typedef {object} Actions
 * @property {() => void} toggle
 * @property {() => void} step
 * @property {() => void} restart
 * @property {(speed: number) => void} speed
 * @property {(velocities: Record<string, number>) => void} kick
 */

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
  /** @type {{draw: () => void, kick: () => void, blame: (words: string) => void} | null} */
  sliders = null;
  #speed = 1;
  /** There is a run to act on. */
  live = false;
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

  /** Of a run under way, and of those to come, in times real time. */
  get speed() {
    return this.#speed;
  }

  set speed(speed) {
    this.#speed = speed;
    this.sliders?.draw();
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
    this.live = phase === 'running' || phase === 'paused';
    const past = this.#replay !== null;
    this.#run.textContent = past ? (this.#replay === 'plays' ? 'Pause' : 'Play') : ACTION[phase];
    this.#run.disabled = !past && (!ready || phase === 'connecting' || phase === 'lost');
    this.#step.disabled = !past && !this.live;
    this.#restart.disabled = phase === 'idle' || !ready;
    this.#restart.classList.toggle('attention', waiting);
    // Another width would move its neighbours.
    this.#restart.title = this.#restart.ariaLabel = waiting ? 'Restart with changes' : 'Restart';
    this.sliders?.draw();
  }
}
