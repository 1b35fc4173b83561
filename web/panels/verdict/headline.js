// The headline of a verdict and the field's term for it.

import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { endedAs } from './plain-words.js';

/** A verdict and what it rests on. @typedef {Pick<import('contract').Stability, 'verdict' | 'nonlinear' | 'chaos'>} Judgement */

/** The headlines, with a sign that shows each without colour. */
const KINDS = {
  unstable: ['▲', 'Falls'],
  beyond: ['◆', 'On the edge'],
  stable: ['●', 'Stays up'],
};

/** Verdicts that may not last. */
const BEYOND = ['bounded_beyond_boundary', 'weakly_unstable', 'random'];

/** @param {Judgement} answer @returns {keyof typeof KINDS} */
function kindOf({ verdict: { code }, chaos }) {
  if (code === 'unstable') return 'unstable';
  return BEYOND.includes(code) || (code === 'elliptic' && chaos?.chaotic) ? 'beyond' : 'stable';
}

/** The field's term for a verdict and the run that it rests on. @param {Judgement} answer */
function termOf({ verdict, nonlinear: { outcome } }) {
  const term = verdict.code.replaceAll('_', ' ');
  return outcome.kind === 'completed'
    ? `${term}; ${number(outcome.bounces, 8)} bounces of a fresh release survived`
    : `${term}; a fresh release ${endedAs(outcome.kind, outcome.bounces)}`;
}

/** The headline with its sign over the term, both as elements, and the words of both. @param {Judgement} answer */
export function headlineOf(answer) {
  const kind = kindOf(answer);
  const [sign, headline] = KINDS[kind];
  const term = termOf(answer);
  const parts = [
    h('p', { class: 'headline' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, sign), ` ${headline}`),
    h('p', { class: 'verdict-term' }, ...prose(capitalized(term))),
  ];
  return { kind, sign, headline, said: `${headline.toLowerCase()}; ${term}`, parts };
}
