// The symbols of the paper's Fig. 1, each drawn where it belongs: l, ρ, θ, α, β and n.

import { line } from '../../charts/axes.js';
import { SERIF, theme } from '../../charts/theme.js';
import { fixedQuantity } from '../../dom/numbers.js';
import { derivedOf } from '../../physics/body.js';

/** @typedef {CanvasRenderingContext2D} Context */

/** The symbols in the order of the picture, with what they mean. @type {[string, string][]} */
export const MEANINGS = [
  ['l', 'from the centre of gravity to the contact point'],
  ['ρ', 'radius of gyration: half masses at the two marks on the rod would turn like it'],
  ['θ', 'angle of the rod from upright, positive to the left'],
  ['α', 'tilt of the table from level, positive to the left'],
  ['β', 'angle from the table’s normal to the rod, θ − α'],
  ['n', 'normal of the table, along which it strikes'],
  ['P', 'impulse of a strike, along n without friction'],
];

/** Distance of dimension lines from the rod, px. */
const ASIDE = 36;
/** An arc of fewer pixels is not seen. */
const LEAST_PX = 1;

/** The symbols and their values now, in words. @param {import('../bodies.js').Drawn} drawn */
export function spokenSymbols({ scene, pose, table }) {
  const { contact_distance: l, radius_of_gyration: rho } = derivedOf(scene);
  const alpha = `α ${fixedQuantity(table.alpha, 'rad', 3)}`;
  if (l === 0) return alpha;
  const lengths = [`l ${fixedQuantity(l, 'm', 4)}`, rho === null ? '' : `ρ ${fixedQuantity(rho, 'm', 4)}`];
  const angles = [
    `θ ${fixedQuantity(pose.theta, 'rad', 3)}`,
    alpha,
    `β ${fixedQuantity(pose.theta - table.alpha, 'rad', 3)}`,
  ];
  return [...lengths, ...angles].filter(Boolean).join(', ');
}

/** @param {Context} context @param {import('../bodies.js').Drawn} drawn */
export function drawSymbols(context, { scene, pose, table, scale, half, struck }) {
  const colours = theme();
  const { contact_distance, radius_of_gyration: rho } = derivedOf(scene);
  context.save();
  context.lineWidth = 1;
  const centre = { x: scale.x(pose.x), y: scale.y(pose.y) };
  const middle = { x: scale.x(table.x), y: scale.y(table.y) };
  const l = contact_distance * scale.metre;
  drawAlpha(context, middle, table.alpha, Math.max(24, half * scale.metre));
  // A strike has its own normal.
  if (!struck) {
    const tip = at(middle, table.alpha, Math.max(60, 2.1 * l));
    context.setLineDash([4, 4]);
    line(context, colours.muted, middle.x, middle.y, tip.x, tip.y);
    context.setLineDash([]);
    label(context, 'n', tip.x + (table.alpha > 0 ? -9 : 9), tip.y);
  }
  if (l > 0) {
    const foot = at(centre, pose.theta, -l);
    const upright = Math.max(1.5 * l, (rho ?? 0) * scale.metre + 40);
    context.setLineDash([2, 3]);
    line(context, colours.muted, centre.x, centre.y, centre.x, centre.y - upright);
    // Along the normal from the contact point, while that is not on the table.
    const normal = at(foot, table.alpha, 0.55 * l);
    line(context, colours.muted, foot.x, foot.y, normal.x, normal.y);
    context.setLineDash([]);
    const reach = Math.max(l, (rho ?? 0) * scale.metre);
    // Within the picture.
    angle(context, 'θ', centre, 0, pose.theta, Math.max(20, Math.min(reach + 14, centre.y - 22)));
    angle(context, 'β', foot, table.alpha, pose.theta, 0.5 * l);
    const side = pose.theta > 0 ? 1 : -1;
    dimension(context, 'l', centre, pose.theta, 0, -l, side);
    if (rho !== null) dimension(context, 'ρ', centre, pose.theta, 0, rho * scale.metre, side);
  }
  context.restore();
}

/**
 * The tilt between the level and the face of the table, on the side where the table is the higher one.
 * @param {Context} context
 * @param {{x: number, y: number}} middle
 * @param {number} alpha
 * @param {number} half px
 */
function drawAlpha(context, middle, alpha, half) {
  const colours = theme();
  const right = alpha >= 0 ? 1 : -1;
  context.setLineDash([2, 3]);
  line(context, colours.muted, middle.x, middle.y, middle.x + right * (half + 22), middle.y);
  context.setLineDash([]);
  if (Math.abs(alpha) * half > LEAST_PX) {
    const level = right > 0 ? 0 : Math.PI;
    context.strokeStyle = colours.ink;
    context.beginPath();
    context.arc(middle.x, middle.y, half, level, level - alpha, alpha > 0);
    context.stroke();
  }
  label(
    context,
    'α',
    middle.x + right * (half + 12) * Math.cos(alpha / 2),
    middle.y - (half + 12) * Math.abs(Math.sin(alpha / 2)) - 2,
  );
}

/** The place at a distance along a direction that is turned from upright. @param {{x: number, y: number}} from @param {number} turned rad @param {number} px */
const at = (from, turned, px) => ({ x: from.x - px * Math.sin(turned), y: from.y - px * Math.cos(turned) });

/**
 * An arc between two directions from upright, and its name.
 * @param {Context} context
 * @param {string} name
 * @param {{x: number, y: number}} about
 * @param {number} from rad
 * @param {number} to rad
 * @param {number} radius px
 */
function angle(context, name, about, from, to, radius) {
  if (Math.abs(to - from) * radius > LEAST_PX) {
    context.strokeStyle = theme().ink;
    context.beginPath();
    context.arc(about.x, about.y, radius, -Math.PI / 2 - from, -Math.PI / 2 - to, to > from);
    context.stroke();
  }
  const place = at(about, (from + to) / 2, radius + 10);
  label(context, name, place.x, place.y);
}

/**
 * A length along the rod, beside it, with its name.
 * @param {Context} context
 * @param {string} name
 * @param {{x: number, y: number}} centre
 * @param {number} theta
 * @param {number} from px along the rod
 * @param {number} to
 * @param {1 | -1} side
 */
function dimension(context, name, centre, theta, from, to, side) {
  const { ink } = theme();
  const beside = { x: centre.x + side * ASIDE * Math.cos(theta), y: centre.y - side * ASIDE * Math.sin(theta) };
  const [one, other, middle] = [from, to, (from + to) / 2].map((px) => at(beside, theta, px));
  line(context, ink, one.x, one.y, other.x, other.y);
  for (const { x, y } of [one, other]) {
    const [dx, dy] = [4 * Math.cos(theta), -4 * Math.sin(theta)];
    line(context, ink, x - dx, y - dy, x + dx, y + dy);
  }
  label(context, name, middle.x + side * 11 * Math.cos(theta), middle.y - side * 11 * Math.sin(theta));
}

/** A name on a ground that hides the lines behind it. @param {Context} context @param {string} name @param {number} x @param {number} y its middle */
function label(context, name, x, y) {
  const { ink, surface } = theme();
  context.globalAlpha = 0.75;
  context.fillStyle = surface;
  context.fillRect(x - 6, y - 8, 12, 16);
  context.globalAlpha = 1;
  context.font = `italic 15px ${SERIF}`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillStyle = ink;
  context.fillText(name, x, y);
}
