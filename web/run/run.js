// A live run: starts it, ends it and sends it what the page wants.

import { Connection } from './connection.js';
import { RunState } from './run-state.js';

export class Run extends RunState {
  /** @type {Connection | null} */
  #connection = null;

  /**
   * @param {URLSearchParams} query
   * @param {boolean} [whole] a run that is already under way is shown from its first impact
   */
  start(query, whole = true) {
    this.stop();
    this.query = new URLSearchParams(query);
    this.query.delete('from');
    this.clear();
    this.become('connecting');
    this.#connection = new Connection(this, whole, (problem) => {
      // The server may refuse to tell the whole past of a run, and still tell its present.
      if (whole && query.has('epoch_ms')) return this.start(this.query, false);
      this.stop();
      this.watcher.refused(problem);
    });
  }

  stop() {
    this.#connection?.close();
    this.#connection = null;
    this.become('idle');
  }

  /** Ends the run and forgets it. */
  reset() {
    this.stop();
    this.clear();
  }

  retry() {
    this.#connection?.retry();
  }

  toggle() {
    this.#send({ type: this.clock.paused ? 'resume' : 'pause' });
  }

  /** Pauses the run first: only a run that stands still can step. */
  step() {
    if (!this.clock.paused) this.#send({ type: 'pause' });
    this.#send({ type: 'step' });
  }

  /** @param {number} value */
  setSpeed(value) {
    this.#send({ type: 'speed', value });
  }

  /** @param {Record<string, unknown>} values by field path */
  set(values) {
    this.#send({ type: 'set', ...values });
  }

  /** @param {Record<string, number>} velocities */
  kick(velocities) {
    this.#send({ type: 'kick', ...velocities });
  }

  /** @param {Record<string, string | number>} settings of a catch */
  catchIt(settings) {
    this.#send({ type: 'catch', ...settings });
  }

  /** @param {{height: number, theta: number}} apex */
  throwIt(apex) {
    this.#send({ type: 'throw', apex });
  }

  restart() {
    this.#send({ type: 'restart' });
  }

  /** @param {Record<string, unknown>} message */
  #send(message) {
    this.#connection?.send(message);
  }
}
