// The facts beside the verdict: the gains that this release allows, and the error of the rig that would end it first.

import { number } from '../../dom/numbers.js';
import { sizeWords, thingOf } from './things.js';
import { rangeOf } from './words.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {NonNullable<Stability['budget']>} Budget */

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

/** The error that ends the balance first, on the scale of a usual rig; null where none does. @param {Budget} budget */
export function firstLoss({ errors }) {
  const losses = (errors ?? []).flatMap(({ field, unit, below, above }) =>
    /** @type {const} */ ([below, above]).flatMap((limit, side) =>
      limit && limit.decided_by !== 'range'
        ? [{ thing: thingOf(field), field, unit, side, value: limit.value, ratio: limit.value / thingOf(field).usual }]
        : [],
    ),
  );
  const [first] = losses.sort((one, other) => one.ratio - other.ratio);
  if (!first) return null;
  const { thing, field, unit, side, value } = first;
  if (value === 0 && thing.any) return `${thing.any[0].toUpperCase()}${thing.any.slice(1)} ends it`;
  const rest = thing.sides ? ` ${thing.sides[side]}` : '';
  return `Ends when the ${thing.says} ${sizeWords(field, value, unit)}${rest}`;
}
