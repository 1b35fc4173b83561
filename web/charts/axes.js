// Drawing on canvases: lines, discs, words; scales with round numbers, and axes.

import { number } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';
import { SANS, SERIF, theme } from './theme.js';

/** @typedef {{low: number, high: number}} Range */

/** @param {Range} range widened @param {number} value */
export function include(range, value) {
  if (value < range.low) range.low = value;
  if (value > range.high) range.high = value;
}

/** The round step (1, 2 or 5 times a power of ten) that parts a span into about so many. @param {number} span @param {number} count */
export function roundStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const multiple = raw / power;
  return power * (multiple < 1.5 ? 1 : multiple < 3.5 ? 2 : multiple < 7.5 ? 5 : 10);
}

/** @param {Range} range @param {number} count */
export function ticks({ low, high }, count) {
  const step = roundStep(high - low, count);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1)
    found.push(Number((k * step).toPrecision(12)));
  return found;
}

/**
 * The round range around what there is, with some room so that it need not grow at once.
 * @param {Range} extent
 * @param {{symmetric?: boolean, span?: number, from?: number}} [wish] least span; a low end that stays
 * @returns {Range}
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

/**
 * @typedef {object} Frame where a plot lies on its canvas, and its scales
 * @property {number} left
 * @property {number} top
 * @property {number} width
 * @property {number} height
 * @property {Range} x
 * @property {Range} y
 */

/** Around every plot: room for the numbers and the names of the axes. */
export const MARGIN = { left: 44, right: 8, top: 24, bottom: 36 };

/** @param {Frame} frame @param {number} value */
export const toX = ({ left, width, x }, value) => left + ((value - x.low) / (x.high - x.low)) * width;
/** @param {Frame} frame @param {number} value */
export const toY = ({ top, height, y }, value) => top + height - ((value - y.low) / (y.high - y.low)) * height;

/** Width of the name of an axis, px. @param {CanvasRenderingContext2D} context @param {string} name */
export function axisNameWidth(context, name) {
  context.font = fontOf({ italic: true });
  return context.measureText(shownUnit(name)).width;
}

/** Ticks that are round in the unit that is shown, and their numbers. @param {Range} range @param {number} count @param {string} name */
function shownTicks({ low, high }, count, name) {
  const [, unit = null] = /(?: \/ | \()([^()]+)\)?$/.exec(name) ?? [];
  const factor = shownFactor(unit);
  return ticks({ low: low * factor, high: high * factor }, count).map((told) => ({ told, value: told / factor }));
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Frame} frame
 * @param {string} xName with its unit, in SI
 * @param {string} yName
 */
export function drawAxes(context, frame, xName, yName) {
  const { ink, muted, line: zero, faint } = theme();
  const { left, top, width, height } = frame;
  context.lineWidth = 1;
  for (const { value, told } of shownTicks(frame.x, Math.max(2, width / 70), xName)) {
    const x = Math.round(toX(frame, value)) + 0.5;
    line(context, value === 0 ? zero : faint, x, top, x, top + height);
    const words = number(told);
    context.font = fontOf({});
    // The last one ends with the room beside the frame.
    const most = left + width + MARGIN.right - context.measureText(words).width / 2;
    text(context, words, Math.min(x, most), top + height + 5, { colour: muted, align: 'center' });
  }
  for (const { value, told } of shownTicks(frame.y, Math.max(2, height / 42), yName)) {
    const y = Math.round(toY(frame, value)) + 0.5;
    line(context, value === 0 ? zero : faint, left, y, left + width, y);
    text(context, number(told), left - 6, y, { colour: muted, align: 'right', baseline: 'middle' });
  }
  context.strokeStyle = zero;
  context.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
  const name = { colour: ink, italic: true };
  text(context, shownUnit(xName), left + width, top + height + 19, { ...name, align: 'right' });
  text(context, shownUnit(yName), Math.max(2, left - 40), top - 5, { ...name, baseline: 'bottom' });
}

/**
 * @typedef {object} TextLook
 * @property {string} colour
 * @property {number} [size] px
 * @property {boolean} [italic] as the name of a quantity
 * @property {CanvasTextAlign} [align]
 * @property {CanvasTextBaseline} [baseline]
 * @property {number} [widest] px
 */

/** @param {{size?: number, italic?: boolean}} look */
export const fontOf = ({ size = 13, italic }) => (italic ? `italic ${size}px ${SERIF}` : `${size}px ${SANS}`);

/** @param {CanvasRenderingContext2D} context @param {string} words @param {number} x @param {number} y @param {TextLook} look */
export function text(context, words, x, y, look) {
  context.font = fontOf(look);
  context.fillStyle = look.colour;
  context.textAlign = look.align ?? 'left';
  context.textBaseline = look.baseline ?? 'top';
  context.fillText(words, x, y, look.widest);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {string} colour
 * @param {number} x0
 * @param {number} y0
 * @param {number} x1
 * @param {number} y1
 * @param {number[]} [dashes]
 */
export function line(context, colour, x0, y0, x1, y1, dashes) {
  if (dashes) context.setLineDash(dashes);
  context.strokeStyle = colour;
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
  if (dashes) context.setLineDash([]);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x
 * @param {number} y
 * @param {number} r
 * @param {{fill?: string, stroke?: string, width?: number}} look
 */
export function disc(context, x, y, r, { fill, stroke, width = 1 }) {
  context.beginPath();
  context.arc(x, y, r, 0, 2 * Math.PI);
  if (fill) {
    context.fillStyle = fill;
    context.fill();
  }
  if (!stroke) return;
  context.lineWidth = width;
  context.strokeStyle = stroke;
  context.stroke();
}
