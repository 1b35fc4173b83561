// Asks the server: answers that follow the page, one question at a time and the newest next; and work that takes it a while, one piece at a
// time, with its progress, its cancelling, and its failure in words.

import { lines } from '../api/answers.js';
import { Problem, asProblem, get, wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { invalidate } from '../charts/surface.js';
import { number } from '../dom/numbers.js';
import { html, useEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';
import { useKeptFocus, words } from './parts.js';

/** Time without a change before it is asked, ms: nobody needs an answer at each turn of a knob. */
export const QUIET_MS = 300;
/** Time after which a server that did not answer is asked again, ms. */
const AGAIN_MS = 3000;

/** @typedef {{answer: any, of: string | null, problem: Problem | null, lost: string}} State */

/** @param {(change: (before: State) => State) => void} set @param {number} quiet_ms @param {(path: string) => Promise<any>} ask */
function follower(set, quiet_ms, ask) {
  /** @type {string | null} */
  let wanted = null;
  let since = '';
  let timer = 0;
  /** @type {Follower<string>} */
  const asks = new Follower(async (path) => {
    try {
      const answer = await ask(path);
      since = '';
      set(() => ({ answer, of: path, problem: null, lost: '' }));
    } catch (error) {
      const problem = error instanceof Problem ? error : null;
      since = problem ? '' : since || new Date().toLocaleTimeString();
      const lost = `${wordsOf(error)} It has not since ${since}, and is asked again every ${AGAIN_MS / 1000} s.`;
      set((before) => (problem ? { ...before, of: path, problem, lost: '' } : { ...before, lost }));
      if (since && path === wanted) timer = setTimeout(() => asks.want(path), AGAIN_MS);
    }
  }, 0);
  return (/** @type {string | null} */ path) => {
    wanted = path;
    clearTimeout(timer);
    if (path !== null) timer = setTimeout(() => asks.want(path), quiet_ms);
  };
}

/**
 * The answer to a path, which may change at every frame.
 * @param {string | null} path null while there is nothing to ask
 * @param {{quiet_ms?: number, ask?: (path: string) => Promise<any>}} [how] `quiet_ms` is 0 for an answer that keeps up with a drag
 * @returns {Answer<any>}
 */
export function useAnswer(path, { quiet_ms = QUIET_MS, ask = get } = {}) {
  const [state, set] = useState(/** @type {State} */ ({ answer: null, of: null, problem: null, lost: '' }));
  const follow = useMemo(() => follower(set, quiet_ms, ask), []);
  useEffect(() => follow(path), [path]);
  useEffect(() => () => follow(null), []);
  const current = path !== null && state.of === path && state.lost === '' && state.problem === null;
  return { ...state, current, problem: state.of === path ? state.problem : null };
}

/**
 * An answer, dimmed while another one is asked for; in its place a refusal, or that the server is lost.
 * @param {{asked: Answer<any>, id?: string, children: (answer: any) => unknown}} props
 */
export const Answered = ({ asked: { answer, current, problem, lost }, id, children }) =>
  html`${lost && html`<p role="status">${lost}</p>`}
    ${problem && html`<p role="status">${words(wordsOf(problem))}</p>`}
    ${answer && !lost && !problem && html`<div class=${current ? 'answered' : 'answered stale'} id=${id}>${children(answer)}</div>`}`;

class Task {
  /** The doing, the result or the failure. */
  words = '';
  /** @type {{done: number, of: number} | null} */
  progress = null;
  /** How far it is, in words. */
  count = '';
  /** How the newest one ended. @type {'' | 'answered' | 'stopped' | 'failed'} */
  ended = '';
  /** True once there was an answer. */
  answered = false;
  /** How long the newest answer took, s. */
  took = 0;
  doing;
  #units;
  #changed;
  /** @type {AbortController | null} */
  #under = null;

  /** @param {string} doing @param {string | ((progress: any) => string)} units @param {() => void} changed */
  constructor(doing, units, changed) {
    this.doing = doing;
    this.#units = units;
    this.#changed = changed;
  }

  get active() {
    return this.#under !== null;
  }

  /** @param {string} said */
  say(said) {
    this.words = said;
    this.#changed();
  }

  /** @param {string} why in words */
  stop(why) {
    this.#under?.abort();
    this.#under = null;
    this.ended = 'stopped';
    this.say(why);
  }

  /**
   * The result of some work, in place of that under way; null where there is none, which is told.
   * @template T
   * @param {(signal: AbortSignal) => Promise<T>} work
   * @param {(error: unknown) => string} [failed] a failure in words
   * @returns {Promise<T | null>}
   */
  async run(work, failed = wordsOf) {
    const under = new AbortController();
    const { signal } = under;
    this.#under?.abort();
    this.#under = under;
    this.count = '';
    this.progress = null;
    this.say(`${this.doing}…`);
    const begun_ms = performance.now();
    try {
      const result = await work(signal);
      if (signal.aborted) return null;
      this.ended = 'answered';
      this.answered = true;
      this.took = (performance.now() - begun_ms) / 1000;
      return result;
    } catch (error) {
      if (signal.aborted) return null;
      this.ended = 'failed';
      this.say(failed(error));
      return null;
    } finally {
      if (this.#under === under) {
        this.#under = null;
        this.#changed();
      }
    }
  }

  /**
   * The last line of a response that tells its progress.
   * @param {string} path
   * @param {object} [more]
   * @param {unknown} [more.body] of a request that is posted
   * @param {(error: Problem) => string} [more.refused] a refusal by the server in words
   * @param {(progress: any) => void} [more.heard] hears of the progress too
   * @returns {Promise<{end: any, pictures: Record<string, string>} | null>}
   */
  ask(path, { body, refused = wordsOf, heard } = {}) {
    const posted = { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) };
    const work = async (/** @type {AbortSignal} */ signal) => {
      let answer = null;
      const url = `${path}${path.includes('?') ? '&' : '?'}format=progress`;
      for await (const line of lines(url, { signal, ...(body !== undefined && posted) })) {
        if (signal.aborted) return null;
        if (line.problem) throw asProblem(line.problem, line.problem.status);
        if (line.progress) {
          this.hear(line.progress);
          heard?.(line.progress);
        } else answer = line;
      }
      if (!answer) throw new TypeError('no end');
      return answer;
    };
    return this.run(work, (error) => {
      if (error instanceof Problem) return refused(error);
      return this.count ? `The answer broke off at ${this.count}.` : wordsOf(error);
    });
  }

  hear = (/** @type {{done: number, of: number}} */ progress) => {
    const { done, of } = progress;
    this.progress = progress;
    this.count =
      typeof this.#units === 'string' ? `${number(done, 7)} of ${number(of, 7)} ${this.#units}` : this.#units(progress);
    invalidate(this);
  };

  /** Tells of the progress, once in a frame. */
  draw() {
    this.#changed();
    return false;
  }
}

/**
 * The work of a panel, stopped with it.
 * @param {string} doing as in “Fitting”
 * @param {string | ((progress: any) => string)} units in which it is counted, or the progress in words
 */
export function useTask(doing, units) {
  const [, again] = useState({});
  const task = useMemo(() => new Task(doing, units, () => again({})), []);
  useEffect(() => () => task.stop(''), []);
  return task;
}

/**
 * The button that asks, and the one that stops.
 * @param {{name: string, task: Task, start: string, about?: string, quiet?: boolean}} props `quiet` for one that asks by itself
 */
export function TaskButtons({ name, task, start, about, quiet = false }) {
  const place = useRef(/** @type {HTMLElement | null} */ (null));
  useKeptFocus(place);
  const { active } = task;
  return html`<p class="buttons row" ref=${place}>
    <button type="submit" id=${`${name}-start`} class="primary" disabled=${active} hidden=${quiet && ['', 'answered'].includes(task.ended)}
      aria-describedby=${about}>${start}</button>
    <button type="button" id=${`${name}-cancel`} disabled=${!active} hidden=${quiet && !active} onClick=${() => task.stop('Cancelled.')}>Cancel</button>
  </p>`;
}

/** The progress, or the result in words. @param {{name: string, task: Task}} props */
export function TaskTold({ name, task: { words: said, count, active, progress, doing, ended, answered } }) {
  const old = said && !active && answered && ['stopped', 'failed'].includes(ended);
  // The count is left to the bar, which is asked for its value: spoken by itself it would not stop.
  return html`<div class="task-told" id=${`${name}-told`}>
    <span role="status">${words(said)}${old && ' What is shown is from before.'}</span> <span>${active && count}</span>
    <progress aria-label=${doing} hidden=${!active} max=${progress?.of} value=${progress?.done} />
  </div>`;
}
