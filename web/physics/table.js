// The table at a strike, and on its way between two strikes.

import { contactDistance } from './body.js';

/**
 * @typedef {object} Strike the table as it meets the rod
 * @property {number} t
 * @property {number} x of the contact point
 * @property {number} y of it, not 0 where the table strikes early or late
 * @property {number} alpha rad
 * @property {number} speed along the normal, m/s
 */

/**
 * The table as it met the rod at an impact.
 * @param {import('../run/impacts.js').Impact} impact
 * @param {import('../api/scene-fields.js').Scene} scene
 * @returns {Strike}
 */
export function strikeOf(impact, scene) {
  const l = contactDistance(scene);
  return {
    t: impact.t,
    x: impact.x + (l && l * Math.sin(impact.theta)),
    y: impact.clearance || 0,
    alpha: impact.alpha,
    speed: Number.isNaN(impact.table_speed) ? 0 : impact.table_speed,
  };
}

/** A vector's part along the normal of a table. @param {{x: number, y: number}} vector @param {number} alpha tilt of the table, rad */
export const alongNormal = ({ x, y }, alpha) => y * Math.cos(alpha) - x * Math.sin(alpha);

/**
 * The table at a strike that the server foresees.
 * @param {NonNullable<import('contract').LiveNextStrike>} strike
 * @returns {Strike}
 */
export const strikeToCome = ({ t, x, y, alpha, table_velocity: velocity }) => ({
  t,
  x,
  y,
  alpha,
  speed: velocity ? alongNormal(velocity, alpha) : 0,
});

/**
 * The table between two strikes. The model knows it only at a strike; the way between is the smoothest one that meets both:
 * each with its place, tilt and speed.
 * @param {Strike} from
 * @param {Strike} to
 * @param {number} t
 */
export function tableBetween(from, to, t) {
  const span = to.t - from.t;
  const u = span > 0 ? Math.min(1, Math.max(0, (t - from.t) / span)) : 1;
  const ease = u * u * (3 - 2 * u);
  return {
    x: from.x + (to.x - from.x) * ease,
    y:
      from.y +
      (to.y - from.y) * ease +
      span * (u * (1 - u) ** 2 * from.speed * Math.cos(from.alpha) - u * u * (1 - u) * to.speed * Math.cos(to.alpha)),
    alpha: from.alpha + (to.alpha - from.alpha) * ease,
  };
}
