// The table at a strike, on its way between two strikes, and while it holds the body.

import { alongNormal, lastUpTo } from '../run/impacts.js';
import { contactDistance } from './body.js';

/** @typedef {{pose: Pose, table: {x: number, y: number, alpha: number}}} Held */

/** The table as it met the rod at an impact. @param {Impact} impact @param {Scene} scene @returns {Strike} */
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

/** The table at a strike that the server foresees. @param {NonNullable<NextStrike>} strike @returns {Strike} */
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
  const u = shareOf(from.t, to.t, t);
  const [rising, risen] = [from, to].map(({ speed, alpha }) => span * speed * Math.cos(alpha));
  return {
    x: cubic(from.x, to.x, 0, 0, u),
    y: cubic(from.y, to.y, rising, risen, u),
    alpha: cubic(from.alpha, to.alpha, 0, 0, u),
  };
}

/** The share of a time on the way between two; 1 where they are the same. @param {number} from @param {number} to @param {number} t */
const shareOf = (from, to, t) => (to > from ? Math.min(1, Math.max(0, (t - from) / (to - from))) : 1);

/** The cubic through two ends with their slopes, at a share of the way. @param {number} a @param {number} b @param {number} slopeA @param {number} slopeB @param {number} u */
const cubic = (a, b, slopeA, slopeB, u) =>
  a + (b - a) * u * u * (3 - 2 * u) + u * (1 - u) * ((1 - u) * slopeA - u * slopeB);

/** Most moments of one run that are kept: the first holds go when there are more. */
const MOST_MOMENTS = 20_000;

const NAMES = /** @type {const} */ (['t', 'x', 'theta', 'x_dot', 'theta_dot', 'alpha', 'table_y']);

/** A moment of a hold. @typedef {Record<typeof NAMES[number], number>} Moment */

/** The times in which the table holds the body. */
export class Holds {
  /** @type {Moment[][]} */
  #holds = [];

  /** Adds a message; its first moment is the last one of the message before. @param {import('contract').HoldSamples} columns */
  append(columns) {
    const known = this.until;
    // A client that comes back gets moments again.
    const fresh = columns.t
      .map((_, row) => /** @type {Moment} */ (Object.fromEntries(NAMES.map((name) => [name, columns[name][row]]))))
      .filter(({ t }) => t > known);
    if (fresh.length === 0) return;
    if (columns.t[0] > known) this.#holds.push([]);
    this.#holds.at(-1)?.push(...fresh);
    while (this.#holds.length > 1 && this.#holds.flat().length > MOST_MOMENTS) this.#holds.shift();
  }

  /** The last time that is known, s; -Infinity before the first hold. */
  get until() {
    return this.#holds.at(-1)?.at(-1)?.t ?? -Infinity;
  }

  /** Body and table at `t`; null while the body flies. @param {number} t @param {number} struck time of the last impact up to then @param {Scene} scene @returns {Held | null} */
  at(t, struck, scene) {
    const hold = this.#holds.findLast(([first]) => first.t <= t);
    // A strike after its beginning has thrown the body.
    if (!hold || struck > hold[0].t + 1e-9) return null;
    const at = lastUpTo((place) => hold[place].t, t, 0, hold.length - 1);
    const [from, to] = [hold[at], hold[at + 1] ?? hold[at]];
    const span = to.t - from.t;
    const u = shareOf(from.t, to.t, t);
    const theta = cubic(from.theta, to.theta, from.theta_dot * span, to.theta_dot * span, u);
    const x = cubic(from.x, to.x, from.x_dot * span, to.x_dot * span, u);
    const [y, alpha] = /** @type {const} */ (['table_y', 'alpha']).map(
      (name) => from[name] + (to[name] - from[name]) * u,
    );
    const l = contactDistance(scene);
    return {
      pose: { x, y: y + l * Math.cos(theta), theta },
      table: { x: x + l * Math.sin(theta), y, alpha },
    };
  }
}
