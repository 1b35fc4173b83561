// The verdict on the setting: waiting, with the newest answer, or the reason why there is none.

import { h } from '../../dom/elements.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {(query: string) => Promise<Stability>} Measure asks for more as well, such as the basin, which is dearer */

const LABEL = () => h('p', { class: 'line-label' }, 'This setting');

export class Verdict {
  #root;
  /** The evidence, below the line on the run. */
  #more = h('div', { id: 'verdict-more' });
  /** The answer to show, once its code is loaded. @type {Stability | null} */
  #newest = null;
  /** The answer on the page, with the way to ask for more. @type {[Stability, Measure] | null} */
  #shown = null;
  #busy = false;
  /** True while the words tell why there is no verdict. */
  #held = false;
  // Only the words are spoken, not the table of numbers at every turn of a knob.
  #spoken = h('p', { class: 'unseen', role: 'status' });

  /** @param {HTMLElement} root @param {HTMLElement} run the line on the run, which follows the one on the setting */
  constructor(root, run) {
    this.#root = root;
    root.before(this.#spoken);
    run.after(this.#more);
  }

  /** Shows the last answer anew, for another unit of angles. */
  retell() {
    if (this.#shown && !this.#held) void this.#draw(...this.#shown, false);
  }

  /** Marks the verdict as out of date. @param {boolean} busy */
  busy(busy) {
    this.#busy = busy;
    if (busy) this.#newest = null;
    this.#root.setAttribute('aria-busy', String(busy));
  }

  /**
   * Tells why there is no verdict. The evidence of the last one is out of sight until there is another.
   * @param {string} words
   * @param {string} label of the way to mend it
   * @param {() => void} act
   */
  hold(words, label, act) {
    this.busy(false);
    this.#newest = null;
    this.#spoken.textContent = `No verdict. ${words}`;
    this.#held = this.#more.hidden = true;
    const reason = h(
      'p',
      { class: 'held' },
      `${words} `,
      h('button', { type: 'button', class: 'link', click: act }, label),
    );
    this.#root.replaceChildren(
      LABEL(),
      h(
        'div',
        { class: 'verdict-words none' },
        h('p', { class: 'headline' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, '–'), ' No verdict'),
        reason,
      ),
    );
  }

  /** @param {string} words */
  fail(words) {
    this.#shown = null;
    this.#root.replaceChildren();
    this.hold(words, 'Load again', () => location.reload());
  }

  /**
   * @param {Stability} answer
   * @param {Measure} measure
   * @param {boolean} newest false while the answer to a newer question is awaited
   */
  async show(answer, measure, newest) {
    if (newest) this.#busy = false;
    this.#newest = answer;
    await this.#draw(answer, measure, newest);
  }

  /** @param {Stability} answer @param {Measure} measure */
  async #draw(answer, measure, newest = true) {
    const module = await import('./answer.js').catch(() => null);
    if (newest && this.#newest !== answer) return;
    if (!module) return this.fail('Part of the page did not load.');
    this.#shown = [answer, measure];
    const { said, head, more } = module.answerParts(answer, measure);
    this.#held = this.#more.hidden = false;
    this.#root.replaceChildren(LABEL(), ...head);
    const open = [...this.#more.querySelectorAll('details[open]')].map(({ className }) => className);
    this.#more.replaceChildren(...more);
    // Details that somebody opened stay open while the numbers in it change.
    for (const details of this.#more.querySelectorAll('details')) details.open = open.includes(details.className);
    if (!newest || this.#busy) return;
    this.#root.setAttribute('aria-busy', 'false');
    this.#spoken.textContent = `This setting: ${said}`;
  }
}
