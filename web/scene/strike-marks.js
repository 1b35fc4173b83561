// The marks of a strike: its normal, its impulse and its friction.

import { disc, fontOf, line, text } from '../charts/axes.js';
import { theme } from '../charts/theme.js';
import { fixed, fixedQuantity } from '../dom/numbers.js';
import { MODES } from '../run/impacts.js';

/** @typedef {import('./camera.js').Scale} Scale */
/** @typedef {import('./bodies.js').Context} Context */
/** @typedef {import('../run/impacts.js').Impact} Impact */

// Metres of arrow for each m/s of impulse, so that an usual strike has an arrow of some 10 cm.
const ARROW_S = 0.04;
// Friction is much the smaller part.
const FRICTION_S = 0.2;
const LEAST_PX = 26;
// Over the table, on which it would not be seen.
const RAISED_PX = 8;
/** Height of a line of numbers, px. */
const LINE_PX = 16;
/** Width of a scene with no room for long lines beside the table’s stand, px. */
const NARROW_PX = 400;
/** From the numbers to the edge of the picture, and to the middle of the stand, px. */
const EDGE_PX = 10;
const STAND_PX = 32;

/**
 * Normal, impulse and its part along the table, which is friction, where rod and table met.
 * @param {Context} context
 * @param {Scale} scale
 * @param {Impact} impact
 * @param {import('../physics/table.js').Strike} strike
 * @param {number} strength from 0 to 1
 */
export function drawStrike(context, scale, impact, strike, strength) {
  const [x, y] = [scale.x(strike.x), scale.y(strike.y)];
  context.save();
  context.globalAlpha = strength;
  if (scale.measured) drawImpulse(context, scale, impact, x, y);
  disc(context, x, y, 4 + 10 * (1 - strength), { stroke: theme().strike, width: 2 });
  context.restore();
}

/** The normal, the impulse and its part along the table. @param {Context} context @param {Scale} scale @param {Impact} impact @param {number} x px @param {number} y */
function drawImpulse(context, scale, impact, x, y) {
  const { ink, good, strike } = theme();
  const [sin, cos] = [Math.sin(impact.alpha), Math.cos(impact.alpha)];
  // Farther than the rod, on which it would not be seen.
  const reach = 0.85 * y;
  context.lineWidth = 1;
  line(context, ink, x, y, x - sin * reach, y - cos * reach, [4, 4]);
  text(context, 'n', x - sin * reach + 5, y - cos * reach, { colour: ink, italic: true });
  const { dx, dy, along: impulse, friction, rubs } = impulseOf(impact);
  if (!(impulse > 0)) return;
  if (rubs) {
    // A small one still shows which way it goes; its number is beside it.
    const shown = Math.max(LEAST_PX, FRICTION_S * Math.abs(friction) * scale.metre);
    const along = Math.sign(friction) * Math.min(shown, 0.3 * scale.right);
    const [fx, fy] = [x - sin * RAISED_PX, y - cos * RAISED_PX];
    arrow(context, fx, fy, fx + cos * along, fy - sin * along, good);
  }
  const length = Math.min(ARROW_S * impulse * scale.metre, y * 0.8);
  if (length <= 9) return;
  // Beside the rod, so that the arrow is seen along its whole length, and not where friction points.
  const foot = x + ((rubs ? friction : dx) > 0 ? -16 : 16);
  const [tipX, tipY] = [foot + (dx / impulse) * length, y - (dy / impulse) * length];
  arrow(context, foot, y, tipX, tipY, strike);
  text(context, 'P', tipX + 6, tipY, { colour: strike, italic: true });
}

/**
 * The numbers of the newest strike, below the level of the table: at one end, until the stand of the table comes there.
 * @param {Context} context
 * @param {Scale} scale
 * @param {Impact} impact
 * @param {number} floor px
 * @param {number} stand its middle, px
 * @param {'left' | 'right'} end at which the numbers were last
 * @returns {'left' | 'right'}
 */
export function tellStrike(context, scale, impact, floor, stand, end) {
  const { muted, strike, good } = theme();
  const { along, friction, rubs } = impulseOf(impact);
  if (Number.isNaN(along) || !scale.measured) return end;
  const per = scale.right < NARROW_PX ? '/' : ' per ';
  /** @type {[colour: string, words: string][]} */
  const lines = [
    [muted, `bounce ${impact.n}`],
    [strike, `α ${fixedQuantity(impact.alpha, 'rad', 3)}`],
    [strike, `impulse${per}mass ${fixed(along, 2)}\u202fm/s`],
  ];
  if (rubs) lines.push([good, `friction${per}mass ${fixed(friction, 2)}\u202fm/s`]);
  context.font = fontOf({});
  const room = Math.max(...lines.map(([, words]) => context.measureText(words).width)) + EDGE_PX + STAND_PX;
  const align = end === 'right' && stand > scale.right - room ? 'left' : end === 'left' && stand < room ? 'right' : end;
  const x = align === 'right' ? scale.right - EDGE_PX : EDGE_PX;
  for (const [index, [colour, words]] of lines.entries())
    text(context, words, x, floor - 3 - (lines.length - 1 - index) * LINE_PX, { colour, align, baseline: 'bottom' });
  return align;
}

/** The impulse per mass of a strike, and its part along the table. @param {Impact} impact */
function impulseOf(impact) {
  const dx = impact.x_dot_after - impact.x_dot;
  const dy = impact.y_dot_after - impact.y_dot;
  const along = Math.hypot(dx, dy);
  const friction = dx * Math.cos(impact.alpha) + dy * Math.sin(impact.alpha);
  const rubs = MODES[impact.mode] !== 'frictionless' && Math.abs(friction) > 1e-9 * along;
  return { dx, dy, along, friction, rubs };
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
