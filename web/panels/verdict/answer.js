// A verdict with its reason, its numbers, the evidence beyond the linear map, and the model it is for.

import { h } from '../../dom/elements.js';
import { entries } from '../../dom/tables.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { evidence } from './evidence.js';
import { numbersOf } from './numbers.js';

/** @typedef {import('contract').Stability} Stability */

const DECIDERS = {
  linear: 'the linear map',
  nonlinear: 'the run',
  boundary: 'the boundary',
  lyapunov: 'the third order',
};

const SIGNS = { none: '–', unstable: '▲', beyond: '◆', stable: '●' };

/** The kind of a verdict; its sign shows it without colour. @param {string | null} verdict */
function kindOf(verdict) {
  if (verdict === null) return 'none';
  if (verdict.startsWith('unstable') || /this run ended/.test(verdict)) return 'unstable';
  return /^(bounded|weakly unstable)/.test(verdict) ? 'beyond' : 'stable';
}

/** @param {Stability} answer @param {() => Promise<Stability>} measureBasin */
export function answerParts(answer, measureBasin) {
  const { verdict, decided_by: decider, reason, agree, model, notes } = answer;
  const kind = kindOf(verdict);
  const agreement = agree ? 'linear map and run agree' : 'linear map and run disagree';
  const note = (/** @type {string} */ words) => h('p', { class: 'muted' }, ...prose(words));
  return [
    h(
      'p',
      { class: `verdict-words ${kind}` },
      h('span', { class: 'sign', 'aria-hidden': 'true' }, SIGNS[kind]),
      ` ${capitalized(verdict ?? 'No verdict')}`,
    ),
    reason ? h('p', { class: 'reason' }, ...prose(capitalized(reason))) : '',
    h(
      'p',
      { class: 'chips' },
      decider ? h('span', { class: 'chip' }, `decided by ${DECIDERS[decider] ?? decider}`) : '',
      agree === null ? '' : h('span', { class: `chip ${agree ? '' : 'caution'}` }, agreement),
    ),
    h('dl', { class: 'numbers' }, ...entries(numbersOf(answer))),
    evidence(answer, measureBasin),
    h(
      'details',
      { class: 'model' },
      h('summary', {}, `Model: ${model.name.replaceAll('_', ' ')}`),
      note(model.reason),
      ...notes.map(note),
    ),
  ];
}
