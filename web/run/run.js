// A live run: starts it, ends it and sends it what the page wants.

import { Problem } from '../api/client.js';
import { RunState } from './run-state.js';

export class Run extends RunState {
  /** @type {import('./connection.js').Connection | null} */
  #connection = null;
  /** Counts the starts: an earlier one may still be loading its code. */
  #starts = 0;

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
    const start = this.#starts;
    const joins = whole && query.has('epoch_ms');
    // The server may refuse to tell the whole past of a run, and still tell its present.
    const refused = (/** @type {Problem} */ problem) => {
      if (joins) this.start(this.query, false);
      else this.#refused(problem);
    };
    import('./connection.js').then(
      ({ Connection }) => {
        if (start === this.#starts) this.#connection = new Connection(this, whole, refused);
      },
      () => {
        if (start === this.#starts) this.#refused(new Problem('Part of the page did not load.', '', [], 0));
      },
    );
  }

  stop() {
    this.#starts += 1;
    this.#connection?.close();
    this.#connection = null;
    this.become('idle');
  }

  /** @param {Problem} problem */
  #refused(problem) {
    this.stop();
    this.watcher.refused(problem);
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
