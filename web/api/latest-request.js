// Requests that follow what changes, one after the other at a pace.

/** Least time between two requests of a kind, ms. */
const PACE_MS = 60;

/** One request at a time, always for the newest. @template T */
export class Follower {
  #ask;
  #pace_ms;
  /** The newest that is not asked for yet. @type {{what: T} | null} */
  #wanted = null;
  #begun_ms = -Infinity;
  /** @type {number | undefined} */
  #timer;
  /** @type {AbortController | null} */
  #request = null;

  /** @param {(what: T, signal: AbortSignal, newest: () => boolean) => Promise<void>} ask @param {number} [pace_ms] */
  constructor(ask, pace_ms = PACE_MS) {
    this.#ask = ask;
    this.#pace_ms = pace_ms;
  }

  /** @param {T} what */
  want(what) {
    this.#wanted = { what };
    this.#next();
  }

  /** Gives up an answer that is out of date, so that the newest is not kept waiting. */
  hurry() {
    if (this.#wanted) this.#request?.abort();
  }

  /** Gives up what is asked for. */
  cancel() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#wanted = null;
    this.#request?.abort();
  }

  #next() {
    if (!this.#wanted || this.#request || this.#timer !== undefined) return;
    const wait_ms = Math.max(0, this.#begun_ms + this.#pace_ms - performance.now());
    this.#timer = setTimeout(async () => {
      this.#timer = undefined;
      const { what } = /** @type {{what: T}} */ (this.#wanted);
      this.#wanted = null;
      this.#begun_ms = performance.now();
      const request = new AbortController();
      this.#request = request;
      await this.#ask(what, request.signal, () => this.#wanted === null);
      this.#request = null;
      this.#next();
    }, wait_ms);
  }
}
