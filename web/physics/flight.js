// The body on its flight between two impacts, in closed form.

import { contactDistance, derivedOf } from './body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene @typedef {import('./arc.js').Arc} Arc @typedef {import('./arc.js').Pose} Pose */

/** In the plane, m/s². @param {Scene} scene */
export const effectiveGravity = (scene) => derivedOf(scene).gravity_in_plane;

/** @type {typeof import('./air.js') | undefined} */
let air;

/**
 * The flight after an impact.
 * @param {import('../run/impacts.js').Impact} impact
 * @param {Scene} scene
 * @returns {Arc}
 */
export function arcAfter(impact, scene) {
  const still = Number.isNaN(impact.y_dot_after);
  const point = contactDistance(scene) === 0;
  return {
    t: impact.t,
    x: impact.x,
    theta: point ? 0 : impact.theta,
    y: contactDistance(scene) * Math.cos(point ? 0 : impact.theta) + (impact.clearance || 0),
    x_dot: still ? 0 : impact.x_dot_after,
    y_dot: still ? 0 : impact.y_dot_after,
    theta_dot: still || point ? 0 : impact.theta_dot_after,
    duration: still || Number.isNaN(impact.flight_time) ? 0 : impact.flight_time,
  };
}

/**
 * The pose on a flight, held at its ends.
 * @param {Arc} arc
 * @param {number} t
 * @param {Scene} scene
 * @returns {Pose}
 */
export function poseOn(arc, t, scene) {
  const s = Math.min(Math.max(0, t - arc.t), arc.duration);
  if (scene.air) {
    if (air) return air.poseInAir(arc, s, scene);
    import('./air.js').then((module) => (air = module));
  }
  return {
    x: arc.x + arc.x_dot * s,
    y: arc.y + arc.y_dot * s - (effectiveGravity(scene) * s * s) / 2,
    theta: arc.theta + arc.theta_dot * s,
  };
}
