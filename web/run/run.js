// A live run: starts it, ends it and sends it what the page wants.

import { Connection } from './connection.js';
import { RunState } from './run-state.js';

export class Run extends RunState {
  /** @type {Connection | null} */
  #connection = null;
  /** The kind of the message sent last: a problem that comes back is about it. */
  sent = '';

  /** True when that was a catch or a throw. */
  get guided() {
    return this.sent === 'catch' || this.sent === 'throw';
  }

  /**
   * @param {URLSearchParams} query
   * @param {boolean} [whole] a run that is already under way is shown from its first impact
   */
  start(query, whole = true) {
    this.stop();
    this.query = new URLSearchParams(query);
    this.query.delete('from');
    this.clear();
    this.sent = '';
    this.become('connecting');
    this.#connection = new Connection(this, whole, (problem) => {
      // The server may refuse to tell the whole past of a run, and still tell its present.
      if (whole && query.has('epoch_ms')) return this.start(this.query, false);
      this.stop();
      this.tell('refused', problem);
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

  /** Sends a message to the run, where there is a connection. @param {{type: string} & Record<string, unknown>} message */
  send(message) {
    this.sent = message.type;
    this.#connection?.send(message);
  }
}
