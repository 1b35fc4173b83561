// A value with its interval on a track, beside a value that it is compared with.

import { h } from '../../dom/elements.js';

/** @typedef {{low: number, high: number}} Range */

/** Room at both ends of a track, as a share of it. */
const ROOM = 0.06;

/** The range of these values with room at both ends. @param {number[]} values @returns {Range} */
export function around(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const room = (high - low || Math.abs(high) || 1) * ROOM;
  return { low: low - room, high: high + room };
}

/**
 * The words say the same for those who do not see it.
 * @param {Range} range of the track
 * @param {{value: number, interval: number[] | null, beside: number | null, good?: boolean}} bar
 */
export function intervalBar({ low, high }, { value, interval, beside, good }) {
  const place = (/** @type {number} */ at) => Math.max(0, Math.min(1, (at - low) / (high - low)));
  const at = (/** @type {number} */ one) => `${(place(one) * 100).toFixed(2)}%`;
  const track = h('div', { class: 'fit-track', 'aria-hidden': 'true' });
  if (interval) {
    const bar = h('span', { class: `fit-interval ${good === false ? 'caution' : ''}` });
    bar.style.left = at(interval[0]);
    bar.style.right = `${((1 - place(interval[1])) * 100).toFixed(2)}%`;
    track.append(bar);
  }
  if (beside !== null) {
    // Beyond the track it is an arrow at its end.
    const kind = beside < low ? 'before' : beside > high ? 'beyond' : 'within';
    const mark = h('span', { class: `fit-beside ${kind}` });
    mark.style.left = at(beside);
    track.append(mark);
  }
  const mark = h('span', { class: 'fit-estimate-mark' });
  mark.style.left = at(value);
  track.append(mark);
  return track;
}
