// The line on the run that is seen: its bounce, or how it ended and after what. The verdict is on another run, a fresh release.

import { paced } from '../../dom/debounce.js';
import { number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { UNITS } from '../../dom/units.js';
import { html, render } from '../../vendor/preact/preact.js';
import { brief } from '../parts.js';
import { endedAs, fallInContact, reasonOf } from './words.js';

/** Least time between two writings of the numbers of a run that goes on, ms. */
const WRITTEN_MS = 250;

/** The last thing that was done to a run up to an impact, as in “, after your kick at 7”. @param {RunState} run @param {number} until @param {Field[]} fields */
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
 * @param {Field[]} fields
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

/** Digits of the numbers of a run. */
const DIGITS = 3;

/** How far a run has gone, impact by impact up to the place `end`. */
const NOWHERE = { end: 0, theta: 0, alpha: 0, low: Infinity, high: -Infinity };

/** @typedef {ReturnType<typeof bringThisRun>} ThisRun */

/** @param {HTMLElement} root @param {RunState} run @param {Field[]} fields */
export function bringThisRun(root, run, fields) {
  let extent = { ...NOWHERE };
  let words = runWords(run, fields);

  const count = () => {
    const { impacts } = run;
    if (impacts.end < extent.end) extent = { ...NOWHERE };
    for (let place = Math.max(impacts.begin, extent.end); place < impacts.end; place += 1) {
      const x = impacts.at('x', place);
      extent.theta = Math.max(extent.theta, Math.abs(impacts.at('theta', place)) || 0);
      extent.alpha = Math.max(extent.alpha, Math.abs(impacts.at('alpha', place)) || 0);
      extent.low = Math.min(extent.low, x);
      extent.high = Math.max(extent.high, x);
    }
    extent.end = impacts.end;
  };

  const draw = () => {
    const { phase, outcome: last, impacts, fate } = run;
    const [fact, after] = words;
    const outcome = phase === 'ended' ? last : null;
    const fall = outcome && fallInContact(outcome);
    const skipped = impacts.missing > 0 ? `${number(impacts.missing, 8)} bounces were skipped over.` : '';
    const reason = outcome ? `${capitalized(reasonOf(outcome.kind))}${fall ? `; then ${fall.reason}` : ''}.` : skipped;
    const { end, theta, alpha, low, high } = extent;
    const rows = [
      ['Angle', `up to ${quantity(theta, 'rad', DIGITS)}`],
      ['Tilt of the table', `up to ${quantity(alpha, 'rad', DIGITS)}`],
      ['Along x', `${number(low, DIGITS)} to ${quantity(high, 'm', DIGITS)}`],
    ];
    const reached = html`<dl class="run-extent muted">
      ${end > 0 && rows.map(([name, told]) => html`<div><dt>${name}</dt><dd>${told}</dd></div>`)}
    </dl>`;
    render(
      html`<p class="line-label">This run</p>
        <div id="outcome">
          <p class=${`headline told ${fate ?? ''}`}>${fact}${after && html`<span class="deed">${after}</span>`}</p>
          <p class="run-reason">${reason}</p>
          <details class="run-details" hidden=${!outcome}>
            <summary>Details</summary>
            <p class="muted">${brief(outcome ? `${capitalized(outcome.detail)}. ${skipped}` : '')}</p>
            ${outcome && reached}
          </details>
        </div>
        ${!outcome && reached}`,
      root,
    );
  };

  // Numbers that change faster cannot be read.
  const drawSoon = paced(WRITTEN_MS, draw);
  document.addEventListener(UNITS, draw);
  /** Shows the run as it is now; gives it in a line. */
  return () => {
    words = runWords(run, fields);
    count();
    if (run.phase === 'running') drawSoon();
    else draw();
    return words;
  };
}
