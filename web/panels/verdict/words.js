// A verdict and the endings of runs in words for readers, from codes and data, and the range of a gain.

import { marginOf } from '../../api/answers.js';
import { number } from '../../dom/numbers.js';
import TOLD from '../../run/generated/endings.json' with { type: 'json' };

/** Verb and reason, by ending. @type {Record<string, {verb: string, reason: string}>} */
export const ENDINGS = TOLD;

/** The verbs of the server's headlines, told of a run that is over. @type {Record<string, string>} */
const PAST = {
  Falls: 'fell',
  'Comes to rest': 'stopped bouncing',
  'Cannot be followed': 'could not be followed',
  Caught: 'was caught',
  'Not caught': 'was not caught',
};

/** The reason of an ending; it goes on after “fell at bounce 11:”. @param {string} kind */
export const reasonOf = (kind) =>
  kind === 'completed' ? 'it went through all its bounces' : (ENDINGS[kind]?.reason ?? kind.replaceAll('_', ' '));

/** The ending of a run in words, as in “fell at bounce 11”. @param {string} kind @param {number} impacts */
export function endedAs(kind, impacts) {
  if (kind === 'completed') return `survived ${number(impacts, 8)} bounces`;
  const when = impacts === 0 ? 'before its first bounce' : `at bounce ${number(impacts, 8)}`;
  return `${PAST[ENDINGS[kind]?.verb] ?? 'ended'} ${when}`;
}

/** A sentence of the server on the run that a verdict rests on, which is a fresh release and never “this run”. @param {string} text */
export const plainly = (text) =>
  text
    .replace(
      /\b(?:this|the) run ended as `(\w+)` at contact (\d+)/g,
      (_, kind, n) => `a fresh release ${endedAs(kind, Number(n))} (${reasonOf(kind)})`,
    )
    .replace(/\b(?:this|the) run\b/g, 'a fresh release');

/** The end, and the reason. @type {Partial<Record<import('contract').HoldEnd['kind'], [string, string]>>} */
const FALLS = {
  toppled: ['fell over', 'it tipped over'],
  other_vertex: ['fell over', 'another corner touched the table'],
  contact_lost: ['left the table', 'only a pull could keep its foot there'],
  slipped: ['slipped', 'its foot slipped on the table'],
  beyond_limits: ['was lost', 'the contact asks more of the table than its limits allow'],
  off_table: ['left the table', 'the table ended before it'],
  too_long: ['could not be followed', 'its motion in contact is too long to compute'],
};

/** The deed of a body that fell in contact, as in “stopped bouncing and fell over”, and the reason; null if it did not. @param {Outcome} outcome */
export function fallInContact({ contact }) {
  const [deed, reason] = (contact && FALLS[contact.kind]) ?? [];
  return deed ? { deed, reason } : null;
}

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

/** The row of the words on a verdict. @param {Judgement} answer */
const rowOf = ({ verdict: { code }, chaos }) => WORDS[code === 'elliptic' && chaos?.chaotic ? 'weakly_unstable' : code];

/** @param {Judgement} answer */
export const toneOf = (answer) => rowOf(answer)[0];

/** The verdict in a line, and its reason alone. @param {Judgement} answer @returns {{tone: Tone, words: string, reason: string}} */
export function verdictOf(answer) {
  const { verdict, nonlinear, chaos } = answer;
  const { kind, bounces } = nonlinear.outcome;
  const falls = kind !== 'completed' && verdict.code === 'unstable';
  const [tone, word, usual] = rowOf(answer);
  const reason = falls
    ? `at bounce ${number(bounces, 7)} ${reasonOf(kind)}`
    : verdict.code === 'elliptic' && chaos?.chaotic
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
