// The verdict in a line: what is on the screen, the gains that this release allows, the error that would end it first. The evidence stands
// below the reasons. Where there is no verdict, the line has the reason.

import { html, render } from '../../vendor/preact/preact.js';
import { Headline, Spoken } from '../parts.js';
import { Answer, headlineOf } from './answer.js';

/** @typedef {import('../card.js').Judged} Judged */
/** @typedef {import('./answer.js').Measure} Measure */
/** @typedef {import('../parts.js').Result} Result */

/**
 * @typedef {object} State
 * @property {(Judged & {measure: Measure}) | null} shown the verdict on the page, with the way to ask for more
 * @property {Result} ended the headline of a run that has ended, which goes before that of the setting
 * @property {Result} played the headline while somebody plays
 * @property {{words: string, label: string, act: () => void} | null} held the reason for no verdict, and the way to mend it
 * @property {(string | null)[]} facts
 */

/** @param {State} state */
function VerdictLine({ shown, held, played, ended, facts }) {
  const setting = shown && headlineOf(shown.answer);
  const line = held ? { tone: 'none', words: 'No verdict' } : (played ?? ended ?? setting);
  // A run that fell by what was done to it is told from its setting.
  const aside = played !== null || (ended?.tone === 'fell' && setting?.tone !== 'unstable');
  const alone = !held && !played && aside && setting?.tone === 'stable';
  return html`${line && html`<${Headline} result=${line} />`}
    <span class="facts" hidden=${!held && aside}>
      ${
        held
          ? html`<span class="held">${`${held.words} `}<button type="button" class="link" onClick=${held.act}>${held.label}</button></span>`
          : facts.map((fact) => fact && html`<span>${fact}</span> `)
      }
    </span>
    <span hidden=${!alone}>Left alone, this setting stays up</span>
    <${Spoken} words=${held ? `No verdict. ${held.words}` : setting ? `This setting: ${setting.words.toLowerCase()}; ${setting.term}` : ''} />`;
}

export class Verdict {
  #root;
  #more;
  /** @type {State} */
  #state = { shown: null, ended: null, played: null, held: null, facts: [] };

  /** @param {HTMLElement} root of the line @param {HTMLElement} more place of the evidence */
  constructor(root, more) {
    this.#root = root;
    this.#more = more;
    root.replaceChildren();
    this.#change({});
  }

  /** @param {Partial<State>} changes */
  #change(changes) {
    Object.assign(this.#state, changes);
    this.#more.hidden = this.#state.held !== null;
    render(html`<${VerdictLine} ...${this.#state} />`, this.#root);
  }

  /** Shows the last answer anew, for another unit of angles. */
  retell() {
    const { shown } = this.#state;
    if (shown) render(html`<${Answer} ...${shown} />`, this.#more);
  }

  /** Marks the verdict as out of date. @param {boolean} busy */
  busy(busy) {
    this.#root.setAttribute('aria-busy', String(busy));
  }

  /** Facts that belong to the answer shown; they come later. @param {(string | null)[]} facts */
  tell(facts) {
    this.#change({ facts });
  }

  /** The end of the run on the screen; null while it goes on. @param {'fell' | 'kept' | 'over' | null} fate @param {string} words */
  ended(fate, words) {
    const ended = fate === 'fell' || fate === 'kept' ? { tone: fate, words } : null;
    // It is called at each bounce.
    if (ended || this.#state.ended) this.#change({ ended });
  }

  /** Words on a play with the run, in place of the verdict; null ends it. @param {string | null} words */
  plays(words) {
    this.#change({ played: words === null ? null : { tone: 'played', words } });
  }

  /** Tells why there is no verdict. The evidence of the last one is out of sight until there is another. @param {string} words @param {string} label of the way to mend it @param {() => void} act */
  hold(words, label, act) {
    this.busy(false);
    this.#change({ held: { words, label, act } });
  }

  /** @param {Judged} judged @param {Measure} measure @param {boolean} newest false while the answer to a newer question is awaited */
  show(judged, measure, newest) {
    // Facts of another answer are void.
    this.#change({ facts: [], held: null, shown: { ...judged, measure } });
    this.retell();
    if (newest) this.busy(false);
  }
}
