// Answers of the server that follow the rig: one question at a time, and the newest next.

import { Problem, get, wordsOf } from '../api/client.js';
import { useEffect, useMemo, useState } from '../vendor/preact/preact.js';

/** Time after which a server that did not answer is asked again, ms. */
const AGAIN_MS = 3000;

/**
 * @template A
 * @typedef {object} Answer
 * @property {A | null} answer the newest; null before the first
 * @property {string | null} of the path that it answers
 * @property {boolean} current it answers what is asked now
 * @property {Problem | null} problem of what is asked now
 * @property {string} lost words on a server that does not answer; '' for one that does
 */

/** @typedef {{answer: any, of: string | null, problem: Problem | null, lost: string}} State */

class Follower {
  /** @type {State} */
  #state = { answer: null, of: null, problem: null, lost: '' };
  #set;
  #quiet_ms;
  /** @type {string | null} */
  #wanted = null;
  #busy = false;
  #since = '';
  /** @type {number | undefined} */
  #timer;

  /** @param {(state: State) => void} set @param {number} quiet_ms */
  constructor(set, quiet_ms) {
    this.#set = set;
    this.#quiet_ms = quiet_ms;
  }

  /** @param {string | null} path */
  ask(path) {
    this.#wanted = path;
    clearTimeout(this.#timer);
    if (path === null || this.#busy) return;
    this.#timer = setTimeout(() => void this.#next(), this.#quiet_ms);
  }

  async #next() {
    const path = this.#wanted;
    if (path === null || this.#busy) return;
    this.#busy = true;
    let again = false;
    try {
      const answer = await get(path);
      this.#tell({ answer, of: path, problem: null, lost: '' });
    } catch (error) {
      if (error instanceof Problem) this.#tell({ ...this.#state, of: path, problem: error, lost: '' });
      else {
        this.#since ||= new Date().toLocaleTimeString();
        this.#tell({
          ...this.#state,
          lost: `${wordsOf(error)} It has not since ${this.#since}, and is asked again every ${AGAIN_MS / 1000} s.`,
        });
        again = true;
      }
    } finally {
      this.#busy = false;
    }
    if (again) this.#timer = setTimeout(() => void this.#next(), AGAIN_MS);
    else if (this.#wanted !== path) this.ask(this.#wanted);
  }

  /** @param {State} state */
  #tell(state) {
    if (state.lost === '') this.#since = '';
    this.#state = state;
    this.#set(state);
  }
}

/**
 * The answer to a path, which may change at every frame.
 * @param {string | null} path null while there is nothing to ask
 * @param {number} [quiet_ms] time without a change before it is asked
 * @returns {Answer<any>}
 */
export function useAnswer(path, quiet_ms = 0) {
  const [state, set] = useState(/** @type {State} */ ({ answer: null, of: null, problem: null, lost: '' }));
  const follower = useMemo(() => new Follower(set, quiet_ms), []);
  useEffect(() => follower.ask(path), [path]);
  const current = path !== null && state.of === path && state.lost === '' && state.problem === null;
  return { ...state, current, problem: state.of === path ? state.problem : null };
}
