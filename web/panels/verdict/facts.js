// The errors of a rig in words of things, and the facts beside the verdict: the gains that this release allows, and the errors that would end it,
// the worst first.

import { number } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { angles } from '../../dom/units.js';
import THINGS from './things.json' with { type: 'json' };
import { rangeOf, reasonOf } from './words.js';

/** @import { BudgetError } from 'contract' */
/** @typedef {NonNullable<Stability['budget']>} Budget */
/** @typedef {NonNullable<BudgetError['below']>} Limit */

/** The gains of a state feedback, each with its letter and unit. */
export const GAINS = /** @type {const} */ ([
  ['x', 'x', 'rad/m'],
  ['theta', 'θ', '1'],
  ['x_dot', 'ẋ', 'rad·s/m'],
  ['theta_dot', 'θ̇', 's'],
]);

/** Digits of a limit. */
const DIGITS = 3;

/** A limit in some digits, rounded into its range. @param {number} value @param {'low' | 'high'} end */
function inside(value, end) {
  const step = 10 ** (Math.floor(Math.log10(Math.abs(value) || 1)) - DIGITS + 1);
  const rounded = (end === 'low' ? Math.ceil(value / step - 1e-9) : Math.floor(value / step + 1e-9)) * step;
  return number(Number(rounded.toPrecision(DIGITS + 1)), DIGITS);
}

/** A range in words; null without an end. @param {{low: number | null, high: number | null}} ends */
export function rangeWords({ low, high }) {
  if (low !== null && high !== null) return `${inside(low, 'low')} to ${inside(high, 'high')}`;
  if (high !== null) return `up to ${inside(high, 'high')}`;
  return low === null ? null : `${inside(low, 'low')} or more`;
}

/** A range of a factor as shares of it. @param {import('./words.js').Ends} ends */
function shareWords({ low, high }) {
  const share = (/** @type {number} */ factor) => `${number(Math.floor(100 * Math.abs(factor - 1)), 3)}\u202f%`;
  const words = [low !== null && `${share(low)} lower`, high !== null && `${share(high)} higher`];
  return words.filter((one) => one !== false).join(' to ') || null;
}

/** The range of the gain, or of all gains of a feedback as a factor, for this release where it is known. @param {Stability} answer */
export function gainFact(answer) {
  const isGain = answer.margins.some(({ field }) => field === 'table.tilt_gain');
  const { small, release, both } = rangeOf(answer, isGain ? 'table.tilt_gain' : 'table.feedback');
  const falls = answer.verdict.code === 'unstable';
  const shown = falls ? small : both;
  const words = shown && (isGain ? rangeWords(shown) : shareWords(shown));
  if (!words) return null;
  if (falls) return `Small swings last ${isGain ? 'for κ' : 'with all gains'} ${words}`;
  return `${isGain ? 'κ' : 'All gains'} may be ${words} ${release ? 'here' : 'for small swings'}`;
}

/** Losses beyond a limit that no run tells. @type {Partial<Record<Limit['decided_by'], string>>} */
const LOST = {
  linear: 'small swings grow',
  boundary: 'the edge of stability is passed',
  lyapunov: 'swings grow slowly',
  fixed_point: 'no bounce repeats any more',
  refused: 'there is no such rig',
};

/** @typedef {NonNullable<ReturnType<typeof lineOf>>} Line */

/** An error of a rig against its nearer limit; null for one that nothing is lost by. @param {BudgetError} error @param {Record<string, number>} have */
function lineOf(error, have) {
  const { field, unit, value, reference, below, above } = error;
  const thing = thingOf(field);
  const sides = [below, above].flatMap((limit, side) =>
    limit && limit.decided_by !== 'range' ? [{ limit, side: side === 0 ? thing.low : thing.high }] : [],
  );
  if (sides.length === 0) return null;
  const { limit, side } = sides.reduce((near, one) => (one.limit.value < near.limit.value ? one : near));
  const present = Math.abs(value - reference);
  const has = have[field] ?? (present || thing.usual);
  const told = field in have;
  const ratio = has === 0 ? Infinity : limit.value / has;
  const isNone = limit.value === 0;
  const size = isNone
    ? (thing.any ?? `any error of ${thing.what}`)
    : [sizeWords(field, limit.value, unit), side].filter(Boolean).join(' ');
  return {
    error,
    thing,
    /** Size at which the verdict is lost. */
    limit: limit.value,
    /** The same in words with its side. */
    size,
    /** The sentence on it, as in “Angle sensor reads 3 mrad too much”. */
    says: capitalized(isNone ? size : `${thing.says} ${size}`),
    /** Consequence of an error beyond the limit. */
    lost: LOST[limit.decided_by] ?? reasonOf(limit.outcome?.kind ?? ''),
    /** Size of the error in this rig. */
    has,
    /** The owner of the rig has given that size. */
    told,
    /** It is in the scene. */
    own: !told && present > 0,
    /** It is one of the two, not only usual in a lab. */
    known: told || present > 0,
    ratio,
    /** The owner is to act. */
    short: ratio < 1,
  };
}

/** The lines of a budget, the worst first: those known to end this rig, then those that would at the size that is usual. @param {Budget} budget @param {Record<string, number>} [have] sizes that the owner has told, by field */
export function linesOf({ errors }, have = {}) {
  const isFirst = (/** @type {Line} */ { short, known }) => Number(short && known);
  return (errors ?? [])
    .flatMap((error) => lineOf(error, have) ?? [])
    .sort((one, other) => isFirst(other) - isFirst(one) || one.ratio - other.ratio);
}

/** The error that ends the balance first; null where none does. @param {Budget} budget */
export function firstLoss(budget) {
  const [first] = linesOf(budget);
  if (!first) return null;
  const { says, limit } = first;
  return limit === 0 ? `${says} ends it` : `Ends when the ${says[0].toLowerCase()}${says.slice(1)}`;
}

/**
 * An error of a rig: the usual size in a lab, in SI units; what is mended; the sentence that the size goes on with, and its rest below and
 * above; the sentence where no size at all is allowed.
 * @typedef {{usual: number, what: string, says: string, low?: string, high?: string, any?: string}} Thing
 */
/** By field. @type {Record<string, Thing>} */
const ALL = THINGS;
/** Fields whose errors a rig may have. */
export const ERRORS = Object.keys(THINGS);

/** The thing that a field is about; for one without words its path. @param {string} field @returns {Thing} */
export const thingOf = (field) => ALL[field] ?? { usual: 0.01, what: field, says: `${field} is off by` };

/** Units in which sizes are typed, with their values in SI. @type {Record<string, [string, number]>} */
const TYPED = {
  m: ['mm', 1e-3],
  s: ['ms', 1e-3],
  rad: ['mrad', 1e-3],
  'm/s': ['mm/s', 1e-3],
  'rad/s': ['mrad/s', 1e-3],
  1: ['%', 0.01],
};
const DEGREE = Math.PI / 180;

/** The unit in which the size of an error is typed, and its value in SI. @param {string} field @param {string} unit in SI @returns {[string, number]} */
export function typedUnit(field, unit) {
  // Friction is a coefficient, no share.
  if (field === 'contact.friction') return ['', 1];
  if (angles() === 'deg' && /^rad/.test(unit)) return [unit.replace('rad', '°'), DEGREE];
  return TYPED[unit] ?? [unit, 1];
}

/** A size in the unit that gives it no leading zeros. @param {string} field @param {number} size in SI units @param {string} unit */
export function sizeWords(field, size, unit) {
  const [typed, value] = typedUnit(field, unit);
  const shown = size / value;
  if (/^m[a-z]/.test(typed) && shown !== 0 && shown < 0.1)
    return `${number(shown * 1e3, 3)}\u202f${typed.replace('m', 'µ')}`;
  if (/^m[a-z]/.test(typed) && shown >= 1000) return `${number(shown / 1e3, 3)}\u202f${typed.slice(1)}`;
  return `${number(shown, 3)}${typed === '' ? '' : /^°/.test(typed) ? typed : `\u202f${typed}`}`;
}
