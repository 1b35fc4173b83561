// The marks of a selection and a pointer over the charts and under the scene.

import { SANS, theme } from '../theme.js';
import { contactDistance } from '../../physics/body.js';
import { line, toX, toY } from '../axes.js';

/** @typedef {import('./impact-plot.js').ImpactPlot} ImpactPlot */
/** @typedef {import('../../run/selection.js').Selection} Selection */
/** @typedef {{x: number, y: number, words: string, possible: boolean}} Offer what a click would do, at a place in px */

/**
 * The selected ranges; where an axis has none, as wide as the plot.
 * @param {CanvasRenderingContext2D} context
 * @param {ImpactPlot} plot
 * @param {Selection} selection
 */
export function drawBrush(context, { frame, meaning }, selection) {
  const [across, up] = [meaning.x, meaning.y].map(
    ({ column }) => selection.ranges.find(([name]) => name === column)?.[1],
  );
  if (!across && !up) return;
  const { left, top, width, height } = frame;
  const within = (/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ size) =>
    Math.min(low + size, Math.max(low, value));
  const x0 = across ? within(toX(frame, across.low), left, width) : left;
  const x1 = across ? within(toX(frame, across.high), left, width) : left + width;
  const y0 = up ? within(toY(frame, up.high), top, height) : top;
  const y1 = up ? within(toY(frame, up.low), top, height) : top + height;
  const colours = theme();
  context.globalAlpha = 0.1;
  context.fillStyle = colours.accent;
  context.fillRect(x0, y0, x1 - x0, y1 - y0);
  context.globalAlpha = 1;
  context.lineWidth = 1;
  context.strokeStyle = colours.ink;
  context.strokeRect(x0, y0, x1 - x0, y1 - y0);
}

/** @param {CanvasRenderingContext2D} context @param {ImpactPlot} plot @param {Offer} offer */
export function drawOffer(context, { frame }, { x, y, words, possible }) {
  const colours = theme();
  context.lineWidth = 1.5;
  if (possible) {
    line(context, colours.ink, x - 6, y, x + 6, y);
    line(context, colours.ink, x, y - 6, x, y + 6);
  }
  context.font = `11px ${SANS}`;
  context.fillStyle = possible ? colours.ink : colours.strike;
  context.textAlign = 'right';
  context.textBaseline = 'bottom';
  context.fillText(words, frame.left + frame.width, frame.top - 6, frame.width - 44);
}

/**
 * The places of the selected contacts along the floor of the scene.
 * @param {import('../surface.js').Surface} surface
 * @param {import('../../scene/camera.js').Scale} scale
 * @param {import('../../api/scene-fields.js').Scene} scene
 * @param {import('../../run/impacts.js').Impacts} impacts
 * @param {Selection} selection
 */
export function drawContacts({ context, width }, scale, scene, impacts, selection) {
  const l = contactDistance(scene);
  const top = scale.y(0) + 2;
  const marked = new Set();
  context.beginPath();
  for (const place of selection.places) {
    const x = Math.round(scale.x(impacts.at('x', place) + (l && l * Math.sin(impacts.at('theta', place)))));
    if (!(x > 0 && x < width) || marked.has(x)) continue;
    marked.add(x);
    context.moveTo(x, top);
    context.lineTo(x + 4, top + 8);
    context.lineTo(x - 4, top + 8);
    context.closePath();
  }
  context.lineWidth = 1;
  context.fillStyle = theme().accent;
  context.fill();
  context.strokeStyle = theme().ink;
  context.stroke();
}
