// The grid, the rulers and the marks of height around a scene.

import { line, roundStep } from '../charts/axes.js';
import { SANS, theme } from '../charts/theme.js';
import { number } from '../dom/numbers.js';
import { derivedOf } from '../physics/body.js';

/** @typedef {import('../charts/surface.js').Surface} Surface */
/** @typedef {import('./camera.js').Camera} Camera */

/** An empty picture with its grid. @param {Surface} surface @param {Camera} camera */
export function drawGrid({ context, width, height }, camera) {
  const colours = theme();
  context.clearRect(0, 0, width, height);
  const { scale, floor } = camera;
  context.lineWidth = 1;
  if (!camera.measured) return line(context, colours.line, 0, scale.y(0), width, scale.y(0));
  const step = roundStep(width / scale.metre, 8);
  const first = Math.ceil((camera.x - width / 2 / scale.metre) / step);
  for (let k = first; scale.x(k * step) < width; k += 1) {
    const x = Math.round(scale.x(k * step)) + 0.5;
    line(context, colours.faint, x, 0, x, floor);
  }
  const rung = roundStep(camera.shown, 4);
  for (let k = 0; scale.y(k * rung) > 0; k += 1) {
    const y = Math.round(scale.y(k * rung)) + 0.5;
    line(context, k === 0 ? colours.line : colours.faint, 0, y, width, y);
  }
}

/** The rulers lie over everything: x moves with the ground, y is the height of the centre of gravity. @param {Surface} surface @param {Camera} camera */
export function drawRulers({ context, width, height }, camera) {
  if (!camera.measured) return;
  const colours = theme();
  const { scale, floor } = camera;
  context.fillStyle = colours.surface;
  context.fillRect(0, floor, width, height - floor);
  context.lineWidth = 1;
  line(context, colours.line, 0, floor + 0.5, width, floor + 0.5);
  context.font = `13px ${SANS}`;
  context.fillStyle = colours.muted;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  const step = roundStep(width / scale.metre, Math.max(3, width / 90));
  for (let k = Math.ceil((camera.x - width / 2 / scale.metre) / step); scale.x(k * step) < width; k += 1) {
    const x = Math.round(scale.x(k * step)) + 0.5;
    if (x < 56 || x > width - 16) continue;
    line(context, colours.muted, x, floor, x, floor + 4);
    context.fillText(number(k * step), x, floor + 7);
  }
  context.textAlign = 'left';
  context.fillText('x / m', 6, floor + 7);
  context.textBaseline = 'bottom';
  const rung = roundStep(camera.shown, 4);
  for (let k = 0; scale.y(k * rung) > 14; k += 1) {
    context.fillText(k === 0 ? '0\u202fm' : number(k * rung), 6, scale.y(k * rung) - 2);
  }
  drawScaleBar(context, width, scale.metre);
}

/** @param {CanvasRenderingContext2D} context @param {number} width @param {number} metre px */
function drawScaleBar(context, width, metre) {
  const { ink } = theme();
  const length = roundStep(100 / metre, 1);
  const right = width - 14;
  const left = right - length * metre;
  context.lineWidth = 2;
  line(context, ink, left, 20, right, 20);
  line(context, ink, left, 16, left, 24);
  line(context, ink, right, 16, right, 24);
  context.font = `13px ${SANS}`;
  context.fillStyle = ink;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  const words = length < 0.1 ? `${number(length * 100)}\u202fcm` : `${number(length)}\u202fm`;
  context.fillText(words, (left + right) / 2, 26);
}

/** The gravity of the plane, and the height that the table steers for. @param {Surface} surface @param {Camera} camera @param {import('../api/scene-fields.js').Scene} scene */
export function drawTarget({ context, width }, { scale, measured }, scene) {
  const colours = theme();
  const { gravity_in_plane: gravity, target } = derivedOf(scene);
  if (gravity === 0) return;
  context.font = `13px ${SANS}`;
  context.textAlign = 'right';
  context.textBaseline = 'top';
  context.fillStyle = colours.muted;
  const { incline } = scene;
  const plane = incline && gravity < scene.gravity ? `plane at ${number((incline * 180) / Math.PI)}°, ` : '';
  if (measured) context.fillText(`${plane}G = ${number(gravity)}\u202fm/s²`, width - 14, 46);
  if (!target) return;
  const y = Math.round(scale.y(target.height)) + 0.5;
  context.setLineDash([5, 4]);
  context.lineWidth = 1;
  line(context, colours.good, 0, y, width, y);
  context.setLineDash([]);
  context.fillStyle = colours.good;
  context.textAlign = 'right';
  context.textBaseline = 'bottom';
  context.fillText(`target y* = ${number(target.height)}\u202fm`, width - 8, y - 2);
}
