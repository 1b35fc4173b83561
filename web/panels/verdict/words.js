// A verdict and the endings of runs in words for readers, from codes and data, and the range of a gain.

import { marginOf } from '../../api/answers.js';
import { number } from '../../dom/numbers.js';
import TOLD from '../../run/generated/endings.json' with { type: 'json' };
import WORDS from './words.json' with { type: 'json' };

/** Verb and reason, by ending. @type {Record<string, {verb: string, reason: string}>} */
export const ENDINGS = TOLD;

/** The verbs of the server's headlines, told of a run that is over. @type {Record<string, string>} */
const PAST = WORDS.past;

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
      /\b(?:this|the) run end(?:ed|s) as `(\w+)` at contact (\d+)/g,
      (_, kind, n) => `a fresh release ${endedAs(kind, Number(n))} (${reasonOf(kind)})`,
    )
    .replace(/\b(?:this|the) run\b/g, 'a fresh release');

/** The ends of a body in contact. @type {Record<string, {deed: string, reason: string}>} */
const FALLS = WORDS.falls;

/** The deed of a body that fell in contact, as in “stopped bouncing and fell over”, and the reason; null if it did not. @param {Outcome} outcome */
export const fallInContact = ({ contact }) => FALLS[contact?.kind ?? ''] ?? null;

/** A verdict and what it rests on. @typedef {Pick<Stability, 'verdict' | 'nonlinear' | 'chaos'>} Judgement */
/** @typedef {'stable' | 'beyond' | 'unstable'} Tone */

/** @satisfies {Record<import('contract').VerdictCode, object>} */
const VERDICTS = WORDS.verdicts;

/** The row of the words on a verdict. @param {Judgement} answer */
const rowOf = ({ verdict: { code }, chaos }) =>
  VERDICTS[code === 'elliptic' && chaos?.chaotic ? 'weakly_unstable' : code];

/** @param {Judgement} answer */
export const toneOf = (answer) => /** @type {Tone} */ (rowOf(answer).tone);

/** The verdict in a line, and its reason alone. @param {Judgement} answer @returns {{tone: Tone, words: string, reason: string}} */
export function verdictOf(answer) {
  const { verdict, nonlinear, chaos } = answer;
  const { kind, bounces } = nonlinear.outcome;
  const falls = kind !== 'completed' && verdict.code === 'unstable';
  const { word, reason: usual } = rowOf(answer);
  const reason = falls
    ? `at bounce ${number(bounces, 7)} ${reasonOf(kind)}`
    : verdict.code === 'elliptic' && chaos?.chaotic
      ? 'it keeps up, and its motion is chaotic'
      : usual;
  return { tone: toneOf(answer), words: `${word}: ${reason}`, reason };
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
