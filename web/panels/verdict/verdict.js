// The verdict in a line: what is on the screen, the gains that this release allows, the error that would end it first. The evidence stands
// below the reasons. Where there is no verdict, the line has the reason.

import { marginOf } from '../../api/answers.js';
import { Problem, get } from '../../api/client.js';
import { number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { UNITS, angles } from '../../dom/units.js';
import { html, render, useState } from '../../vendor/preact/preact.js';
import { useTask } from '../ask.js';
import { Headline, Numbers, Spoken, brief, sign } from '../parts.js';
import { endedAs, plainly, toneOf } from './words.js';

/**
 * @typedef {object} State
 * @property {Judged | null} shown the verdict on the page
 * @property {boolean} busy the answer to a newer question is awaited
 * @property {Result} ended the headline of a run that has ended, which goes before that of the setting
 * @property {string | null} played the headline while somebody plays
 * @property {{words: string, label: string, act: () => void} | null} held the reason for no verdict, and the way to mend it
 * @property {(string | null)[]} facts beside the verdict; they come later
 */

/** @param {State} state */
function VerdictLine({ shown, held, played, ended, facts }) {
  const setting = shown && headlineOf(shown.answer);
  const playing = played === null ? null : { tone: 'played', words: played };
  const line = held ? { tone: 'none', words: 'No verdict' } : (playing ?? ended ?? setting);
  // A run that fell by what was done to it is told from its setting.
  const aside = playing !== null || (ended?.tone === 'fell' && setting?.tone !== 'unstable');
  const alone = !held && !playing && aside && setting?.tone === 'stable';
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

/** @typedef {ReturnType<typeof bringVerdict>} Verdict */

/** @param {HTMLElement} root of the line @param {HTMLElement} more place of the evidence */
export function bringVerdict(root, more) {
  /** @type {State} */
  let state = { shown: null, busy: false, ended: null, played: null, held: null, facts: [] };
  const drawLine = () => {
    root.setAttribute('aria-busy', String(state.busy));
    render(html`<${VerdictLine} ...${state} />`, root);
    // The evidence of the last verdict is out of sight until there is another.
    more.hidden = state.held !== null;
  };
  const drawEvidence = () => {
    if (state.shown) render(html`<${Answer} ...${state.shown} />`, more);
  };
  root.replaceChildren();
  drawLine();
  document.addEventListener(UNITS, drawLine);
  document.addEventListener(UNITS, drawEvidence);
  return {
    /** @param {Partial<State>} changes */
    tell: (changes) => {
      const before = state;
      state = { ...before, ...changes };
      // It is called at each bounce, and at each turn of a knob.
      if (/** @type {(keyof State)[]} */ (Object.keys(changes)).some((name) => state[name] !== before[name]))
        drawLine();
      if (state.shown !== before.shown) drawEvidence();
    },
  };
}

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
function headlineOf(answer) {
  const { kind: end, bounces } = answer.nonlinear.outcome;
  const tone = toneOf(answer);
  const survived = `${number(bounces, 8)} bounces of a fresh release survived`;
  const run = end === 'completed' ? survived : `a fresh release ${endedAs(end, bounces)}`;
  return { tone, words: HEADLINES[tone], term: `${answer.verdict.code.replaceAll('_', ' ')}; ${run}` };
}

/** A sentence of the server. @param {{text: string, class: string}} props */
const Said = ({ text, class: kind }) => html`<p class=${kind}>${brief(capitalized(plainly(text)))}</p>`;

/** @param {Judged} props */
function Answer({ answer, scene }) {
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
    <p class="chips row">
      <span class="chip">decided by ${DECIDERS[verdict.decided_by]}</span>
      ${agree === true && html`<span class="chip">linear map and fresh release agree</span>`}
      ${agree === false && html`<span class="chip caution">linear map and fresh release disagree</span>`}
    </p>
    ${asked && html`<p class="asked">The table tilts up to ${asked}.</p>`}
    <details class="verdict-numbers">
      <summary>Numbers of the verdict</summary>
      <${Numbers} rows=${numbersOf(answer)} />
    </details>
    <${Evidence} answer=${answer} scene=${String(scene)} />
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

/** The evidence beyond the linear map in sentences with their names. @param {Stability} answer */
function sentences({ rotation_number: rotation, chaos, predictable_bounces: predictable }) {
  const { measured = null, small, resonance, strong_resonance: near } = rotation ?? {};
  const turns =
    measured === null
      ? `Small deviations make ${number(small)} turns a bounce`
      : `A fresh release makes ${number(measured)} turns a bounce, small deviations ${number(small)}`;
  const part = chaos?.chaotic
    ? 'Chaotic: nearby runs part exponentially'
    : 'Regular: nearby runs part no faster than evenly';
  const watched = number(chaos?.bounces);
  const rounding = 'a thousandth of the bounce’s speed';
  const lasts =
    predictable === null
      ? chaos && `For all ${watched} bounces watched: rounding stays below ${rounding}.`
      : `For ${number(predictable)} bounces: then rounding has grown to ${rounding}, and a single run means nothing.`;
  /** @type {Record<string, unknown>} */
  const told = {
    Rotation:
      resonance &&
      `${turns}; the nearest resonance is ${resonance.p}/${resonance.q}, ${number(resonance.distance, 2)} turns away.`,
    Chaos: chaos && `${part} (MEGNO ${number(chaos.indicator, 3)} over ${watched} bounces; regular is up to 2).`,
    Predictable: lasts,
    Resonance:
      near &&
      `${near.p}/${near.q}: the rotation number is within ${number(near.distance, 2)} of it. Near it the basin may have a dent, which the linear verdict does not see.`,
  };
  return Object.entries(told).filter(([, words]) => words);
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

/** How far the body may be released aside, once somebody asks. @param {{scene: string}} props */
function Basin({ scene }) {
  const [measured, take] = useState(/** @type {Stability | null} */ (null));
  const task = useTask('Trying some 400 release angles', '');
  const failed = (/** @type {unknown} */ error) =>
    error instanceof Problem ? error.message : 'The server did not answer.';
  const ask = async () => take(await task.run((signal) => get(`v1/stability?${scene}&basin=true`, signal), failed));
  if (measured) return html`${brief(basinSentence(measured))}`;
  const told = task.words || 'How far aside may it be released?';
  return html`${told} ${!task.active && html`<button type="button" id="basin" onClick=${ask}>Measure it</button>`}`;
}

/** @param {{answer: Stability, scene: string}} props */
function Evidence({ answer, scene }) {
  // A point has no angle that could turn or be released aside.
  if ('point' in answer.scene.body || !answer.fixed_point) return null;
  return html`<details class="evidence">
    <summary>${gist(answer)}</summary>
    <dl aria-label="Beyond the linear map">
      ${sentences(answer).map(([name, words]) => html`<dt>${name}</dt><dd>${words}</dd>`)}
      <dt>Basin</dt>
      <dd><span role="status"><${Basin} key=${scene} scene=${scene} /></span></dd>
    </dl>
  </details>`;
}

/** Names, values and meanings, for a list of numbers. @param {Stability} answer */
export const numbersOf = (answer) =>
  [...linearNumbers(answer), ...cubicNumbers(answer), ...lossNumbers(answer), ...runNumbers(answer)].filter(
    (row) => row !== null,
  );

/** @param {Stability} answer */
function linearNumbers(answer) {
  const { linear } = answer;
  if (!linear) return [];
  const gain = marginOf(answer, 'table.tilt_gain');
  const energy = marginOf(answer, 'table.energy_gain');
  const { residue, rotation, spectral_radius: radius } = linear;
  const { below, above } = gain ?? {};
  const steered = energy ? `${quantity(energy.value, 's²/m²')} of ${number(energy.above?.limit)}` : '';
  return [
    gain ? [sign('κ'), number(gain.value), 'tilt gain'] : null,
    above ? [sign('κ_c'), number(above.limit, 5), 'critical gain'] : null,
    below && above
      ? ['margin', `${number(below.margin, 3)} · ${number(above.margin, 3)}`, 'to lower · upper end']
      : null,
    residue != null ? [sign('R'), number(residue), `residue: ${linear.kind}`] : null,
    rotation != null ? [sign('σ'), quantity(rotation, 'rad'), 'rotation a bounce'] : null,
    radius != null ? ['max |λ|', number(radius, 5), 'spectral radius'] : null,
    energy?.value ? [sign('κ_E'), steered, `energy gain: λ ${number(linear.energy_eigenvalue)}`] : null,
  ];
}

/** @param {Stability} answer */
function cubicNumbers({ boundary, lyapunov }) {
  const { coefficient = null, kind = '', escape_bounces: bounces = null } = lyapunov ?? {};
  const leaves = bounces === null ? '' : `, leaves in about ${number(bounces, 3)} bounces`;
  return [
    boundary ? [sign('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`] : null,
    lyapunov ? [sign('ℓ'), quantity(coefficient, '/rad²', 3), `swing: ${kind}${leaves}`] : null,
  ];
}

/** @param {Stability} answer */
function lossNumbers({ loss_of_stability: losses }) {
  const others = (losses ?? []).filter(({ field }) => field !== 'table.tilt_gain');
  return others.map(({ field, value, kind, swing, heights }) => {
    const bounds = heights?.map((height) => quantity(height, 'm', 3)).join(' and ');
    const to = swing !== null ? `±${quantity(swing, 'rad', 3)}` : bounds && `${bounds} in turn`;
    const meaning = `stability is lost there: ${kind}${to ? `, here to ${to}` : ''}`;
    return field === 'table.feedback'
      ? ['gains ×', number(value, 4), meaning]
      : [sign('κ_E'), quantity(value, 's²/m²', 4), meaning];
  });
}

/** @param {Stability} answer */
function runNumbers({ drift_speed: drift, nonlinear: { max_theta: largest, outcome, demand: load } }) {
  const tilt = load && `${quantity(load.tilt, 'rad', 3)} · ${quantity(load.tilt_rate, 'rad/s', 3)}`;
  const stroke = load && `${quantity(load.stroke, 'm', 3)} · ${quantity(load.speed, 'm/s', 3)}`;
  const moves = load && (load.speed > 0 || load.stroke > 0);
  return [
    drift != null ? [sign('c'), quantity(drift, 'm/s', 3), 'drift of the whole'] : null,
    ['max |θ|', quantity(largest, 'rad'), `${number(outcome.bounces, 6)} bounces: ${outcome.kind}`],
    tilt ? ['tilt', tilt, 'most tilt · tilt rate asked'] : null,
    moves ? ['stroke', stroke, 'most stroke · speed asked'] : null,
  ];
}
