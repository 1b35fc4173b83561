// Step 4: the law of the table as it is, beside a designed one.

import { merged } from '../../api/scene-query.js';
import { number, quantity } from '../../dom/numbers.js';
import { useAnswer } from '../../panels/ask.js';
import { Row, Table, Told, sign, words } from '../../panels/parts.js';
import { Panel } from '../../panels/card.js';
import { linesOf, rangeWords } from '../../panels/verdict/facts.js';
import { rangeOf, verdictOf } from '../../panels/verdict/words.js';
import { html, useState } from '../../vendor/preact/preact.js';
import { RIG_PANELS } from '../panels.js';
import { Step, useVerdict } from '../parts.js';
import { useBudget } from './budget.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {import('contract').Controller} Law */
/** @typedef {import('../rig.js').Rig} Rig */

/** Time without a change before it is asked, ms. */
const QUIET_MS = 200;

const GAINS = /** @type {const} */ ([
  ['x', 'K_x', 'rad/m'],
  ['theta', 'K_θ', '1'],
  ['x_dot', 'K_ẋ', 'rad·s/m'],
  ['theta_dot', 'K_θ̇', 's'],
]);

/** The law of a scene in symbols. @param {import('../../api/scene-fields.js').Scene} scene */
function lawOf({ table = {} }) {
  if (!table.feedback) return [sign('κ'), ` ${number(table.tilt_gain)}`];
  return GAINS.filter(([name]) => table.feedback[name] !== undefined).map(
    ([name, letter, unit], index) =>
      html`${index > 0 && ', '}${sign(letter)} ${quantity(table.feedback[name], unit, 3)}`,
  );
}

/** Tilt gain that is tried where a case has none. */
const USUAL_GAIN = 1.1;

/** A scene with a tilt gain in place of its state feedback. @param {Rig} rig */
const withGain = ({ scene, chosen }) =>
  merged(scene, { table: { feedback: null, tilt_gain: chosen?.scene.table?.tilt_gain ?? USUAL_GAIN } });

/** A scene with another law. @param {import('../../api/scene-fields.js').Scene} scene @param {Law['gain']} gain */
const withLaw = (scene, gain) => merged(scene, { table: { tilt_gain: null, feedback: gain } });

/** The compared cells of a law. @param {Stability} answer */
function factsOf(answer) {
  const { both: range } = rangeOf(answer, answer.scene.table.feedback ? 'table.feedback' : 'table.tilt_gain');
  const radius = answer.linear?.spectral_radius ?? NaN;
  const dies = `falls to a tenth in ${number(Math.log(0.1) / Math.log(radius), 2)} bounces`;
  return [
    answer.verdict.code === 'unstable' || Number.isNaN(radius) ? '–' : radius < 1 ? dies : 'goes on',
    range ? rangeWords(range) : '–',
    answer.nonlinear.demand ? quantity(answer.nonlinear.demand.tilt, 'rad', 3) : '–',
  ];
}

/**
 * @param {object} props
 * @param {Rig} props.rig
 * @param {string} props.name
 * @param {import('../../api/scene-fields.js').Scene} props.scene with the law
 * @param {boolean} props.open somebody sees it
 * @param {boolean} props.held there is no verdict on the rig
 */
function Law({ rig, name, scene, open, held }) {
  const query = rig.complete ? String(rig.queryOf(scene)) : null;
  const judged = useVerdict(query);
  // What held before is no answer to values that do not go together.
  const { current } = judged;
  const answer = held || judged.problem || judged.lost ? null : judged.answer;
  const { answer: limits, current: limited } = useBudget(open ? query : null);
  const [first] = limits?.budget?.errors && limited ? linesOf(limits.budget, rig.have) : [];
  const facts = answer ? factsOf(answer) : ['–', '–', '–'];
  const use = html`<button type="button" disabled=${!current} onClick=${() => rig.take(scene)} aria-label=${`Use it: ${name}`}>Use it</button>`;
  return html`<${Row} kind=${current ? '' : 'stale'} cells=${[
    html`${name}<span class="muted law">${lawOf(scene)}</span>`,
    answer ? html`<${Told} result=${verdictOf(answer)} />` : '–',
    ...facts,
    first && answer ? first.says : limited || !answer ? '–' : '…',
    query === rig.words ? 'in use' : use,
  ]} />`;
}

const HEAD = [
  'Law',
  'Balances?',
  'A swing',
  'Gain may be',
  'Most tilt',
  'Ends it first',
  html`<span class="unseen">Use</span>`,
];

/** @param {{rig: Rig, held: boolean}} props */
export function Controller({ rig, held }) {
  /** The design by other weights is open; null before it was for the first time. */
  const [weighed, weigh] = useState(/** @type {boolean | null} */ (null));
  const { query, scene } = rig;
  // A point has no angle to feed back.
  const isPoint = Boolean(scene.body?.point);
  const designed = useAnswer(query && !isPoint ? `v1/controllers?${query}` : null, QUIET_MS);
  /** The newest law stays until there is another, so that nothing moves. @type {Law | null} */
  const law = isPoint || designed.problem ? null : designed.answer;
  const other = law && withLaw(scene, law.gain);
  const judged = useVerdict(other && rig.queryOf(other));
  const found = judged.current ? judged.answer : null;
  const isFeedback = Boolean(scene.table?.feedback);
  /** @type {import('../parts.js').Result} */
  const result = held
    ? { tone: 'none', words: 'It has no laws without a verdict' }
    : designed.problem || isPoint
      ? { tone: 'none', words: 'No state feedback for this body' }
      : found
        ? { tone: verdictOf(found).tone, words: `State feedback, designed: ${verdictOf(found).reason}` }
        : { tone: 'none', words: 'Asking…' };
  const body = (/** @type {boolean} */ open) => html`<${Table} label="Controllers compared" kind="laws" head=${HEAD}>
      <${Law} rig=${rig} open=${open} held=${held} name=${isFeedback ? 'State feedback, as it is' : 'Tilt gain, as it is'} scene=${scene} />
      ${isFeedback && html`<${Law} rig=${rig} open=${open} held=${held} name="Tilt gain alone" scene=${withGain(rig)} />`}
      ${other && html`<${Law} rig=${rig} open=${open} held=${held} name="State feedback, designed" scene=${other} />`}
    <//>
    ${isPoint && html`<p>A point has no angle of its own, and so no state feedback.</p>`}
    ${designed.problem && !held && html`<p>${words(designed.problem.message)}</p>`}
    ${designed.lost && html`<p>${designed.lost}</p>`}
    <p class="muted">A tilt in proportion to the angle keeps a body circling. State feedback needs its place and velocities too, and brings it to rest in place.</p>
    <details onToggle=${(/** @type {Event} */ event) => weigh(/** @type {HTMLDetailsElement} */ (event.currentTarget).open)}>
      <summary>Design it by other weights</summary>
      ${weighed !== null && html`<${Panel} entry=${RIG_PANELS.design} page=${rig} open=${weighed && open} />`}
    </details>`;
  return html`<${Step} n=${4} id="controller" title="Choose a controller" result=${result}>${body}<//>`;
}
