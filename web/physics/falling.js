// The body after a fall, until it lies on the ground: a picture, since the table has left it. It flies, an end touches the ground and stays
// there, and the body turns about it.

import { derivedOf } from './body.js';
import { effectiveGravity } from './flight.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene @typedef {import('./arc.js').Pose} Pose */
/** @typedef {Pose & {x_dot: number, y_dot: number, theta_dot: number}} State */

/** Step of the picture, s, and the longest fall that is drawn. */
const STEP_S = 1 / 400;
const LONGEST_S = 3;

/**
 * @param {State} from the state as it fell
 * @param {Scene} scene
 * @param {number} ground height of the ground, m
 * @param {number} t time since then, s
 * @returns {{pose: Pose, lies: boolean}}
 */
export function fallen(from, scene, ground, t) {
  const { contact_distance: l, radius_of_gyration: rho, outline } = derivedOf(scene);
  const gravity = effectiveGravity(scene);
  const above = outline ? Math.max(...outline.map(([, y]) => y)) : Math.max(l, rho ?? 0);
  let { x, y, theta, x_dot, y_dot, theta_dot } = from;
  /** From the centre of gravity to the end on the ground along the body, m; null in flight. @type {number | null} */
  let end = null;
  for (let s = 0; s < Math.min(t, LONGEST_S); s += STEP_S) {
    if (end === null) {
      y_dot -= gravity * STEP_S;
      x += x_dot * STEP_S;
      y += y_dot * STEP_S;
      theta += theta_dot * STEP_S;
      for (const one of [-l, above]) {
        if (end !== null || y + one * Math.cos(theta) > ground) continue;
        end = one;
        // About that end the angular momentum stays.
        const [rx, ry] = [one * Math.sin(theta), -one * Math.cos(theta)];
        theta_dot = ((rho ?? 0) ** 2 * theta_dot + rx * y_dot - ry * x_dot) / ((rho ?? 0) ** 2 + one ** 2 || 1);
      }
    } else {
      theta_dot += ((gravity * -end * Math.sin(theta)) / ((rho ?? 0) ** 2 + end ** 2 || 1)) * STEP_S;
      const foot = x - end * Math.sin(theta);
      theta += theta_dot * STEP_S;
      x = foot + end * Math.sin(theta);
      y = ground - end * Math.cos(theta);
      const other = end === -l ? above : -l;
      if (y + other * Math.cos(theta) <= ground) return { pose: { x, y, theta }, lies: true };
    }
  }
  return { pose: { x, y, theta }, lies: t >= LONGEST_S };
}
