// The drawn things of a scene: rod, table and the signs of a strike. Where they are is said by who draws them.

import { line } from '../charts/axes.js';
import { MODES } from '../run/impact-messages.js';
import { SANS, SERIF, theme } from '../charts/theme.js';
import { contactDistance, corners } from '../physics/flight.js';
import { fixed } from '../dom/numbers.js';

/** @typedef {CanvasRenderingContext2D} Context */
/** @typedef {{x: (x: number) => number, y: (y: number) => number, metre: number, right: number}} Scale metres to pixels, and where the picture ends */

/**
 * The rod from its contact point through its centre of gravity, with marks at ±ρ: two half masses there would turn like it; or the
 * outline of a polygon.
 * @param {Context} context
 * @param {Scale} scale
 * @param {import('../api/scene-fields.js').Scene} scene
 * @param {import('../physics/flight.js').Pose} pose
 */
export function drawRod(context, scale, scene, pose) {
  const colours = theme();
  const l = contactDistance(scene);
  const rho = scene.body?.radius_of_gyration ?? 0;
  context.save();
  context.translate(scale.x(pose.x), scale.y(pose.y));
  if (l === 0) {
    centre(context, 8);
    return context.restore();
  }
  // The canvas turns clockwise, θ counter-clockwise.
  context.rotate(-pose.theta);
  const bottom = l * scale.metre;
  const top = -Math.max(l, rho) * scale.metre;
  const half = Math.max(2.5, Math.min(6, 0.0075 * scale.metre));
  const polygon = corners(scene);
  context.beginPath();
  if (polygon) {
    for (const [x, y] of polygon) context.lineTo(x * scale.metre, -y * scale.metre);
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
  context.globalAlpha = 0.16;
  context.fillStyle = colours.ink;
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.strokeStyle = colours.ink;
  context.stroke();
  context.lineWidth = 1.5;
  for (const at of polygon ? [] : [-rho, rho]) {
    if (at <= l) line(context, colours.ink, -half - 3, at * scale.metre, half + 3, at * scale.metre);
  }
  context.rotate(pose.theta);
  centre(context, Math.max(6, half + 2));
  context.restore();
  const [x, y] = [scale.x(pose.x + l * Math.sin(pose.theta)), scale.y(pose.y - l * Math.cos(pose.theta))];
  context.beginPath();
  context.arc(x, y, 3, 0, 2 * Math.PI);
  context.fillStyle = colours.ink;
  context.fill();
}

/** The sign for a centre of gravity: a circle in quarters. @param {Context} context @param {number} r */
function centre(context, r) {
  const colours = theme();
  context.beginPath();
  context.arc(0, 0, r, 0, 2 * Math.PI);
  context.fillStyle = colours.surface;
  context.fill();
  context.fillStyle = colours.ink;
  for (const from of [0, Math.PI]) {
    context.beginPath();
    context.moveTo(0, 0);
    context.arc(0, 0, r, from, from + Math.PI / 2);
    context.closePath();
    context.fill();
  }
  context.lineWidth = 1.5;
  context.strokeStyle = colours.ink;
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
  context.lineWidth = 3;
  line(context, colours.line, x, y + 12, x, floor);
  context.lineWidth = 5;
  line(context, colours.line, x - 22, floor - 2, x + 22, floor - 2);
  context.save();
  context.translate(x, y);
  context.rotate(-table.alpha);
  context.fillStyle = colours.accent;
  context.beginPath();
  context.roundRect(-reach, 0, 2 * reach, 7, 2);
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

// Metres of arrow for each m/s of impulse, so that an usual strike has an arrow of some 10 cm.
const ARROW_S = 0.04;
// Friction is much the smaller part.
const FRICTION_S = 0.2;
const LEAST_PX = 26;
// Over the table, on which it would not be seen.
const RAISED_PX = 8;

/**
 * Normal, impulse and its part along the table, which is friction, where rod and table met.
 * @param {Context} context
 * @param {Scale} scale
 * @param {import('../run/impacts.js').Impact} impact
 * @param {import('../physics/flight.js').Strike} strike
 * @param {number} strength from 0 to 1
 */
export function drawStrike(context, scale, impact, strike, strength) {
  const colours = theme();
  const x = scale.x(strike.x);
  const y = scale.y(strike.y);
  const [nx, ny] = [-Math.sin(strike.alpha), -Math.cos(strike.alpha)];
  context.save();
  context.globalAlpha = strength;
  context.setLineDash([4, 4]);
  context.lineWidth = 1;
  // Farther than the rod, on which it would not be seen.
  const reach = 0.85 * y;
  line(context, colours.ink, x, y, x + nx * reach, y + ny * reach);
  context.setLineDash([]);
  context.font = `italic 12px ${SERIF}`;
  context.fillStyle = colours.ink;
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.fillText('n', x + nx * reach + 5, y + ny * reach);
  const dx = impact.x_dot_after - impact.x_dot;
  const dy = impact.y_dot_after - impact.y_dot;
  const impulse = Math.hypot(dx, dy);
  if (impulse > 0) {
    const length = Math.min(ARROW_S * impulse * scale.metre, y * 0.8);
    const friction = dx * Math.cos(strike.alpha) + dy * Math.sin(strike.alpha);
    const rubs = MODES[impact.mode] !== 'frictionless' && Math.abs(friction) > 1e-9 * impulse;
    // Beside the rod, so that the arrow is seen along its whole length, and not where friction points.
    const offset = (rubs ? friction : dx) > 0 ? -16 : 16;
    // A small one still shows which way it goes; its number is beside it.
    const along =
      Math.sign(friction) *
      Math.min(Math.max(LEAST_PX, FRICTION_S * Math.abs(friction) * scale.metre), 0.3 * scale.right);
    const [fx, fy] = [x + nx * RAISED_PX, y + ny * RAISED_PX];
    if (rubs)
      arrow(context, fx, fy, fx + Math.cos(strike.alpha) * along, fy - Math.sin(strike.alpha) * along, colours.good);
    if (length > 9)
      arrow(context, x + offset, y, x + offset + (dx / impulse) * length, y - (dy / impulse) * length, colours.strike);
    context.font = `11px ${SANS}`;
    context.fillStyle = colours.strike;
    const words = [`impulse ${fixed(impulse, 2)}\u202fm/s`, `α ${fixed(strike.alpha, 3)}\u202frad`];
    const widest = Math.max(...words.map((text) => context.measureText(text).width));
    const left = offset > 0 ? x + offset * 1.6 : x + offset * 1.6 - widest;
    const at = Math.max(34, Math.min(scale.right - widest - 6, left));
    context.textAlign = 'left';
    context.textBaseline = 'top';
    context.fillText(words[0], at, y + 20);
    context.fillText(words[1], at, y + 34);
    if (rubs) {
      // On the other side of the table's foot.
      const told = `friction ${fixed(friction, 2)}\u202fm/s`;
      const width = context.measureText(told).width;
      const start = offset > 0 ? x - offset * 1.6 - width : x - offset * 1.6;
      context.fillStyle = colours.good;
      context.fillText(told, Math.max(6, Math.min(scale.right - width - 6, start)), y + 20);
    }
  }
  context.beginPath();
  context.arc(x, y, 4 + 10 * (1 - strength), 0, 2 * Math.PI);
  context.lineWidth = 2;
  context.strokeStyle = colours.strike;
  context.stroke();
  context.restore();
}

/** @param {Context} context @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {string} colour */
function arrow(context, x0, y0, x1, y1, colour) {
  const angle = Math.atan2(y1 - y0, x1 - x0);
  context.lineWidth = 2.5;
  line(context, colour, x0, y0, x1 - Math.cos(angle) * 7, y1 - Math.sin(angle) * 7);
  context.fillStyle = colour;
  context.beginPath();
  context.moveTo(x1, y1);
  for (const side of [2.6, -2.6]) context.lineTo(x1 + 9 * Math.cos(angle + side), y1 + 9 * Math.sin(angle + side));
  context.closePath();
  context.fill();
}
