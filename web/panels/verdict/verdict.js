// The verdict in a line: what is on the screen, the gains that this release allows, the error that would end it first. The evidence stands
// below the reasons. Where there is no verdict, the line has the reason.

import { h } from '../../dom/elements.js';
import { html, render } from '../../vendor/preact/preact.js';
import { Answer, Headline, headlineOf } from './answer.js';

/** @typedef {import('../card.js').Judged} Judged */
/** @typedef {import('./answer.js').Measure} Measure */
/** A headline: its class, sign and words. @typedef {{kind: string, sign: string, words: string}} Line */

export class Verdict {
  #root;
  #more;
  // Only the words are spoken, not the table of numbers at every turn of a knob.
  #spoken = h('p', { class: 'unseen', role: 'status' });
  /** The verdict on the page, with the way to ask for more. @type {(Judged & {measure: Measure}) | null} */
  #shown = null;
  /** The headline of a run that has ended, which goes before that of the setting. @type {Line | null} */
  #ended = null;
  /** The headline while somebody plays. @type {Line | null} */
  #played = null;
  /** The reason for no verdict, and the way to mend it. @type {{words: string, label: string, act: () => void} | null} */
  #held = null;
  /** @type {(string | null)[]} */
  #facts = [];

  /** @param {HTMLElement} root of the line @param {HTMLElement} more place of the evidence */
  constructor(root, more) {
    this.#root = root;
    this.#more = more;
    root.before(this.#spoken);
    this.#draw();
  }

  /** Shows the last answer anew, for another unit of angles. */
  retell() {
    this.#drawMore();
  }

  /** Marks the verdict as out of date. @param {boolean} busy */
  busy(busy) {
    this.#root.setAttribute('aria-busy', String(busy));
  }

  /** Facts that belong to the answer shown; they come later. @param {(string | null)[]} facts */
  tell(facts) {
    this.#facts = facts;
    this.#draw();
  }

  /** The end of the run on the screen; null while it goes on. @param {'fell' | 'kept' | 'over' | null} fate @param {string} words */
  ended(fate, words) {
    const sign = fate === 'fell' ? '▲' : '●';
    const line = fate === 'fell' || fate === 'kept' ? { kind: fate, sign, words } : null;
    if (line?.kind === this.#ended?.kind && line?.words === this.#ended?.words) return;
    this.#ended = line;
    this.#draw();
  }

  /** Words on a play with the run, in place of the verdict; null ends it. @param {string | null} words */
  plays(words) {
    this.#played = words === null ? null : { kind: '', sign: '●', words };
    this.#draw();
  }

  /** Tells why there is no verdict. The evidence of the last one is out of sight until there is another. @param {string} words @param {string} label of the way to mend it @param {() => void} act */
  hold(words, label, act) {
    this.busy(false);
    this.#spoken.textContent = `No verdict. ${words}`;
    this.#held = { words, label, act };
    this.#draw();
  }

  /** @param {Judged} judged @param {Measure} measure @param {boolean} newest false while the answer to a newer question is awaited */
  show(judged, measure, newest) {
    // Those of another answer are void.
    this.#facts = [];
    this.#held = null;
    this.#shown = { ...judged, measure };
    this.#draw();
    this.#drawMore();
    if (!newest) return;
    this.busy(false);
    const { headline, term } = headlineOf(judged.answer);
    this.#spoken.textContent = `This setting: ${headline.toLowerCase()}; ${term}`;
  }

  #drawMore() {
    if (this.#shown) render(html`<${Answer} ...${this.#shown} />`, this.#more);
  }

  #draw() {
    const [held, played, ended] = [this.#held, this.#played, this.#ended];
    const setting = this.#shown && headlineOf(this.#shown.answer);
    const ofSetting = setting && { kind: setting.tone, sign: setting.sign, words: setting.headline };
    const line = held
      ? { kind: 'none', sign: '–', words: 'No verdict' }
      : (played ?? ended ?? ofSetting ?? { kind: '', sign: '', words: '' });
    // A run that fell by what was done to it is told from its setting.
    const aside = played !== null || (ended?.kind === 'fell' && setting?.tone !== 'unstable');
    const alone = !held && !played && aside && setting?.tone === 'stable';
    this.#more.hidden = held !== null;
    render(
      html`<${Headline} ...${line} />
        <span class="facts" hidden=${!held && aside}>
          ${
            held
              ? html`<span class="held">
                  ${`${held.words} `}<button type="button" class="link" onClick=${held.act}>${held.label}</button>
                </span>`
              : this.#facts.map((fact) => fact && html`<span>${fact}</span> `)
          }
        </span>
        <span hidden=${!alone}>Left alone, this setting stays up</span>`,
      this.#root,
    );
  }
}
