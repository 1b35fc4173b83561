// The controls of the run: run and pause, and in the time line step and restart. Speed, kick, catch and throw join them after the first picture.

import { h } from '../dom/elements.js';

/** @typedef {import('./sliders.js').Actions} Actions */

export class RunControls {
  #run = h('button', { type: 'button', class: 'primary', id: 'run' }, 'Run');
  #step = h('button', { type: 'button', id: 'step' }, 'Step');
  #restart = h('button', { type: 'button', id: 'restart' }, 'Restart');
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
    this.#run.addEventListener('click', actions.toggle);
    this.#step.addEventListener('click', actions.step);
    this.#restart.addEventListener('click', actions.restart);
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
    // Another width would move its neighbours.
    this.#restart.title = this.#restart.ariaLabel = waiting ? 'Restart with changes' : 'Restart';
    this.#sliders?.show(live);
    if (this.#replay === null) return;
    this.#run.textContent = this.#replay === 'plays' ? 'Pause' : 'Play';
    this.#run.disabled = false;
    this.#step.disabled = false;
  }
}
