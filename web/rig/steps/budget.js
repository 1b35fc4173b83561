// Step 3: what ends the balance first. Each limit is set against what the owner has.

import { number } from '../../dom/numbers.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { reasonOf } from '../../panels/verdict/plain-words.js';
import { html } from '../../vendor/preact/preact.js';
import { useAnswer } from '../ask.js';
import { Nodes, NumberField, Spoken, Step, useRig } from '../parts.js';
import { sizeWords, thingOf, typedUnit } from '../../panels/verdict/things.js';

/** @typedef {import('../rig.js').Rig} Rig */
/** @typedef {import('contract').Stability} Stability */
/** @typedef {NonNullable<Stability['budget']>} Budget */
/** @typedef {import('contract').BudgetError} BudgetError */
/** @typedef {NonNullable<BudgetError['below']>} Limit */

/** Bounces that a run has to survive: fewer than those of the verdict, for a budget takes a thousand runs. */
const BOUNCES = 500;
/** Time without a change before it is asked, ms. */
const QUIET_MS = 350;

/** The budget of a scene, once it stays. @param {string | URLSearchParams | null} query null for none */
export const useBudget = (query) =>
  useAnswer(query && `v1/stability?${query}&budget=true&bounces=${BOUNCES}`, QUIET_MS);

/** Losses beyond a limit that no run tells. @type {Partial<Record<Limit['decided_by'], string>>} */
const LOST = {
  linear: 'small swings grow',
  boundary: 'the edge of stability is passed',
  lyapunov: 'swings grow slowly',
  fixed_point: 'no bounce repeats any more',
  refused: 'there is no such rig',
};

/**
 * An error against its nearer limit.
 * @typedef {object} Line
 * @property {BudgetError} error
 * @property {import('../../panels/verdict/things.js').Thing} thing
 * @property {number} limit size at which the verdict is lost
 * @property {string} size the limit with its side, in words
 * @property {string} says the sentence on it, as in “Angle sensor reads 3 mrad too much”
 * @property {string} lost what happens beyond it
 * @property {number} has
 * @property {boolean} told the owner has said what he has
 * @property {boolean} own it is in the scene
 * @property {number} ratio limit over what the owner has
 */

/** @param {BudgetError} error @param {Rig['have']} have @returns {Line | null} null for one that nothing is lost by */
function lineOf(error, have) {
  const { field, unit, value, reference, below, above } = error;
  const thing = thingOf(field);
  const sides = /** @type {const} */ ([below, above])
    .map((limit, index) => ({ limit, side: thing.sides?.[index] ?? '' }))
    .filter(({ limit }) => limit !== null && limit.decided_by !== 'range');
  sides.sort((one, other) => (one.limit?.value ?? 0) - (other.limit?.value ?? 0));
  const [{ limit = null, side = '' } = {}] = sides;
  if (!limit) return null;
  const present = Math.abs(value - reference);
  const has = have[field] ?? (present || thing.usual);
  const isNone = limit.value === 0;
  const none = thing.any ?? `any error of ${thing.what}`;
  const size = isNone ? none : `${sizeWords(field, limit.value, unit)}${side && ` ${side}`}`;
  return {
    error,
    thing,
    limit: limit.value,
    size,
    says: capitalized(isNone ? none : `${thing.says} ${size}`),
    lost: LOST[limit.decided_by] ?? reasonOf(limit.outcome?.kind ?? ''),
    has,
    told: field in have,
    own: !(field in have) && present > 0,
    ratio: has === 0 ? Infinity : limit.value / has,
  };
}

/** The lines of a budget, the worst first. @param {Budget} budget @param {Rig['have']} have */
export const linesOf = ({ errors }, have) =>
  (errors ?? []).flatMap((error) => lineOf(error, have) ?? []).sort((one, other) => one.ratio - other.ratio);

/** True where the owner is to act. @param {Line} line */
const isShort = ({ ratio }) => ratio < 1;

/** @param {Line[]} lines @returns {import('../parts.js').Result} */
function firstOf(lines) {
  const isKnown = (/** @type {Line} */ { told, own }) => told || own;
  // What the owner knows of his rig comes before what is usual elsewhere.
  const first = lines.find((line) => isShort(line) && isKnown(line)) ?? lines[0];
  if (!first) return { tone: 'stable', words: 'Nothing ends it within the errors that are tried' };
  if (!isShort(first)) return { tone: 'stable', words: `All fine; the nearest: ${first.says}` };
  const verb = isKnown(first) ? 'Mend' : 'Check';
  return { tone: 'beyond', words: `${verb} ${first.thing.what} first: ${first.size} ends it` };
}

/** Ends of the scale of the bars, as powers of ten of limit over what there is. */
const [LOW, HIGH] = [-2, 2];

/** A bar that ends at the limit; the mark stands where that is what the owner has. @param {{line: Line}} props */
function Bar({ line: { ratio } }) {
  const share = ratio === 0 ? 0 : (Math.log10(ratio) - LOW) / (HIGH - LOW);
  const width = `${100 * Math.max(0.01, Math.min(1, share))}%`;
  const words = ratio >= 100 ? 'a hundred times what you have, or more' : `${number(ratio, 2)} of what you have`;
  return html`<span class=${`bar-track ${ratio < 1 ? 'short' : 'long'}`} role="img" aria-label=${words}>
    <span class="bar-fill" style=${{ width }} /><span class="bar-mark" />
  </span>`;
}

/** @param {{rig: Rig, line: Line}} props */
function Row({ rig, line }) {
  const { error, thing, says, lost, has, told, own } = line;
  const { field, unit } = error;
  const [typed, value] = typedUnit(field, unit);
  const id = `have-${field.replaceAll('.', '-')}`;
  const act = isShort(line) ? (told || own ? 'mend this' : 'check this') : 'fine';
  return html`<li class="limit" data-field=${field}>
    <span class="limit-words">${says}<span class="muted lost">${lost}</span></span>
    <${Bar} line=${line} />
    <span class="limit-has"><label for=${id}>you have ±</label>
      <${NumberField}
        id=${id}
        label=${`You have, ${thing.what}, plus or minus`}
        unit=${typed}
        value=${told ? rig.have[field] / value : undefined}
        placeholder=${String(Number((has / value).toPrecision(3)))}
        fault=${(/** @type {number} */ size) => (size >= 0 ? null : 'It must be 0 or more.')}
        changed=${(/** @type {number | undefined} */ size) => rig.own(field, size === undefined ? undefined : size * value)}
      />
    </span>
    <span class=${`limit-act ${isShort(line) ? 'short' : 'long'}`}>${act}${!told && html`<span class="muted"> ${own ? 'as in your values' : 'if usual'}</span>`}</span>
  </li>`;
}

/** Lines that stand open; the others fold. */
const WORST = 6;

/** @param {{rig: Rig, lines: Line[]}} props */
const Lines = ({ rig, lines }) =>
  html`<ul class="limits">
    ${lines.map((line) => html`<${Row} key=${line.error.field} rig=${rig} line=${line} />`)}
  </ul>`;

/** @param {{budget: Budget, rig: Rig}} props */
function Whole({ budget, rig }) {
  const { errors, together, present, bounces, reason } = budget;
  if (!errors) return html`<p><${Nodes} nodes=${prose(capitalized(reason))} />.</p>`;
  const lines = linesOf(budget, rig.have);
  const [first, rest] = [lines.slice(0, WORST), lines.slice(WORST)];
  const others = errors.filter(({ field }) => !lines.some(({ error }) => error.field === field));
  const free = others.filter(({ reason: why }) => why === null).map(({ field }) => thingOf(field).what);
  const none = others.filter(({ reason: why }) => why !== null);
  const share = (/** @type {number} */ factor) => `${number(100 * factor, 2)} %`;
  return html`<p class="muted">Each alone, until a run of ${number(bounces)} bounces is lost. The line across the bars is what you have; type yours, and the worst comes first. Grey ones are usual in a lab.</p>
    <${Lines} rig=${rig} lines=${first} />
    ${
      rest.length > 0 &&
      html`<details id="other-limits">
        <summary>${rest.length} more</summary>
        <${Lines} rig=${rig} lines=${rest} />
      </details>`
    }
    ${together && html`<p>All at once: each may come to ${share(together.factor.value)} of its limit${lines.some(({ limit }) => limit === 0) && ', but for those that may not be at all'}.</p>`}
    ${present && html`<p>${present.factor.value < 1 ? `The errors in your values are too large together: all would have to come down to ${share(present.factor.value)}.` : `The errors in your values may all grow to ${share(present.factor.value)}.`}</p>`}
    ${
      others.length > 0 &&
      html`<details>
      <summary>${others.length} without a limit here</summary>
      ${free.length > 0 && html`<p>Of any size that was tried: ${free.join(', ')}.</p>`}
      ${none.map(({ field, reason: why }) => html`<p>${capitalized(thingOf(field).what)}: <${Nodes} nodes=${prose(why ?? '')} />.</p>`)}
    </details>`
    }
    <details>
      <summary>Numbers</summary>
      <div class="table-box" tabindex="0" role="region" aria-label="Limits by field">
        <table>
          <thead><tr><th scope="col">field</th><th scope="col">here</th><th scope="col">down by</th><th scope="col">up by</th><th scope="col">unit</th></tr></thead>
          <tbody>${errors.map(({ field, value, below, above, unit }) => html`<tr><th scope="row">${field}</th>${[value, below?.value, above?.value].map((one) => html`<td>${number(one, 4)}</td>`)}<td>${unit}</td></tr>`)}</tbody>
        </table>
      </div>
    </details>`;
}

/**
 * The verdict with the errors that the owner has told: those that end it come after the word of the rig without errors.
 * @param {import('../parts.js').Result} result
 * @param {import('../ask.js').Answer<Stability>} limits
 * @param {Rig['have']} have
 * @returns {import('../parts.js').Result}
 */
export function withErrors(result, { answer, current }, have) {
  if (!result || !current || !answer?.budget?.errors || !['stable', 'beyond'].includes(result.tone)) return result;
  const ending = linesOf(answer.budget, have).find((line) => line.told && isShort(line));
  return ending
    ? { tone: 'beyond', words: `Yes without errors; with yours no: ${ending.thing.what}, ${ending.size}` }
    : result;
}

/** @param {{rig: Rig, limits: import('../ask.js').Answer<Stability>, falls: boolean}} props */
export function Budget({ rig, limits, falls }) {
  useRig(rig);
  const { query } = rig;
  const { answer, current, problem, lost } = limits;
  /** @type {Budget | null} */
  const budget = answer?.budget ?? null;
  const held = query === null || problem !== null || lost !== '';
  /** @type {import('../parts.js').Result} */
  const result = held
    ? { tone: 'none', words: lost ? 'The server does not answer' : 'It has no limits without a verdict' }
    : !budget || !current
      ? { tone: 'none', words: 'Trying some thousand runs…' }
      : budget.errors
        ? firstOf(linesOf(budget, rig.have))
        : {
            tone: falls ? 'unstable' : 'none',
            words: falls ? 'It falls without any error: mend its values first' : 'It has no limits',
          };
  return html`<${Step} n=${3} id="budget" title="What ends it first" open result=${result}>
    <p class="answer">${result?.words}${result?.words.endsWith('…') ? '' : '.'}</p>
    <${Spoken} words=${result?.words ?? ''} />
    ${lost && html`<p>${lost}</p>`}
    ${budget && !held && html`<div class=${current ? '' : 'stale'}><${Whole} budget=${budget} rig=${rig} /></div>`}
  <//>`;
}
