// The table at a strike, on its way between two strikes, and while it holds the body.

import { alongNormal } from '../run/impacts.js';
import { contactDistance } from './body.js';

/** @typedef {import('contract').HoldSamples} Columns */
/** @typedef {{pose: import('./flight.js').Pose, table: {x: number, y: number, alpha: number}}} Held */

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
  const [rising, risen] = [from, to].map(({ speed, alpha }) => span * speed * Math.cos(alpha));
  return {
    x: cubic(from.x, to.x, 0, 0, u),
    y: cubic(from.y, to.y, rising, risen, u),
    alpha: cubic(from.alpha, to.alpha, 0, 0, u),
  };
}

/** The cubic through two ends with their slopes, at a share of the way. @param {number} a @param {number} b @param {number} slopeA @param {number} slopeB @param {number} u */
const cubic = (a, b, slopeA, slopeB, u) =>
  a + (b - a) * u * u * (3 - 2 * u) + u * (1 - u) * ((1 - u) * slopeA - u * slopeB);

/** Most moments of one run that are kept: the first ones go when there are more. */
const MOST_MOMENTS = 20_000;

const NAMES = /** @type {const} */ (['t', 'x', 'theta', 'x_dot', 'theta_dot', 'alpha', 'table_y']);

/** A hold: its moments, column by column. @typedef {Record<typeof NAMES[number], number[]>} Hold */

export class Holds {
  /** @type {Hold[]} */
  #holds = [];
  #moments = 0;

  /** Adds a message; its first moment is the last one of the message before. @param {Columns} columns */
  append(columns) {
    const last = this.#holds.at(-1);
    const known = last?.t.at(-1) ?? -Infinity;
    const begin = columns.t[0];
    // A client that comes back gets moments again.
    const first = columns.t.findIndex((t) => t > known);
    if (first < 0) return;
    const hold = last && begin <= known ? last : this.#begin();
    for (const name of NAMES) hold[name].push(...columns[name].slice(first));
    this.#moments += columns.t.length - first;
    while (this.#moments > MOST_MOMENTS && this.#holds.length > 1) this.#moments -= this.#holds.shift()?.t.length ?? 0;
  }

  #begin() {
    const hold = /** @type {Hold} */ (Object.fromEntries(NAMES.map((name) => [name, /** @type {number[]} */ ([])])));
    this.#holds.push(hold);
    return hold;
  }

  /** The last time that is known, s; -Infinity before the first hold. */
  get until() {
    return this.#holds.at(-1)?.t.at(-1) ?? -Infinity;
  }

  /**
   * Body and table at `t`; null while the body flies.
   * @param {number} t
   * @param {number} struck time of the last impact up to then
   * @param {import('../api/scene-fields.js').Scene} scene
   * @returns {Held | null}
   */
  at(t, struck, scene) {
    const hold = this.#holds.findLast((one) => one.t[0] <= t);
    // A strike after its beginning has thrown the body.
    if (!hold || struck > hold.t[0] + 1e-9) return null;
    let low = 0;
    let high = hold.t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (hold.t[middle] <= t) low = middle;
      else high = middle;
    }
    const span = hold.t[high] - hold.t[low];
    const u = span > 0 ? Math.min(1, Math.max(0, (t - hold.t[low]) / span)) : 1;
    const between = (/** @type {number[]} */ values) => values[low] + (values[high] - values[low]) * u;
    const smooth = (/** @type {number[]} */ values, /** @type {number[]} */ rates) =>
      cubic(values[low], values[high], rates[low] * span, rates[high] * span, u);
    const theta = smooth(hold.theta, hold.theta_dot);
    const x = smooth(hold.x, hold.x_dot);
    const y = between(hold.table_y);
    const l = contactDistance(scene);
    return {
      pose: { x, y: y + l * Math.cos(theta), theta },
      table: { x: x + l * Math.sin(theta), y, alpha: between(hold.alpha) },
    };
  }
}
