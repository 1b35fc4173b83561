// A verdict in plain words with its term, its margin, its reason, its numbers, the evidence beyond the linear map, and the model it is for.

import { Problem } from '../../api/client.js';
import { number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { angles } from '../../dom/units.js';
import { html, useState } from '../../vendor/preact/preact.js';
import { Headline, Numbers, brief } from '../parts.js';
import { numbersOf } from './numbers.js';
import { endedAs, plainly, toneOf } from './words.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {(query: string) => Promise<Stability>} Measure asks for the verdict with more, which is dearer */

const HEADLINES = { unstable: 'Falls', beyond: 'On the edge', stable: 'Stays up' };

const DECIDERS = {
  linear: 'the linear map',
  nonlinear: 'a fresh release',
  boundary: 'the boundary',
  lyapunov: 'the third order',
  fixed_point: 'the bounces, of which none repeats',
  ensemble: 'runs with noise',
};

/** The headline of a verdict, and the field's term with the run that it rests on. @param {Stability} answer */
export function headlineOf(answer) {
  const { kind: end, bounces } = answer.nonlinear.outcome;
  const tone = toneOf(answer);
  const survived = `${number(bounces, 8)} bounces of a fresh release survived`;
  const run = end === 'completed' ? survived : `a fresh release ${endedAs(end, bounces)}`;
  return { tone, words: HEADLINES[tone], term: `${answer.verdict.code.replaceAll('_', ' ')}; ${run}` };
}

/** A sentence of the server. @param {{text: string, class: string}} props */
const Said = ({ text, class: kind }) => html`<p class=${kind}>${brief(capitalized(plainly(text)))}</p>`;

/** @param {import('../card.js').Judged & {measure: Measure}} props */
export function Answer({ answer, scene, measure }) {
  const { verdict, agree, model, notes, nonlinear } = answer;
  const headline = headlineOf(answer);
  const load = nonlinear?.demand;
  const asked = load && `${quantity(load.tilt, 'rad', 3)} and ${quantity(load.tilt_rate, 'rad/s', 3)}`;
  return html`<p class="line-label">This setting</p>
    <div class="verdict-words">
      <${Headline} result=${headline} />
      <p class="verdict-term">${brief(capitalized(headline.term))}</p>
    </div>
    <${Said} class="reason" text=${verdict.reason} />
    <p class="chips">
      <span class="chip">decided by ${DECIDERS[verdict.decided_by]}</span>
      ${agree === true && html`<span class="chip">linear map and fresh release agree</span>`}
      ${agree === false && html`<span class="chip caution">linear map and fresh release disagree</span>`}
    </p>
    ${asked && html`<p class="asked">The table tilts up to ${asked}.</p>`}
    <details class="verdict-numbers">
      <summary>Numbers of the verdict</summary>
      <${Numbers} rows=${numbersOf(answer)} />
    </details>
    <${Evidence} answer=${answer} scene=${String(scene)} measure=${measure} />
    <p class="model">
      <a class="budget" href=${`rig?${scene}#budget`}>What may go wrong: the errors of a rig that end it</a>
    </p>
    <details class="model">
      <summary>Model: ${model.name.replaceAll('_', ' ')}</summary>
      ${[model.reason, ...notes].map((words) => html`<${Said} class="muted" text=${words} />`)}
    </details>`;
}

/** @param {number} angle */
const inBoth = (angle) =>
  `${quantity(angle, 'rad')}${angles() === 'deg' ? '' : ` (${quantity((angle * 180) / Math.PI, '°', 3)})`}`;

/** The evidence beyond the linear map in sentences with their names. @param {Stability} answer @returns {string[][]} */
function sentences({ rotation_number: rotation, chaos, predictable_bounces: predictable }) {
  const found = [];
  if (rotation) {
    const { measured, small, resonance } = rotation;
    const turns =
      measured === null
        ? `Small deviations make ${number(small)} turns a bounce`
        : `A fresh release makes ${number(measured)} turns a bounce, small deviations ${number(small)}`;
    const { p, q, distance } = resonance;
    found.push(['Rotation', `${turns}; the nearest resonance is ${p}/${q}, ${number(distance, 2)} turns away.`]);
  }
  if (chaos) {
    const part = chaos.chaotic
      ? 'Chaotic: nearby runs part exponentially'
      : 'Regular: nearby runs part no faster than evenly';
    const indicator = `MEGNO ${number(chaos.indicator, 3)} over ${number(chaos.bounces)} bounces; regular is up to 2`;
    found.push(['Chaos', `${part} (${indicator}).`]);
  }
  const rounding = 'a thousandth of the bounce’s speed';
  if (predictable !== null) {
    const then = `then rounding has grown to ${rounding}, and a single run means nothing`;
    found.push(['Predictable', `For ${number(predictable)} bounces: ${then}.`]);
  } else if (chaos) {
    found.push(['Predictable', `For all ${number(chaos.bounces)} bounces watched: rounding stays below ${rounding}.`]);
  }
  const near = rotation?.strong_resonance;
  if (near) {
    const dent = 'Near it the basin may have a dent, which the linear verdict does not see';
    const within = `the rotation number is within ${number(near.distance, 2)} of it`;
    found.push(['Resonance', `${near.p}/${near.q}: ${within}. ${dent}.`]);
  }
  return found;
}

/** @param {Stability} answer */
function basinSentence({ basin, no_basin: reason }) {
  if (!basin) return `There is none: ${reason}.`;
  const { theta, unbroken, holes, bounces, spacing } = basin;
  const tried = `angles were tried every ${quantity(spacing, 'rad', 2)}.`;
  const survives = `survive ${number(bounces)} bounces`;
  if (theta === 0) return `Released at rest anywhere aside, it does not ${survives}; ${tried}`;
  const gaps = holes.length === 1 ? 'a gap' : `${holes.length} gaps`;
  const beyond = holes.length === 0 ? '' : `, and with ${gaps} up to ${inBoth(theta)}`;
  return `Released at rest it ${survives.replace('survive', 'survives')} from up to ${inBoth(unbroken)} to either side${beyond}; ${tried}`;
}

/** The evidence in a line, for a first look. @param {Stability} answer */
function gist({ rotation_number: rotation, chaos, predictable_bounces: predictable }) {
  const near = rotation?.strong_resonance;
  const turns = rotation && `${number(rotation.measured ?? rotation.small, 3)} turns a bounce`;
  const parts = [
    chaos && (chaos.chaotic ? 'chaotic' : 'regular'),
    turns && (near ? `${turns}, near ${near.p}/${near.q}` : turns),
    predictable !== null
      ? `predictable for ${number(predictable)} bounces`
      : chaos && `predictable ≥ ${number(chaos.bounces)} bounces`,
  ];
  return capitalized(parts.filter(Boolean).join(' · ')) || 'Beyond the linear map';
}

/** How far the body may be released aside, once somebody asks. @param {{measure: Measure}} props */
function Basin({ measure }) {
  const [measured, take] = useState(/** @type {Stability | null} */ (null));
  const [told, tell] = useState({ words: 'How far aside may it be released?', busy: false });
  const ask = async () => {
    tell({ words: 'Trying some 400 release angles…', busy: true });
    try {
      take(await measure('basin=true'));
    } catch (error) {
      tell({ words: error instanceof Problem ? error.message : 'The server did not answer.', busy: false });
    }
  };
  if (measured) return html`${brief(basinSentence(measured))}`;
  return html`${told.words} ${!told.busy && html`<button type="button" id="basin" onClick=${ask}>Measure it</button>`}`;
}

/** @param {{answer: Stability, scene: string, measure: Measure}} props */
function Evidence({ answer, scene, measure }) {
  // A point has no angle that could turn or be released aside.
  if ('point' in answer.scene.body || !answer.fixed_point) return null;
  return html`<details class="evidence">
    <summary>${gist(answer)}</summary>
    <dl aria-label="Beyond the linear map">
      ${sentences(answer).map(([name, words]) => html`<dt>${name}</dt><dd>${words}</dd>`)}
      <dt>Basin</dt>
      <dd><span role="status"><${Basin} key=${scene} measure=${measure} /></span></dd>
    </dl>
  </details>`;
}
