// The marks of impacts: their shapes and colours.

import { presenting, theme } from './theme.js';

/**
 * One impact: its colour and shape tell which parameters it was played with, so that neither is needed alone.
 * @param {CanvasRenderingContext2D} context
 * @param {number} series
 * @param {number} x
 * @param {number} y
 * @param {number} r
 */
export function drawMark(context, series, x, y, r) {
  context.beginPath();
  if (series % 4 === 0) context.arc(x, y, r, 0, 2 * Math.PI);
  else if (series % 4 === 1) context.rect(x - r, y - r, 2 * r, 2 * r);
  else if (series % 4 === 2) {
    context.moveTo(x, y - r * 1.4);
    context.lineTo(x + r * 1.4, y);
    context.lineTo(x, y + r * 1.4);
    context.lineTo(x - r * 1.4, y);
    context.closePath();
  } else {
    context.moveTo(x, y - r * 1.3);
    context.lineTo(x + r * 1.3, y + r);
    context.lineTo(x - r * 1.3, y + r);
    context.closePath();
  }
}

/** @param {number} series */
export const seriesColour = (series) => theme()[/** @type {'series-0'} */ (`series-${series % 4}`)];

/** @typedef {'plain' | 'selected' | 'receded'} Look */

/**
 * The dot of an impact: whether it is selected is told by size and ring as well as by colour.
 * @param {CanvasRenderingContext2D} context
 * @param {number} series
 * @param {number} x
 * @param {number} y
 * @param {Look} look
 * @param {boolean} many a dot among so many that it must be small
 */
export function drawDot(context, series, x, y, look, many) {
  const size = (many ? 0.6 : 1) * (presenting() ? 1.67 : 1);
  drawMark(context, series, x, y, size * { plain: 1.8, selected: 3, receded: 1.3 }[look]);
  context.fillStyle = seriesColour(series);
  context.globalAlpha = look === 'receded' ? 0.4 : 1;
  context.fill();
  context.globalAlpha = 1;
  // Rings that overlap would hide what they surround.
  if (look !== 'selected' || many) return;
  context.lineWidth = 1.25;
  context.strokeStyle = theme().ink;
  context.stroke();
}
