// The marks of a strike: its normal, its impulse and its friction.

import { MODES } from '../run/impact-messages.js';
import { line } from '../charts/axes.js';
import { SANS, SERIF, theme } from '../charts/theme.js';
import { fixed, fixedQuantity } from '../dom/numbers.js';

/** @typedef {import('./camera.js').Scale} Scale */

/** @typedef {import('./bodies.js').Context} Context */

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
 * @param {import('../run/impacts.js').Impact} impact
 * @param {import('../physics/table.js').Strike} strike
 * @param {number} strength from 0 to 1
 */
export function drawStrike(context, scale, impact, strike, strength) {
  const colours = theme();
  const x = scale.x(strike.x);
  const y = scale.y(strike.y);
  const [nx, ny] = [-Math.sin(strike.alpha), -Math.cos(strike.alpha)];
  context.save();
  context.globalAlpha = strength;
  if (scale.measured) drawImpulse(context, scale, impact, strike, { x, y, nx, ny });
  context.beginPath();
  context.arc(x, y, 4 + 10 * (1 - strength), 0, 2 * Math.PI);
  context.lineWidth = 2;
  context.strokeStyle = colours.strike;
  context.stroke();
  context.restore();
}

/** The normal, the impulse and its part along the table. @param {Context} context @param {Scale} scale @param {import('../run/impacts.js').Impact} impact @param {import('../physics/table.js').Strike} strike @param {{x: number, y: number, nx: number, ny: number}} at px, with the normal of the table */
function drawImpulse(context, scale, impact, strike, { x, y, nx, ny }) {
  const colours = theme();
  context.setLineDash([4, 4]);
  context.lineWidth = 1;
  // Farther than the rod, on which it would not be seen.
  const reach = 0.85 * y;
  line(context, colours.ink, x, y, x + nx * reach, y + ny * reach);
  context.setLineDash([]);
  context.font = `italic 13px ${SERIF}`;
  context.fillStyle = colours.ink;
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.fillText('n', x + nx * reach + 5, y + ny * reach);
  const { dx, dy, along: impulse, friction, rubs } = impulseOf(impact);
  if (impulse > 0) {
    const length = Math.min(ARROW_S * impulse * scale.metre, y * 0.8);
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
    context.font = `italic 13px ${SERIF}`;
    context.fillStyle = colours.strike;
    if (length > 9) context.fillText('P', x + offset + (dx / impulse) * length + 6, y - (dy / impulse) * length);
  }
}

/**
 * The numbers of the newest strike, below the level of the table: at one end, until the stand of the table comes there.
 * @param {Context} context
 * @param {Scale} scale
 * @param {import('../run/impacts.js').Impact} impact
 * @param {number} floor px
 * @param {number} stand its middle, px
 * @param {'left' | 'right'} end at which the numbers were last
 * @returns {'left' | 'right'}
 */
export function tellStrike(context, scale, impact, floor, stand, end) {
  const colours = theme();
  const { along, friction, rubs } = impulseOf(impact);
  if (Number.isNaN(along) || !scale.measured) return end;
  context.font = `13px ${SANS}`;
  context.textBaseline = 'bottom';
  const narrow = scale.right < NARROW_PX;
  /** @param {string} name @param {number} value @param {string} colour */
  const perMass = (name, value, colour) => [colour, `${name}${narrow ? '/' : ' per '}mass ${fixed(value, 2)}\u202fm/s`];
  const words = [
    [colours.muted, `bounce ${impact.n}`],
    [colours.strike, `α ${fixedQuantity(impact.alpha, 'rad', 3)}`],
    perMass('impulse', along, colours.strike),
    ...(rubs ? [perMass('friction', friction, colours.good)] : []),
  ];
  const room = Math.max(...words.map(([, text]) => context.measureText(text).width)) + EDGE_PX + STAND_PX;
  const at = end === 'right' && stand > scale.right - room ? 'left' : end === 'left' && stand < room ? 'right' : end;
  context.textAlign = at;
  words.forEach(([colour, text], index) => {
    context.fillStyle = colour;
    const x = at === 'right' ? scale.right - EDGE_PX : EDGE_PX;
    context.fillText(text, x, floor - 3 - (words.length - 1 - index) * LINE_PX);
  });
  return at;
}

/** The impulse per mass of a strike, and its part along the table. @param {import('../run/impacts.js').Impact} impact */
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
