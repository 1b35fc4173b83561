// The past of a run, played, stepped through and scrubbed like a film. Flights are in closed form, so it asks nothing of the server.

import { invalidate } from '../charts/surface.js';

/** @typedef {import('../run/run-state.js').RunState} RunState */

/** Time by which a strike counts as passed, s. */
const PASSED_S = 1e-6;
/** The longest step of a picture; a tab that was hidden goes on from where it was, s. */
const LONGEST_STEP_S = 0.1;

export class Playback {
  /** Time up to which another run is known that is shown beside this one, s. */
  beyond = -Infinity;
  #run;
  #moved;
  /** @type {number | null} */
  #drawn_ms = null;

  /**
   * @param {RunState} run
   * @param {(jumped: boolean) => void} moved the time shown is another one; by a jump or by playing on
   */
  constructor(run, moved) {
    this.#run = run;
    this.#moved = moved;
  }

  get active() {
    return this.#run.past !== null;
  }

  /** The first time that can be shown: the release, as long as its impacts are kept. */
  get begin() {
    const { impacts } = this.#run;
    return impacts.end === 0 || impacts.at('n', impacts.begin) === 1 ? 0 : impacts.at('t', impacts.begin);
  }

  /** The last time that can be shown. */
  get end() {
    const { present, phase } = this.#run;
    return phase === 'ended' ? Math.max(present, this.beyond) : present;
  }

  /** @param {number} t */
  seek(t) {
    const run = this.#run;
    if (!run.scene) return;
    const { begin, end } = this;
    if (t >= end && end <= run.present) return this.toNow();
    run.past = Math.min(end, Math.max(begin, t));
    run.replayed = 0;
    this.#moved(true);
  }

  toNow() {
    const run = this.#run;
    if (run.past === null) return;
    run.past = null;
    run.replayed = 0;
    this.#moved(true);
  }

  /** Goes on or back by so many strikes. @param {number} by */
  step(by) {
    const { impacts, shown } = this.#run;
    const place = impacts.lastUpTo('t', shown + (by > 0 ? PASSED_S : -PASSED_S));
    const next = by > 0 ? place + by : place + by + 1;
    if (next >= impacts.end) return this.toNow();
    this.seek(next < impacts.begin ? this.begin : impacts.at('t', next));
  }

  /** Plays the past at so many times real time; 0 holds it. @param {number} pace */
  play(pace) {
    if (!this.active) return;
    this.#run.replayed = pace;
    this.#drawn_ms = null;
    this.#moved(true);
    invalidate(this);
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    const run = this.#run;
    if (run.past === null || run.replayed === 0) return false;
    const since_s = this.#drawn_ms === null ? 0 : Math.min(LONGEST_STEP_S, (now_ms - this.#drawn_ms) / 1000);
    this.#drawn_ms = now_ms;
    run.past += since_s * run.replayed;
    if (run.past < this.end) this.#moved(false);
    else if (this.end > run.present) this.seek(this.end);
    else this.toNow();
    return run.replayed > 0;
  }
}
