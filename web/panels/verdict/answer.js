// A verdict in plain words with its term, its margin, its reason, its numbers, the evidence beyond the linear map, and the model it is for.

import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { entries } from '../../dom/tables.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { budget } from './budget.js';
import { evidence } from './evidence.js';
import { marginBar } from './margin-bar.js';
import { numbersOf } from './numbers.js';
import { endedAs, plainly } from './plain-words.js';

/** @typedef {import('contract').Stability} Stability */

const DECIDERS = {
  linear: 'the linear map',
  nonlinear: 'a fresh release',
  boundary: 'the boundary',
  lyapunov: 'the third order',
};

/** The headlines, with a sign that shows each without colour. */
const KINDS = {
  none: ['–', 'No verdict'],
  unstable: ['▲', 'Falls'],
  beyond: ['◆', 'On the edge'],
  stable: ['●', 'Keeps balance'],
};

/** @param {Stability} answer @returns {keyof typeof KINDS} */
function kindOf({ verdict, nonlinear, chaos }) {
  if (verdict === null) return 'none';
  if (verdict.startsWith('unstable')) return 'unstable';
  if (verdict.startsWith('weakly') && nonlinear?.outcome !== 'completed') return 'unstable';
  if (/^(bounded|weakly unstable)/.test(verdict) || (verdict.startsWith('elliptic') && chaos?.chaotic)) return 'beyond';
  return 'stable';
}

/** The field's term for a verdict and the run that it rests on. @param {Stability} answer */
function termOf({ verdict, nonlinear }) {
  const term = verdict?.split(',')[0] ?? 'not judged';
  if (!nonlinear) return term;
  const { outcome, impacts } = nonlinear;
  return outcome === 'completed'
    ? `${term}; ${number(impacts, 8)} bounces of a fresh release survived`
    : `${term}; a fresh release ${endedAs(outcome, impacts)}`;
}

/**
 * @param {Stability} answer
 * @param {(query: string) => Promise<Stability>} ask asks for the verdict with more, which is dearer
 */
export function answerParts(answer, ask) {
  const { decided_by: decider, reason, agree, model, notes, nonlinear } = answer;
  const kind = kindOf(answer);
  const [sign, headline] = KINDS[kind];
  const term = termOf(answer);
  const agreement = agree ? 'linear map and fresh release agree' : 'linear map and fresh release disagree';
  const say = (/** @type {string} */ words) => prose(capitalized(plainly(words)));
  const note = (/** @type {string} */ words) => h('p', { class: 'muted' }, ...say(words));
  const load = nonlinear?.demand;
  const asked =
    load && `The table tilts up to ${quantity(load.tilt, 'rad', 3)} and ${quantity(load.tilt_rate, 'rad/s', 3)}.`;
  const head = [
    h(
      'div',
      { class: `verdict-words ${kind}` },
      h('p', { class: 'headline' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, sign), ` ${headline}`),
      h('p', { class: 'verdict-term' }, ...prose(capitalized(term))),
    ),
  ];
  const more = [
    marginBar(answer),
    reason ? h('p', { class: 'reason' }, ...say(reason)) : '',
    h(
      'p',
      { class: 'chips' },
      decider ? h('span', { class: 'chip' }, `decided by ${DECIDERS[decider] ?? decider}`) : '',
      agree === null ? '' : h('span', { class: `chip ${agree ? '' : 'caution'}` }, agreement),
    ),
    asked ? h('p', { class: 'asked' }, asked) : '',
    h(
      'details',
      { class: 'verdict-numbers' },
      h('summary', {}, 'Numbers of the verdict'),
      h('dl', { class: 'numbers' }, ...entries(numbersOf(answer))),
    ),
    evidence(answer, () => ask('basin=true')),
    budget(ask),
    h(
      'details',
      { class: 'model' },
      h('summary', {}, `Model: ${model.name.replaceAll('_', ' ')}`),
      note(model.reason),
      ...notes.map(note),
    ),
  ];
  return { said: `${headline.toLowerCase()}; ${term}`, head, more };
}
