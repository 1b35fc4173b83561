// The drawn things of a scene: rod, table and the signs of a strike. Where they are is said by who draws them.

import { line } from '../charts/axes.js';
import { theme } from '../charts/theme.js';
import { contactDistance, derivedOf } from '../physics/body.js';

/** @typedef {CanvasRenderingContext2D} Context */
/** @typedef {import('./camera.js').Scale} Scale */

/** @typedef {'ink' | 'good' | 'series-1' | 'series-2' | 'series-3' | 'measured'} RodColour */

/**
 * @typedef {object} Drawn what was drawn, for parts that go with it
 * @property {import('../api/scene-fields.js').Scene} scene
 * @property {import('../physics/flight.js').Pose} pose
 * @property {{x: number, y: number, alpha: number}} table
 * @property {boolean} struck the marks of a strike are there
 * @property {number} half of the table's width, m
 * @property {Scale} scale
 * @property {number} zoom CSS px in one of the scale's
 */

/**
 * The rod from its contact point through its centre of gravity, with marks at ±ρ: two half masses there would turn like it; or the
 * outline of a polygon.
 * @param {Context} context
 * @param {Scale} scale
 * @param {import('../api/scene-fields.js').Scene} scene
 * @param {import('../physics/flight.js').Pose} pose
 * @param {{colour?: RodColour, opacity?: number}} [look]
 */
export function drawRod(context, scale, scene, pose, { colour = 'ink', opacity = 1 } = {}) {
  const colours = theme();
  const ink = colours[colour];
  const l = contactDistance(scene);
  const { radius_of_gyration: rho, outline } = derivedOf(scene);
  context.save();
  context.globalAlpha = opacity;
  context.translate(scale.x(pose.x), scale.y(pose.y));
  if (l === 0) {
    centre(context, 8, ink);
    return context.restore();
  }
  // The canvas turns clockwise, θ counter-clockwise.
  context.rotate(-pose.theta);
  const bottom = l * scale.metre;
  const top = -Math.max(l, rho ?? 0) * scale.metre;
  const half = Math.max(3, Math.min(9, 0.013 * scale.metre));
  context.beginPath();
  if (outline) {
    for (const [x, y] of outline) context.lineTo(x * scale.metre, -y * scale.metre);
  } else {
    context.moveTo(0, bottom);
    context.lineTo(half, bottom - 2.4 * half);
    context.lineTo(half, top + half);
    context.arc(0, top + half, half, 0, Math.PI, true);
    context.lineTo(-half, bottom - 2.4 * half);
  }
  context.closePath();
  context.fillStyle = colours.surface;
  context.fill();
  context.globalAlpha = (outline ? 0.16 : 1) * opacity;
  context.fillStyle = ink;
  context.fill();
  context.globalAlpha = opacity;
  context.lineWidth = 1.5;
  context.strokeStyle = ink;
  context.stroke();
  context.lineWidth = 1.5;
  for (const at of outline || rho === null || !scale.measured ? [] : [-rho, rho]) {
    if (at <= l) line(context, ink, -half - 3, at * scale.metre, half + 3, at * scale.metre);
  }
  context.rotate(pose.theta);
  centre(context, Math.max(6, half + 2), ink);
  context.restore();
  const [x, y] = [scale.x(pose.x + l * Math.sin(pose.theta)), scale.y(pose.y - l * Math.cos(pose.theta))];
  context.beginPath();
  context.arc(x, y, 3, 0, 2 * Math.PI);
  context.globalAlpha = opacity;
  context.fillStyle = ink;
  context.fill();
  context.globalAlpha = 1;
}

/** The sign for a centre of gravity: a circle in quarters. @param {Context} context @param {number} r @param {string} ink */
function centre(context, r, ink) {
  const colours = theme();
  context.beginPath();
  context.arc(0, 0, r, 0, 2 * Math.PI);
  context.fillStyle = colours.surface;
  context.fill();
  context.fillStyle = ink;
  for (const from of [0, Math.PI]) {
    context.beginPath();
    context.moveTo(0, 0);
    context.arc(0, 0, r, from, from + Math.PI / 2);
    context.closePath();
    context.fill();
  }
  context.lineWidth = 1.5;
  context.strokeStyle = ink;
  context.beginPath();
  context.arc(0, 0, r, 0, 2 * Math.PI);
  context.stroke();
}

/**
 * @param {Context} context
 * @param {Scale} scale
 * @param {{x: number, y: number, alpha: number}} table the middle of its face, and its tilt
 * @param {number} half of its width, m
 * @param {number} floor px
 */
export function drawTable(context, scale, table, half, floor) {
  const colours = theme();
  const x = scale.x(table.x);
  const y = scale.y(table.y);
  const reach = half * scale.metre;
  context.lineWidth = 8;
  context.lineCap = 'round';
  line(context, colours.line, x, y + 16, x, floor - 8);
  context.lineCap = 'butt';
  context.save();
  context.translate(x, y);
  context.rotate(-table.alpha);
  context.fillStyle = colours.accent;
  context.beginPath();
  context.roundRect(-reach, 0, 2 * reach, 10, 5);
  context.fill();
  context.restore();
  context.beginPath();
  context.arc(x, y + 13, 5, 0, 2 * Math.PI);
  context.fillStyle = colours.surface;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = colours.accent;
  context.stroke();
}
