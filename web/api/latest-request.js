// Lets only the newest of several requests go on.

export class LatestRequest {
  /** @type {AbortController | null} */
  #controller = null;

  /** Cancels the request before. @returns {AbortSignal} for the next one */
  next() {
    this.cancel();
    this.#controller = new AbortController();
    return this.#controller.signal;
  }

  cancel() {
    this.#controller?.abort();
    this.#controller = null;
  }
}
