// The card of the verdict: waiting, failed, or with the newest answer.

import { h, retryButton } from '../../dom/elements.js';
import { capitalized } from '../../dom/typeset.js';

/** @typedef {import('contract').Stability} Stability */

export class Verdict {
  #root;
  /** The answer to show, once its code is loaded. @type {Stability | null} */
  #newest = null;
  /** Shows the last answer anew, for another unit of angles. @type {() => void} */
  retell = () => {};
  // Only the words are spoken, not the table of numbers at every turn of a knob.
  #spoken = h('p', { class: 'unseen', role: 'status' });

  /** @param {HTMLElement} root */
  constructor(root) {
    this.#root = root;
    this.#root.before(this.#spoken);
    this.#root.append(h('p', { class: 'muted' }, 'Waiting for the server…'));
  }

  /** Marks the card as out of date, an answer that is about to be shown included. @param {boolean} busy */
  busy(busy) {
    if (busy) this.#newest = null;
    this.#root.setAttribute('aria-busy', String(busy));
  }

  /** @param {string} words @param {() => void} [retry] */
  fail(words, retry) {
    this.busy(false);
    this.#newest = null;
    this.retell = () => {};
    this.#spoken.textContent = `No verdict. ${words}`;
    this.#root.replaceChildren(
      h('p', { class: 'verdict-words none' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, '–'), ' No verdict'),
      h('p', { class: 'muted' }, words),
      retry ? retryButton(retry) : '',
    );
  }

  /** @param {Stability} answer @param {() => Promise<Stability>} measureBasin */
  async show(answer, measureBasin) {
    this.#newest = answer;
    this.retell = () => {
      if (this.#newest) void this.show(answer, measureBasin);
    };
    const module = await import('./answer.js').catch(() => null);
    if (this.#newest !== answer) return;
    if (!module) return this.fail('Part of the page did not load.', () => location.reload());
    this.busy(false);
    this.#spoken.textContent = `Verdict: ${capitalized(answer.verdict ?? 'No verdict')}`;
    const open = [...this.#root.querySelectorAll('details[open]')].map(({ className }) => className);
    this.#root.replaceChildren(...module.answerParts(answer, measureBasin));
    // Details that somebody opened stay open while the numbers in it change.
    for (const details of this.#root.querySelectorAll('details')) details.open = open.includes(details.className);
  }
}
