// Step 3: what ends the balance first. Each limit is set against what the owner has.

import { number } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { useAnswer } from '../../panels/ask.js';
import { Folded, NumberField, Row, Scale, Spoken, Table, sentence } from '../../panels/parts.js';
import { linesOf } from '../../panels/verdict/facts.js';
import { ERRORS, thingOf, typedUnit } from '../../panels/verdict/things.js';
import { html } from '../../vendor/preact/preact.js';
import { Step } from '../parts.js';

/** @typedef {import('../rig.js').Rig} Rig */
/** @typedef {import('contract').Stability} Stability */
/** @typedef {NonNullable<Stability['budget']>} Budget */
/** @typedef {import('../../panels/verdict/facts.js').Line} Line */
/** @typedef {import('../../panels/ask.js').Answer<Stability>} Limits */

/** Bounces that a run has to survive: fewer than those of the verdict, for a budget takes a thousand runs. */
const BOUNCES = 500;
/** Time without a change before it is asked, ms. */
const QUIET_MS = 350;

/** The budget of a scene, once it stays. @param {string | URLSearchParams | null} query null for none */
export const useBudget = (query) =>
  useAnswer(query && `v1/stability?${query}&budget=true&bounces=${BOUNCES}`, QUIET_MS);

/** The first line in a sentence. @param {Line[]} lines @returns {import('../parts.js').Result} */
function firstOf([first]) {
  if (!first) return { tone: 'stable', words: 'Nothing ends it within the errors that are tried' };
  if (!first.short) return { tone: 'stable', words: `All fine; the nearest: ${first.says}` };
  const verb = first.known ? 'Mend' : 'Check';
  return { tone: 'beyond', words: `${verb} ${first.thing.what} first: ${first.size} ends it` };
}

/** Ends of the scale of the bars, as powers of ten of limit over what there is. */
const [LOW, HIGH] = [-2, 2];

/** A bar that ends at the limit; the mark stands where that is what the owner has. @param {{line: Line}} props */
function Bar({ line: { ratio } }) {
  const words = ratio >= 100 ? 'a hundred times what you have, or more' : `${number(ratio, 2)} of what you have`;
  const end = ratio === 0 ? LOW : Math.log10(ratio);
  return html`<${Scale} low=${LOW} high=${HIGH} bars=${[[LOW, Math.max(LOW + 0.04, end), '']]} marks=${[[0, '']]} label=${words} kind=${ratio < 1 ? 'short' : 'long'} />`;
}

/** The field for what the owner has. @param {{rig: Rig, field: string, unit: string, has: number}} props */
function Has({ rig, field, unit, has }) {
  const { what } = thingOf(field);
  const [typed, size] = typedUnit(field, unit);
  const id = `have-${field.replaceAll('.', '-')}`;
  return html`<span class="limit-has"><label for=${id}>you have ±</label>
    <${NumberField}
      id=${id}
      label=${`You have, ${what}, plus or minus`}
      unit=${typed}
      value=${field in rig.have ? rig.have[field] / size : undefined}
      placeholder=${String(Number((has / size).toPrecision(3)))}
      open
      fault=${(/** @type {number} */ value) => (value >= 0 ? null : 'It must be 0 or more.')}
      changed=${(/** @type {number | undefined} */ value) => rig.own(field, value === undefined ? undefined : value * size)}
    />
  </span>`;
}

/** @param {{rig: Rig, line: Line}} props */
function Limit({ rig, line }) {
  const { error, says, lost, has, told, own, known, short } = line;
  const act = short ? (known ? 'mend this' : 'check this') : 'fine';
  return html`<li class="limit" data-field=${error.field}>
    <span class="limit-words">${says}<span class="muted lost">${lost}</span></span>
    <${Bar} line=${line} />
    <${Has} rig=${rig} field=${error.field} unit=${error.unit} has=${has} />
    <span class=${`limit-act ${short ? 'short' : 'long'}`}>${act}${!told && html`<span class="muted"> ${own ? 'as in your values' : 'if usual'}</span>`}</span>
  </li>`;
}

/** Lines that stand open; the others fold. */
const WORST = 6;

/** @param {{rig: Rig, lines: Line[]}} props */
const Lines = ({ rig, lines }) =>
  html`<ul class="limits">
    ${lines.map((line) => html`<${Limit} key=${line.error.field} rig=${rig} line=${line} />`)}
  </ul>`;

/** The errors of a rig that has no limits, for its owner to tell of. @param {{rig: Rig}} props */
const Unlimited = ({ rig }) => html`<p class="muted">Tell already what your rig has; its limits come with a verdict.</p>
  <ul class="limits">
    ${rig.fields
      .filter(({ field }) => ERRORS.includes(field))
      .map(
        ({ field, unit }) => html`<li class="limit" key=${field} data-field=${field}>
        <span class="limit-words">${capitalized(thingOf(field).what)}</span>
        <${Has} rig=${rig} field=${field} unit=${unit} has=${thingOf(field).usual} />
      </li>`,
      )}
  </ul>`;

/** @param {{budget: Budget, rig: Rig}} props */
function Whole({ budget, rig }) {
  const { errors, together, present, bounces, reason } = budget;
  if (!errors) return html`<p>${sentence(reason ?? '')}</p><${Unlimited} rig=${rig} />`;
  const lines = linesOf(budget, rig.have);
  const rest = lines.slice(WORST);
  const others = errors.filter(({ field }) => !lines.some(({ error }) => error.field === field));
  const free = others.filter(({ reason: why }) => why === null).map(({ field }) => thingOf(field).what);
  const none = others.filter(({ reason: why }) => why !== null);
  const share = (/** @type {number} */ factor) => `${number(100 * factor, 2)} %`;
  return html`<p class="muted">Each alone, until a run of ${number(bounces)} bounces is lost. The line across the bars is what you have; type yours, and the worst comes first. Grey ones are usual in a lab.</p>
    <${Lines} rig=${rig} lines=${lines.slice(0, WORST)} />
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
      html`<${Folded} title=${`${others.length} without a limit here`}>
        ${free.length > 0 && html`<p>Of any size that was tried: ${free.join(', ')}.</p>`}
        ${none.map(({ field, reason: why }) => html`<p>${capitalized(thingOf(field).what)}: ${sentence(why ?? '')}</p>`)}
      <//>`
    }
    <${Folded} title="Numbers">
      <${Table} label="Limits by field" head=${['field', 'here', 'down by', 'up by', 'unit']}>
        ${errors.map(({ field, value, below, above, unit }) => html`<${Row} cells=${[field, ...[value, below?.value, above?.value].map((one) => number(one, 4)), unit]} />`)}
      <//>
    <//>`;
}

/**
 * The verdict with the errors that the owner has told: those that end it come after the word of the rig without errors.
 * @param {import('../parts.js').Result} result
 * @param {Limits} limits
 * @param {Rig['have']} have
 * @returns {import('../parts.js').Result}
 */
export function withErrors(result, { answer, current }, have) {
  if (!result || !current || !answer?.budget?.errors || !['stable', 'beyond'].includes(result.tone)) return result;
  const ending = linesOf(answer.budget, have).find(({ told, short }) => told && short);
  return ending
    ? { tone: 'beyond', words: `Yes without errors; with yours no: ${ending.thing.what}, ${ending.size}` }
    : result;
}

/** @param {Rig} rig @param {Limits} limits @param {boolean} falls @returns {NonNullable<import('../parts.js').Result>} */
function resultOf(rig, { answer, current, problem, lost }, falls) {
  if (lost) return { tone: 'none', words: 'The server does not answer' };
  if (rig.query === null || problem) return { tone: 'none', words: 'It has no limits without a verdict' };
  if (!answer?.budget || !current) return { tone: 'none', words: 'Trying some thousand runs…' };
  if (answer.budget.errors) return /** @type {any} */ (firstOf(linesOf(answer.budget, rig.have)));
  return falls
    ? { tone: 'unstable', words: 'It falls without any error: mend its values first' }
    : { tone: 'none', words: 'It has no limits' };
}

/** @param {{rig: Rig, limits: Limits, falls: boolean}} props */
export function Budget({ rig, limits, falls }) {
  const { answer, current, problem, lost } = limits;
  const result = resultOf(rig, limits, falls);
  const isLacking = rig.query === null || problem !== null;
  return html`<${Step} n=${3} id="budget" title="What ends it first" open result=${result}>
    <p class="answer">${result.words}${result.words.endsWith('…') ? '' : '.'}</p>
    <${Spoken} words=${result.words} />
    ${lost && html`<p>${lost}</p>`}
    ${isLacking && !lost && html`<${Unlimited} rig=${rig} />`}
    ${answer?.budget && !isLacking && !lost && html`<div class=${current ? '' : 'stale'}><${Whole} budget=${answer.budget} rig=${rig} /></div>`}
  <//>`;
}
