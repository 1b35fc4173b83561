// Step 2: whether the rig balances, why, and for which gains.

import { number, quantity } from '../../dom/numbers.js';
import { capitalized, inWords } from '../../dom/typeset.js';
import { Folded, Numbers, Scale, Spoken, Told, sentence, sign, words as inSymbols } from '../../panels/parts.js';
import { rangeWords } from '../../panels/verdict/facts.js';
import { numbersOf } from '../../panels/verdict/numbers.js';
import { rangeOf, verdictOf } from '../../panels/verdict/words.js';
import { html } from '../../vendor/preact/preact.js';
import { Step, useVerdict } from '../parts.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {import('../rig.js').Rig} Rig */
/** @typedef {import('../../panels/verdict/words.js').Ends} Ends */

/** Gains whose range is told, with symbol and name. */
const GAINS = /** @type {const} */ ([
  ['table.tilt_gain', 'κ', 'tilt gain'],
  ['table.feedback', 'K ×', 'gain of the state feedback, as a factor'],
  ['table.energy_gain', 'κ_E', 'energy gain'],
]);

/** Part of the range that is drawn beyond each end. */
const BEYOND = 0.25;

/** A gain on its ranges: that of small swings around that of this release. @param {{answer: Stability, gain: typeof GAINS[number]}} props */
function Range({ answer, gain: [field, symbol, name] }) {
  const { value, small, release, both: shown } = rangeOf(answer, field);
  if (!shown || (shown.low === null && shown.high === null)) return null;
  const falls = verdictOf(answer).tone === 'unstable';
  const letter = sign(symbol);
  const words = falls
    ? html`<span class="range-words muted">Small swings would hold for ${letter} ${rangeWords(shown)}</span>`
    : html`<span class="range-words">${letter}${` may be ${rangeWords(shown)}`}<span class="muted">${release ? ' for this release' : ' for small swings'}${release && small && ` · ${rangeWords(small)} for small swings`}</span></span>`;
  const ends = [small, release].flatMap((one) => (one ? [one.low, one.high] : [])).filter((end) => end !== null);
  if (shown.low === null || shown.high === null) return html`<p class="range">${words}</p>`;
  const [least, most] = [Math.min(...ends, value), Math.max(...ends, value)];
  const room = (most - least) * BEYOND || 1;
  const bar = (/** @type {Ends | null | undefined} */ one, /** @type {string} */ kind) =>
    one?.low != null && one.high != null ? [[one.low, one.high, kind]] : [];
  return html`<div class=${`range ${falls ? 'falls' : ''}`}>
    ${words}
    <${Scale} low=${least - room} high=${most + room} bars=${[...bar(small, 'small'), ...bar(shown, 'release')]} marks=${[[value, '']]}
      label=${`${name} ${number(value)}: it may be ${rangeWords(shown)}`} />
  </div>`;
}

/** Share of the angle of the release that is tried where the rig falls. */
const LESS = 1 / 3;

/** Changes that are tried where a rig falls, from the one that is made most easily on. @param {import('../../api/scene-fields.js').Scene} scene */
function othersOf({ contact = {}, table = {}, release = {} }) {
  const angle = release.theta ? Number((release.theta * LESS).toPrecision(2)) : null;
  const less =
    angle === null ? null : { words: `Released at ${quantity(angle, 'rad')}`, values: { 'release.theta': angle } };
  const slides = (contact.friction ?? 0) > 0 && (table.slide ?? 'none') === 'none';
  const along = slides
    ? { words: 'With a table that slides along with the foot', values: { 'table.slide': 'matched' } }
    : null;
  const both = along &&
    less && { words: `${along.words}, ${lower(less.words)}`, values: { ...along.values, ...less.values } };
  return [along, less, both];
}

/** @param {string} words */
const lower = (words) => words[0].toLowerCase() + words.slice(1);

/** Changes that would keep it up, where it falls. @param {{rig: Rig}} props */
function Others({ rig }) {
  const others = othersOf(rig.scene);
  const answers = others.map((other) => useVerdict(other && rig.queryOf(rig.with(other.values))));
  const held = others.findIndex((other, index) => {
    const { answer, current } = answers[index];
    return other && current && verdictOf(answer).tone !== 'unstable';
  });
  const other = others[held];
  if (!other) return html`<p>A <a href="#controller">controller</a> may hold it.</p>`;
  const { both: range } = rangeOf(answers[held].answer, 'table.tilt_gain');
  const result = verdictOf(answers[held].answer);
  return html`<p class="other">
    ${other.words}: <${Told} result=${{ ...result, words: result.reason }} />${range && `, κ ${rangeWords(range)}`}.${' '}
    <button type="button" onClick=${() => rig.take(rig.with(other.values))}>Use it</button>
  </p>`;
}

/** @param {{rig: Rig, verdict: import('../../panels/ask.js').Answer<Stability>, result: import('../parts.js').Result}} props */
export function Verdict({ rig, verdict: { answer, problem, lost, current }, result }) {
  const held = !rig.complete || problem || lost;
  const gains = GAINS.filter(([field]) => field !== 'table.energy_gain' || answer?.scene.table.energy_gain !== 0);
  const falls = answer && !held && verdictOf(answer).tone === 'unstable';
  return html`<${Step} n=${2} id="verdict" title="Will it balance?" open result=${result}>
    <p class="headline" aria-busy=${!current}>${result && html`<${Told} result=${result} />`}</p>
    <${Spoken} words=${result?.words ?? ''} />
    ${lost && html`<p>${lost}</p>`}
    ${problem && html`<p>${inSymbols(faultOf(problem))}</p>`}
    ${
      answer &&
      !held &&
      html`${gains.map((gain) => html`<${Range} key=${gain[0]} answer=${answer} gain=${gain} />`)}
      ${falls && html`<${Others} rig=${rig} />`}
      <${Folded} title="Why, and numbers">
        <p>${sentence(answer.verdict.reason)}</p>
        <${Numbers} rows=${numbersOf(answer)} />
        ${answer.notes.map((note) => html`<p class="muted">${sentence(note)}</p>`)}
      <//>`
    }
  <//>`;
}

/** The words of the server on values that it refuses. @param {import('../../api/client.js').Problem} problem */
const faultOf = ({ errors, message }) =>
  errors.length === 0 ? message : errors.map(({ detail }) => `${capitalized(inWords(detail))}.`).join(' ');

/** The first words of the step. @param {Rig} rig @param {import('../../panels/ask.js').Answer<Stability>} verdict @returns {import('../parts.js').Result} */
export function resultOf(rig, { answer, problem, lost }) {
  if (!rig.complete) return { tone: 'none', words: 'No verdict: a value is missing in step 1' };
  if (lost) return { tone: 'none', words: 'No verdict: the server does not answer' };
  if (problem) return { tone: 'none', words: 'No verdict: these values do not go together, see step 1' };
  return answer ? verdictOf(answer) : { tone: 'none', words: 'Asking…' };
}
