// A verdict in words for readers, from its code and its data, and the range of a gain.

import { marginOf } from '../../api/margins.js';
import { number } from '../../dom/numbers.js';
import { reasonOf } from './plain-words.js';

/** @typedef {import('contract').Stability} Stability */
/** A verdict and what it rests on. @typedef {Pick<Stability, 'verdict' | 'nonlinear' | 'chaos'>} Judgement */
/** @typedef {'stable' | 'beyond' | 'unstable'} Tone */

/** Tone, answer and reason. @type {Record<import('contract').VerdictCode, [Tone, string, string]>} */
const WORDS = {
  stable_in_place: ['stable', 'Yes', 'it comes to bounce in place'],
  stable_drifting: ['stable', 'Yes', 'its swings die out, and it drifts aside'],
  weakly_attracting: ['stable', 'Yes', 'its swings die out slowly'],
  elliptic: ['stable', 'Yes', 'it circles upright, and neither settles nor falls'],
  bounded_beyond_boundary: ['beyond', 'On the edge', 'it swings beyond the limit, and the swings stay bounded'],
  weakly_unstable: ['beyond', 'On the edge', 'its swings grow slowly'],
  random: ['beyond', 'By chance', 'noise decides, see step 6'],
  unstable: ['unstable', 'No', 'small swings grow'],
};

/** The verdict in a line, and its reason alone. @param {Judgement} answer @returns {{tone: Tone, words: string, reason: string}} */
export function verdictOf({ verdict: { code }, nonlinear, chaos }) {
  const { kind, bounces } = nonlinear.outcome;
  const falls = kind !== 'completed' && code === 'unstable';
  const [tone, word, usual] = WORDS[code === 'elliptic' && chaos?.chaotic ? 'weakly_unstable' : code];
  const reason = falls
    ? `at bounce ${number(bounces, 7)} ${reasonOf(kind)}`
    : code === 'elliptic' && chaos?.chaotic
      ? 'it keeps up, and its motion is chaotic'
      : usual;
  return { tone, words: `${word}: ${reason}`, reason };
}

/** @typedef {{low: number | null, high: number | null}} Ends */

/** @param {number | null} one @param {number | null} other */
const larger = (one, other) => (one === null || other === null ? (one ?? other) : Math.max(one, other));
/** @param {number | null} one @param {number | null} other */
const smaller = (one, other) => (one === null || other === null ? (one ?? other) : Math.min(one, other));

/** The ends of a gain for this release, else for small deviations. @param {Stability} answer @param {import('contract').Margin['field']} field */
export function rangeOf(answer, field) {
  const small = marginOf(answer, field);
  // Of a release that falls they are no range in which it stays up.
  const survives = answer.nonlinear.outcome.kind === 'completed';
  const release = survives ? answer.margins.find((one) => one.field === field && one.of === 'release') : undefined;
  const ends = (/** @type {typeof small} */ margin) =>
    margin && { low: margin.below?.limit ?? null, high: margin.above?.limit ?? null };
  const [one, other] = [ends(small), ends(release)];
  // A release may outlast a gain at which small swings grow, for a while.
  const both = one && other ? { low: larger(one.low, other.low), high: smaller(one.high, other.high) } : (other ?? one);
  return { value: small?.value ?? release?.value ?? 0, small: one, release: other, both };
}
