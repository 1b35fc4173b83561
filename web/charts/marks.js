// The marks of impacts: their shapes and colours.

import { disc } from './axes.js';
import { presenting, theme } from './theme.js';

/** Corners of the marks but the first, a circle, for a radius of 1. */
const CORNERS = [[], [-1, -1, 1, -1, 1, 1, -1, 1], [0, -1.4, 1.4, 0, 0, 1.4, -1.4, 0], [0, -1.3, 1.3, 1, -1.3, 1]];

/**
 * A filled mark. Colour and shape of an impact tell which parameters it was played with, so that neither is needed alone.
 * @param {CanvasRenderingContext2D} context
 * @param {number} series
 * @param {number} x
 * @param {number} y
 * @param {number} r
 * @param {string} fill
 */
export function drawMark(context, series, x, y, r, fill) {
  const corners = CORNERS[series % 4];
  if (corners.length === 0) return disc(context, x, y, r, { fill });
  context.beginPath();
  for (let k = 0; k < corners.length; k += 2) context.lineTo(x + corners[k] * r, y + corners[k + 1] * r);
  context.closePath();
  context.fillStyle = fill;
  context.fill();
}

/** @param {number} series */
export const seriesColour = (series) => theme()[/** @type {'series-0'} */ (`series-${series % 4}`)];

/** @typedef {'plain' | 'selected' | 'receded'} Look */

/** @param {Look} look @param {boolean} many a dot among so many that it must be small */
export const dotRadius = (look, many) =>
  ({ plain: 1.8, selected: 3, receded: 1.3 })[look] * (many ? 0.6 : 1) * (presenting() ? 1.67 : 1);

/**
 * The dot of an impact: whether it is selected is told by size and ring as well as by colour.
 * @param {CanvasRenderingContext2D} context
 * @param {number} series
 * @param {number} x
 * @param {number} y
 * @param {Look} look
 * @param {boolean} many
 */
export function drawDot(context, series, x, y, look, many) {
  context.globalAlpha = look === 'receded' ? 0.4 : 1;
  drawMark(context, series, x, y, dotRadius(look, many), seriesColour(series));
  context.globalAlpha = 1;
  // Rings that overlap would hide what they surround.
  if (look !== 'selected' || many) return;
  context.lineWidth = 1.25;
  context.strokeStyle = theme().ink;
  context.stroke();
}
