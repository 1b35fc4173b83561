// Scales with round numbers, and axes.

import { number, roundStep, ticks } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';

/** @param {Interval} range widened @param {number} value */
export function include(range, value) {
  if (value < range.low) range.low = value;
  if (value > range.high) range.high = value;
}

/**
 * The round range around what there is, with some room so that it need not grow at once.
 * @param {Interval} extent
 * @param {{symmetric?: boolean, span?: number, from?: number}} [wish] least span; a low end that stays
 * @returns {Interval}
 */
export function roundRange({ low, high }, { symmetric = false, span = 0, from } = {}) {
  if (from !== undefined) {
    const need = Math.max(high - from, span) * 1.25;
    const step = roundStep(need, 8);
    return { low: from, high: from + Math.ceil(need / step) * step };
  }
  if (symmetric) {
    high = Math.max(Math.abs(low), Math.abs(high), span / 2);
    low = -high;
  }
  const lack = Math.max(0, span - (high - low)) / 2;
  const room = (high - low + 2 * lack || 1) * 0.06;
  const step = roundStep(high - low + 2 * lack + 2 * room, 8);
  return { low: Math.floor((low - lack - room) / step) * step, high: Math.ceil((high + lack + room) / step) * step };
}

/** Around every plot: room for the numbers and the names of the axes. */
export const MARGIN = { left: 44, right: 8, top: 24, bottom: 36 };

/** @param {Frame} frame @param {number} value */
export const toX = ({ left, width, x }, value) => left + ((value - x.low) / (x.high - x.low)) * width;
/** @param {Frame} frame @param {number} value */
export const toY = ({ top, height, y }, value) => top + height - ((value - y.low) / (y.high - y.low)) * height;

/** Ticks that are round in the unit that is shown, and their numbers. @param {Interval} range @param {number} count @param {string} name */
function shownTicks({ low, high }, count, name) {
  const [, unit = null] = /(?: \/ | \()([^()]+)\)?$/.exec(name) ?? [];
  const factor = shownFactor(unit);
  return ticks({ low: low * factor, high: high * factor }, count).map((told) => ({ told, value: told / factor }));
}

/** @param {Surface} surface @param {Frame} frame @param {string} xName with its unit, in SI @param {string} yName */
export function drawAxes(surface, frame, xName, yName) {
  const { left, top, width, height } = frame;
  const [right, bottom] = [left + width, top + height];
  /** @type {(value: number) => Colour} */
  const shade = (value) => (value === 0 ? 'line' : 'faint');
  for (const { value, told } of shownTicks(frame.x, Math.max(2, width / 70), xName)) {
    const x = Math.round(toX(frame, value)) + 0.5;
    surface.line(shade(value), x, top, x, bottom);
    const words = number(told);
    // The last one ends with the room beside the frame.
    const most = right + MARGIN.right - surface.widthOf(words) / 2;
    surface.text(words, Math.min(x, most), bottom + 5, { colour: 'muted', align: 'center' });
  }
  for (const { value, told } of shownTicks(frame.y, Math.max(2, height / 42), yName)) {
    const y = Math.round(toY(frame, value)) + 0.5;
    surface.line(shade(value), left, y, right, y);
    surface.text(number(told), left - 6, y, { colour: 'muted', align: 'right', baseline: 'middle' });
  }
  surface.context.beginPath();
  surface.context.rect(left + 0.5, top + 0.5, width - 1, height - 1);
  surface.stroke('line');
  surface.text(shownUnit(xName), right, bottom + 19, { colour: 'ink', italic: true, align: 'right' });
  surface.text(shownUnit(yName), Math.max(2, left - 40), top - 5, { colour: 'ink', italic: true, baseline: 'bottom' });
}
