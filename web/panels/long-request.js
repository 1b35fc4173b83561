// A request that takes the server a while: its progress, its cancelling, and its failure in words.

import { Problem, problemOf, wordsOf } from '../api/client.js';
import { h } from '../dom/elements.js';
import { marked } from '../dom/typeset.js';
import { lines } from '../api/ndjson.js';
import { number } from '../dom/numbers.js';

const SECOND_MS = 1000;

export class LongRequest {
  /** The button that asks, and the one that stops. */
  buttons;
  /** The progress, or the result in words. */
  told;
  #start;
  #cancel;
  // The count is left to the bar, which is asked for its value: spoken by itself it would not stop.
  #words = h('span', { role: 'status' });
  #count = h('span');
  #bar = h('progress', { hidden: true });
  #doing;
  #units;
  /** @type {AbortController | null} */
  #under = null;
  #answered = false;
  /** How long the newest answer took, s. */
  took = 0;

  /**
   * @param {string} name what the ids of all of it begin with
   * @param {HTMLButtonElement} start the button that asks
   * @param {string} doing while it is under way
   * @param {string} units what its work is counted in; '' where the server does not tell how far it is: seconds are counted then
   */
  constructor(name, start, doing, units) {
    this.#doing = doing;
    this.#units = units;
    this.#start = start;
    this.#cancel = h(
      'button',
      { type: 'button', id: `${name}-cancel`, disabled: true, click: () => this.stop('Cancelled.') },
      'Cancel',
    );
    this.#bar.setAttribute('aria-label', doing);
    this.buttons = h('p', { class: 'buttons' }, this.#start, this.#cancel);
    this.told = h('div', { class: `${name}-told`, id: `${name}-told` }, this.#words, ' ', this.#count, this.#bar);
  }

  get active() {
    return this.#under !== null;
  }

  /** @param {string} words */
  say(words) {
    this.#words.replaceChildren(...marked(words));
  }

  /** @param {string} words why */
  stop(words) {
    if (!this.#under) return;
    this.#under.abort();
    this.#busy(null);
    this.#fail(words);
  }

  /**
   * The answer and its pictures; null where there is none, which is told. One question at a time.
   * @param {string} path with a query, and no format
   * @returns {Promise<{end: any, pictures: Record<string, string>} | null>}
   */
  ask(path) {
    return this.during(async (signal) => {
      let answer = null;
      const response = await fetch(`${path}&format=progress`, { signal });
      if (!response.ok || !response.body) throw await problemOf(response);
      for await (const line of lines(response.body)) {
        if (signal.aborted) return null;
        if (line.progress) this.#show(line.progress);
        else answer = line;
      }
      if (!answer) throw new TypeError('no end');
      return answer;
    });
  }

  /**
   * The answer of a request that does not tell its progress; null where there is none, which is told. One question at a time.
   * @template T
   * @param {(signal: AbortSignal) => Promise<T>} request
   * @param {(error: Problem) => string} [refused] a refusal by the server in words
   * @returns {Promise<T | null>}
   */
  async during(request, refused = wordsOf) {
    const under = new AbortController();
    const { signal } = under;
    this.#under?.abort();
    this.#busy(under);
    this.say(`${this.#doing}…`);
    const begun_ms = performance.now();
    const clock = this.#units ? 0 : setInterval(() => this.#tick(begun_ms), SECOND_MS);
    try {
      const answer = await request(signal);
      if (signal.aborted) return null;
      this.#answered = true;
      this.took = (performance.now() - begun_ms) / 1000;
      return answer;
    } catch (error) {
      if (signal.aborted) return null;
      const far = this.#units && this.#count.textContent;
      if (error instanceof Problem) this.#fail(refused(error));
      else this.#fail(far ? `The answer broke off at ${far}.` : wordsOf(error));
      return null;
    } finally {
      clearInterval(clock);
      if (this.#under === under) this.#busy(null);
    }
  }

  /** @param {string} words */
  #fail(words) {
    this.say(this.#answered ? `${words} What is shown is from before.` : words);
  }

  /** @param {{done: number, of: number}} progress */
  #show({ done, of }) {
    this.#bar.max = of;
    this.#bar.value = done;
    this.#count.textContent = `${number(done, 7)} of ${number(of, 7)} ${this.#units}`;
  }

  /** @param {number} begun_ms */
  #tick(begun_ms) {
    this.#count.textContent = `${number(Math.floor((performance.now() - begun_ms) / SECOND_MS), 7)} s`;
  }

  /** @param {AbortController | null} under */
  #busy(under) {
    const [on, off] = under ? [this.#cancel, this.#start] : [this.#start, this.#cancel];
    this.#under = under;
    on.disabled = false;
    // Whoever pressed it should not find the focus gone.
    if (off === document.activeElement) on.focus();
    off.disabled = true;
    this.#bar.hidden = under === null;
    this.#bar.removeAttribute('value');
    this.#count.textContent = '';
  }
}
