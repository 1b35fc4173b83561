// A request that takes the server a while: its progress, its cancelling, and its failure in words.

import { Problem, asProblem, problemOf, server, wordsOf } from '../api/client.js';
import { lines } from '../api/answers.js';
import { number } from '../dom/numbers.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';
import { words } from './parts.js';

class LongRequest {
  /** The doing, the result or the failure. */
  words = '';
  /** @type {{done: number, of: number} | null} */
  progress = null;
  /** How far it is, in words. */
  count = '';
  /** How the newest one ended. @type {'' | 'answered' | 'stopped'} */
  ended = '';
  /** How long the newest answer took, s. */
  took = 0;
  #doing;
  #units;
  #changed;
  /** @type {AbortController | null} */
  #under = null;
  #answered = false;

  /** @param {string} doing @param {string | ((progress: any) => string)} units @param {() => void} changed */
  constructor(doing, units, changed) {
    this.#doing = doing;
    this.#units = units;
    this.#changed = changed;
  }

  get active() {
    return this.#under !== null;
  }

  get doing() {
    return this.#doing;
  }

  /** @param {string} said */
  say(said) {
    this.words = said;
    this.#changed();
  }

  /** @param {string} why in words */
  stop(why) {
    if (!this.#under) return;
    this.#under.abort();
    this.#under = null;
    this.#fail(why);
  }

  /** @param {string} said */
  #fail(said) {
    this.ended = 'stopped';
    this.say(this.#answered ? `${said} What is shown is from before.` : said);
  }

  /**
   * The last line of a response that tells its progress; null where there is none, which is told. One question at a time.
   * @param {string} path
   * @param {object} [more]
   * @param {unknown} [more.body] of a request that is posted
   * @param {(error: Problem) => string} [more.refused] a refusal by the server in words
   * @param {(progress: any) => void} [more.heard] hears of the progress too
   * @returns {Promise<{end: any, pictures: Record<string, string>} | null>}
   */
  async ask(path, { body, refused = wordsOf, heard } = {}) {
    const under = new AbortController();
    const { signal } = under;
    this.#under?.abort();
    this.#under = under;
    this.count = '';
    this.progress = null;
    this.say(`${this.#doing}…`);
    const begun_ms = performance.now();
    try {
      let answer = null;
      const url = `${path}${path.includes('?') ? '&' : '?'}format=progress`;
      const posted = { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) };
      const response = await fetch(url, { signal, ...(body !== undefined && posted) });
      server.build = response.headers.get('equipoise-build') ?? server.build;
      if (!response.ok || !response.body) throw await problemOf(response);
      for await (const line of lines(response.body)) {
        if (signal.aborted) return null;
        if (line.problem) throw asProblem(line.problem, line.problem.status);
        if (line.progress) this.#hear(line.progress, heard);
        else answer = line;
      }
      if (!answer) throw new TypeError('no end');
      this.ended = 'answered';
      this.#answered = true;
      this.took = (performance.now() - begun_ms) / 1000;
      return answer;
    } catch (error) {
      if (signal.aborted) return null;
      if (error instanceof Problem) this.#fail(refused(error));
      else this.#fail(this.count ? `The answer broke off at ${this.count}.` : wordsOf(error));
      return null;
    } finally {
      if (this.#under === under) {
        this.#under = null;
        this.#changed();
      }
    }
  }

  /** @param {{done: number, of: number}} progress @param {((progress: any) => void) | undefined} heard */
  #hear(progress, heard) {
    const { done, of } = progress;
    this.progress = progress;
    this.count =
      typeof this.#units === 'string' ? `${number(done, 7)} of ${number(of, 7)} ${this.#units}` : this.#units(progress);
    heard?.(progress);
    this.#changed();
  }
}

/**
 * A long request of a panel, stopped with it.
 * @param {string} doing as in “Fitting”
 * @param {string | ((progress: any) => string)} units in which its work is counted, or the progress in words
 */
export function useLongRequest(doing, units) {
  const [, again] = useState({});
  const task = useMemo(() => new LongRequest(doing, units, () => again({})), []);
  useEffect(() => () => task.stop(''), []);
  return task;
}

/**
 * The button that asks, and the one that stops.
 * @param {{name: string, task: LongRequest, start: string, id?: string, about?: string, quiet?: boolean}} props `quiet` for one that asks by itself
 */
export function TaskButtons({ name, task, start, id = `${name}-start`, about, quiet = false }) {
  const [begin, cancel] = [useRef(/** @type {HTMLButtonElement | null} */ (null)), useRef(/** @type {any} */ (null))];
  const { active } = task;
  const [on, off] = active ? [cancel, begin] : [begin, cancel];
  const held = off.current !== null && document.activeElement === off.current;
  useLayoutEffect(() => {
    // Whoever pressed it should not find the focus gone.
    if (held) on.current?.focus();
  }, [active]);
  return html`<p class="buttons">
    <button type="submit" id=${id} class="primary" ref=${begin} disabled=${active} hidden=${quiet && task.ended !== 'stopped'}
      aria-describedby=${about}>${start}</button>
    <button type="button" id=${`${name}-cancel`} ref=${cancel} disabled=${!active} hidden=${quiet && !active} onClick=${() => task.stop('Cancelled.')}>Cancel</button>
  </p>`;
}

/** The progress, or the result in words. @param {{name: string, task: LongRequest}} props */
export const TaskTold = ({ name, task: { words: said, count, active, progress, doing } }) =>
  // The count is left to the bar, which is asked for its value: spoken by itself it would not stop.
  html`<div class="task-told" id=${`${name}-told`}>
    <span role="status">${words(said)}</span> <span>${active && count}</span>
    <progress aria-label=${doing} hidden=${!active} max=${progress?.of} value=${progress?.done} />
  </div>`;
