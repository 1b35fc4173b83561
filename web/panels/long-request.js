// A request that takes the server a while: its progress, its cancelling, and its failure in words.

import { Problem, asProblem, problemOf, server, wordsOf } from '../api/client.js';
import { h } from '../dom/elements.js';
import { marked } from '../dom/typeset.js';
import { lines } from '../api/ndjson.js';
import { number } from '../dom/numbers.js';

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
   * @param {string | ((progress: any) => string)} units what its work is counted in, or the progress in words
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
    this.buttons.dataset.ended = 'stopped';
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
    return this.during((signal) => fetch(`${path}&format=progress`, { signal }));
  }

  /**
   * The last line of a response that tells its progress; null where there is none, which is told. One question at a time.
   * @param {(signal: AbortSignal) => Promise<Response>} request
   * @param {{refused?: (error: Problem) => string, heard?: (progress: any) => void}} [hooks] a refusal by the server in words, and what hears of
   * the progress too
   * @returns {Promise<any>}
   */
  async during(request, { refused = wordsOf, heard } = {}) {
    const under = new AbortController();
    const { signal } = under;
    this.#under?.abort();
    this.#busy(under);
    this.say(`${this.#doing}…`);
    const begun_ms = performance.now();
    try {
      let answer = null;
      const response = await request(signal);
      server.build = response.headers.get('equipoise-build') ?? server.build;
      if (!response.ok || !response.body) throw await problemOf(response);
      for await (const line of lines(response.body)) {
        if (signal.aborted) return null;
        if (line.problem) throw asProblem(line.problem, line.problem.status);
        if (line.progress) {
          this.#show(line.progress);
          heard?.(line.progress);
        } else answer = line;
      }
      if (!answer) throw new TypeError('no end');
      this.buttons.dataset.ended = 'answered';
      this.#answered = true;
      this.took = (performance.now() - begun_ms) / 1000;
      return answer;
    } catch (error) {
      if (signal.aborted) return null;
      const far = this.#count.textContent;
      if (error instanceof Problem) this.#fail(refused(error));
      else this.#fail(far ? `The answer broke off at ${far}.` : wordsOf(error));
      return null;
    } finally {
      if (this.#under === under) this.#busy(null);
    }
  }

  /** @param {string} words */
  #fail(words) {
    this.buttons.dataset.ended = 'stopped';
    this.say(this.#answered ? `${words} What is shown is from before.` : words);
  }

  /** @param {{done: number, of: number}} progress */
  #show(progress) {
    const { done, of } = progress;
    this.#bar.max = of;
    this.#bar.value = done;
    this.#count.textContent =
      typeof this.#units === 'string' ? `${number(done, 7)} of ${number(of, 7)} ${this.#units}` : this.#units(progress);
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
