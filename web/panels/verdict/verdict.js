// The verdict in a line: what is on the screen, the gains that this release allows, the error that would end it first. The evidence stands
// below the reasons. Where there is no verdict, the line has the reason.

import { h } from '../../dom/elements.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {import('../card.js').Judged} Judged */
/** @typedef {(query: string) => Promise<Stability>} Measure asks for more as well, such as the basin, which is dearer */

export class Verdict {
  #root;
  #more;
  #headline = h('p', { class: 'headline' });
  #facts = h('span', { class: 'facts' });
  // Beside a run that fell by what was done to it.
  #alone = h('span', { hidden: true }, 'Left alone, this setting stays up');
  /** The verdict to show, once its code is loaded. @type {Judged | null} */
  #newest = null;
  /** The verdict on the page, with the way to ask for more. @type {[Judged, Measure] | null} */
  #shown = null;
  /** The headline of the setting: its class and its words. @type {[kind: string, sign: string, words: string] | null} */
  #setting = null;
  /** The headline of a run that has ended, which goes before that of the setting. @type {[kind: string, sign: string, words: string] | null} */
  #ended = null;
  /** The headline while somebody plays. @type {[kind: string, sign: string, words: string] | null} */
  #played = null;
  #busy = false;
  /** True while the words tell why there is no verdict. */
  #held = false;
  // Only the words are spoken, not the table of numbers at every turn of a knob.
  #spoken = h('p', { class: 'unseen', role: 'status' });

  /** @param {HTMLElement} root of the line @param {HTMLElement} more place of the evidence */
  constructor(root, more) {
    this.#root = root;
    this.#more = more;
    root.before(this.#spoken);
    root.replaceChildren(this.#headline, this.#facts, this.#alone);
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

  /** Facts that belong to the answer shown; they come later. @param {(string | null)[]} facts */
  tell(facts) {
    if (!this.#held) this.#facts.replaceChildren(...facts.flatMap((fact) => (fact ? [h('span', {}, fact), ' '] : [])));
  }

  /** The end of the run on the screen; null while it goes on. @param {'fell' | 'kept' | 'over' | null} fate @param {string} words */
  ended(fate, words) {
    this.#ended = fate === 'fell' ? ['fell', '▲', words] : fate === 'kept' ? ['kept', '●', words] : null;
    this.#head();
  }

  /** Words on a play with the run, in place of the verdict; null ends it. @param {string | null} words */
  plays(words) {
    this.#played = words === null ? null : ['', '●', words];
    this.#head();
  }

  #head() {
    if (this.#held) return;
    const [kind, sign, words] = this.#played ?? this.#ended ?? this.#setting ?? ['', '', ''];
    this.#facts.hidden =
      this.#played !== null || (this.#ended !== null && kind === 'fell' && this.#setting?.[0] !== 'unstable');
    this.#alone.hidden = this.#played !== null || !this.#facts.hidden || this.#setting?.[0] !== 'stable';
    this.#headline.className = `headline ${kind}`;
    const whole = `${sign} ${words}`;
    if (this.#headline.textContent !== whole)
      this.#headline.replaceChildren(h('span', { class: 'sign', 'aria-hidden': 'true' }, sign), ` ${words}`);
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
    this.#held = this.#more.hidden = this.#alone.hidden = true;
    this.#facts.hidden = false;
    this.#headline.className = 'headline none';
    this.#headline.replaceChildren(h('span', { class: 'sign', 'aria-hidden': 'true' }, '–'), ' No verdict');
    this.#facts.replaceChildren(
      h('span', { class: 'held' }, `${words} `, h('button', { type: 'button', class: 'link', click: act }, label)),
    );
  }

  /** @param {string} words */
  fail(words) {
    this.#shown = null;
    this.hold(words, 'Load again', () => location.reload());
  }

  /**
   * @param {Judged} judged
   * @param {Measure} measure
   * @param {boolean} newest false while the answer to a newer question is awaited
   */
  async show(judged, measure, newest) {
    if (newest) this.#busy = false;
    this.#newest = judged;
    await this.#draw(judged, measure, newest);
  }

  /** @param {Judged} judged @param {Measure} measure */
  async #draw(judged, measure, newest = true) {
    const module = await import('./answer.js').catch(() => null);
    if (newest && this.#newest !== judged) return;
    if (!module) return this.fail('Part of the page did not load.');
    const another = this.#held || this.#shown?.[0] !== judged;
    this.#shown = [judged, measure];
    const { kind, sign, headline, said, more } = module.answerParts(judged, measure);
    // Those of another answer are void.
    if (another) this.#facts.replaceChildren();
    this.#held = this.#more.hidden = false;
    this.#setting = [kind, sign, headline];
    this.#head();
    const open = [...this.#more.querySelectorAll('details[open]')].map(({ className }) => className);
    this.#more.replaceChildren(...more);
    // Details that somebody opened stay open while the numbers in it change.
    for (const details of this.#more.querySelectorAll('details')) details.open = open.includes(details.className);
    if (!newest || this.#busy) return;
    this.#root.setAttribute('aria-busy', 'false');
    this.#spoken.textContent = `This setting: ${said}`;
  }
}
