// The headline of a verdict and the field's term for it, of an answer with its evidence or of a verdict alone.

import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { endedAs } from './plain-words.js';

/** A verdict; what it rests on may be left to its words. @typedef {Pick<import('contract').Stability, 'verdict' | 'reason'> & Partial<Pick<import('contract').Stability, 'nonlinear' | 'chaos'>>} Judgement */

/** The headlines, with a sign that shows each without colour. */
const KINDS = {
  none: ['–', 'No verdict'],
  unstable: ['▲', 'Falls'],
  beyond: ['◆', 'On the edge'],
  stable: ['●', 'Keeps balance'],
};

/** @param {Judgement} answer @returns {{outcome: string, impacts: number} | null} the run that a verdict rests on, if it tells of one */
function runOf({ verdict, nonlinear }) {
  if (nonlinear) return nonlinear;
  const [, survived] = /, (\d+) bounces survived$/.exec(verdict ?? '') ?? [];
  return survived ? { outcome: 'completed', impacts: Number(survived) } : null;
}

/** @param {Judgement} answer @returns {keyof typeof KINDS} */
function kindOf(answer) {
  const { verdict, reason, chaos } = answer;
  if (verdict === null) return 'none';
  if (verdict.startsWith('unstable')) return 'unstable';
  const isChaotic = chaos === undefined ? / it is chaotic /.test(reason) : chaos?.chaotic;
  if (/^(bounded|weakly unstable|random)/.test(verdict) || (verdict.startsWith('elliptic') && isChaotic))
    return 'beyond';
  return 'stable';
}

/** The field's term for a verdict and the run that it rests on. @param {Judgement} answer */
function termOf(answer) {
  const term = answer.verdict?.split(',')[0] ?? 'not judged';
  const run = runOf(answer);
  if (!run) return term;
  return run.outcome === 'completed'
    ? `${term}; ${number(run.impacts, 8)} bounces of a fresh release survived`
    : `${term}; a fresh release ${endedAs(run.outcome, run.impacts)}`;
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
  return { kind, said: `${headline.toLowerCase()}; ${term}`, parts };
}
