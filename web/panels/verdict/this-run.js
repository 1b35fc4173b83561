// The line on the run that is seen: its bounce, or how it ended and after what. The verdict is on another run, a fresh release.

import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { UNITS } from '../../dom/units.js';
import { endedAs, fallInContact, reasonOf } from './plain-words.js';

/** @typedef {import('../../run/run-state.js').RunState} RunState */

/** Least time between two writings of the numbers of a run that goes on, ms. */
const WRITTEN_MS = 250;

const LABEL = () => h('p', { class: 'line-label' }, 'This run');

/** The last thing that was done to a run up to an impact, as in “, after your kick at 7”. @param {RunState} run @param {number} until @param {import('../../api/scene-fields.js').Field[]} fields */
function doneTo({ interventions }, until, fields) {
  const last = interventions.findLast(({ impact }) => impact <= until);
  if (!last) return '';
  const [path] = Object.keys(last.set);
  const title = fields.find((field) => field.field === path)?.title.toLowerCase();
  const [guided] = Object.keys(last.guide);
  const changed = `change of ${title ?? 'the settings'}`;
  const deed = guided ? guided.split('.')[0] : Object.keys(last.kick).length > 0 ? 'kick' : changed;
  return `, after your ${deed} at ${number(last.impact, 8)}`;
}

/**
 * The run in a line: the fact, and what it came after.
 * @param {RunState} run
 * @param {import('../../api/scene-fields.js').Field[]} fields
 * @returns {[fact: string, after: string]}
 */
export function runWords(run, fields) {
  const { phase, outcome, impacts } = run;
  if (phase === 'ended' && outcome) {
    const { kind, bounces: count } = outcome;
    const fall = fallInContact(outcome);
    const after = (/** @type {string} */ deed) => `stopped bouncing and ${deed} after bounce ${number(count, 8)}`;
    const rests = kind === 'settled' && run.fate === 'kept';
    const words = fall ? after(fall.deed) : rests ? after('came to rest') : endedAs(kind, count);
    return [capitalized(words), doneTo(run, count, fields)];
  }
  if (phase === 'idle') return ['Not released yet', ''];
  if (phase === 'connecting') return ['Connecting…', ''];
  const n = impacts.last?.n ?? 0;
  if (phase === 'lost') return [`The connection was lost after bounce ${number(n, 8)}`, ''];
  return n === 0 ? ['Released', ''] : [`Bounce ${number(n, 8)}`, doneTo(run, n, fields)];
}

export class ThisRun {
  #root;
  #headline = h('p', { class: 'headline' });
  #reason = h('p', { class: 'run-reason' });
  #detail = h('p', { class: 'muted' });
  #details = h('details', { class: 'run-details' }, h('summary', {}, 'Details'), this.#detail);

  #extent = new RunExtent();
  #written_ms = -Infinity;

  /** @param {HTMLElement} root */
  constructor(root) {
    this.#root = root;
    root.replaceChildren(
      LABEL(),
      h('div', { id: 'outcome' }, this.#headline, this.#reason, this.#details),
      this.#extent.element,
    );
    document.addEventListener(UNITS, () => this.#extent.write());
  }

  /** @param {RunState} run @param {import('../../api/scene-fields.js').Field[]} fields @returns {[fact: string, after: string]} the run in a line */
  show(run, fields) {
    const { phase, outcome, impacts } = run;
    const words = runWords(run, fields);
    const [fact, after] = words;
    if (this.#headline.textContent !== fact + after)
      this.#headline.replaceChildren(fact, after && h('span', { class: 'deed' }, after));
    const ended = phase === 'ended' && outcome !== null;
    this.#extent.show(impacts);
    const now_ms = performance.now();
    // Numbers that change faster cannot be read.
    if (phase !== 'running' || impacts.end === 0 || now_ms - this.#written_ms > WRITTEN_MS) {
      this.#written_ms = now_ms;
      this.#extent.write();
    }
    const told = ended ? `${outcome.kind} ${run.fate}` : `${phase} ${impacts.missing}`;
    if (this.#root.dataset.told === told) return words;
    this.#root.dataset.told = told;
    const fall = ended ? fallInContact(outcome) : null;
    for (const fate of ['fell', 'kept']) this.#root.classList.toggle(fate, run.fate === fate);
    const skipped = impacts.missing > 0 ? `${number(impacts.missing, 8)} bounces were skipped over.` : '';
    const then = fall ? `; then ${fall.reason}` : '';
    this.#reason.textContent = ended ? `${capitalized(reasonOf(outcome.kind))}${then}.` : skipped;
    this.#details.hidden = !ended;
    // At an end the reason takes their place.
    if (ended) this.#details.append(this.#extent.element);
    else this.#root.append(this.#extent.element);
    this.#detail.replaceChildren(...prose(ended ? `${capitalized(outcome.detail)}. ${skipped}` : ''));
    return words;
  }
}

/** Digits of the numbers of a run. */
const DIGITS = 3;

/** How far the run has gone: its largest angles and its way along x, taken impact by impact. */
class RunExtent {
  element = h('dl', { class: 'run-extent muted' });
  /** Impacts that are counted. */
  #end = 0;
  #theta = 0;
  #alpha = 0;
  #low = Infinity;
  #high = -Infinity;

  /** @param {import('../../run/impacts.js').Impacts} impacts */
  show(impacts) {
    if (impacts.end < this.#end) {
      [this.#end, this.#theta, this.#alpha] = [0, 0, 0];
      [this.#low, this.#high] = [Infinity, -Infinity];
    }
    for (let place = Math.max(impacts.begin, this.#end); place < impacts.end; place += 1) {
      const x = impacts.at('x', place);
      this.#theta = Math.max(this.#theta, Math.abs(impacts.at('theta', place)) || 0);
      this.#alpha = Math.max(this.#alpha, Math.abs(impacts.at('alpha', place)) || 0);
      this.#low = Math.min(this.#low, x);
      this.#high = Math.max(this.#high, x);
    }
    this.#end = impacts.end;
  }

  /** Writes the numbers in the unit of angles of now. */
  write() {
    const { element } = this;
    const rows =
      this.#end === 0
        ? []
        : [
            ['Angle', `up to ${quantity(this.#theta, 'rad', DIGITS)}`],
            ['Tilt of the table', `up to ${quantity(this.#alpha, 'rad', DIGITS)}`],
            ['Along x', `${number(this.#low, DIGITS)} to ${quantity(this.#high, 'm', DIGITS)}`],
          ];
    element.replaceChildren(...rows.map(([name, words]) => h('div', {}, h('dt', {}, name), h('dd', {}, words))));
  }
}
