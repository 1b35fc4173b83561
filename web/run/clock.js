// The server's time and the run's time on this machine, whose own clock may be wrong.

/** @typedef {{now_ms: number, run_time: number, speed: number, paused: boolean}} Reading what hello and every ack carry */

export class Clock {
  // Server time less local time, in ms. A message is late by its way, so the largest difference seen is nearest to the truth.
  #offset_ms = -Infinity;
  /** @type {Reading} */
  #anchor = { now_ms: 0, run_time: 0, speed: 1, paused: true };

  static #local() {
    return performance.timeOrigin + performance.now();
  }

  /** A new connection measures anew: the machine may have slept. */
  forget() {
    this.#offset_ms = -Infinity;
  }

  /** @param {Reading} reading */
  read(reading) {
    this.#offset_ms = Math.max(this.#offset_ms, reading.now_ms - Clock.#local());
    this.#anchor = { now_ms: reading.now_ms, run_time: reading.run_time, speed: reading.speed, paused: reading.paused };
  }

  get speed() {
    return this.#anchor.speed;
  }

  get paused() {
    return this.#anchor.paused;
  }

  /** Seconds since the release, in the run's own time. */
  runTime() {
    const { now_ms, run_time, speed, paused } = this.#anchor;
    if (paused || this.#offset_ms === -Infinity) return run_time;
    return run_time + (Math.max(0, Clock.#local() + this.#offset_ms - now_ms) / 1000) * speed;
  }
}
