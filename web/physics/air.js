// Flights through air that drags the body, in closed form. Loaded with the first scene that has air.

import { derivedOf } from './body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./arc.js').Arc} Arc */

/** Below this ct the first terms of a series are exact enough, and the closed form is a small difference. */
const SMALL = 1e-5;

/**
 * Share of a velocity that drag leaves after a time, way of a body that starts at 1 m/s, and of one that is pulled by 1 m/s².
 * @param {number | undefined} rate 1/s
 * @param {number} t s
 */
export function decay(rate, t) {
  const z = (rate ?? 0) * t;
  const way = z < SMALL ? t * (1 - z / 2) : (-Math.expm1(-z) / z) * t;
  return { left: Math.exp(-z), way, fall: z < SMALL ? (t * t) / 2 : ((t - way) / z) * t };
}

/**
 * Acceleration along x by which a wind takes along a body at rest, m/s².
 * @param {Scene['air']} air
 */
export const windPush = (air) => (air?.drag ?? 0) * (air?.wind ?? 0);

/**
 * The pose so many seconds after the start of a flight.
 * @param {Arc} arc
 * @param {number} s
 * @param {Scene} scene
 */
export function poseInAir(arc, s, scene) {
  const { way, fall } = decay(scene.air?.drag, s);
  return {
    x: arc.x + arc.x_dot * way + windPush(scene.air) * fall,
    y: arc.y + arc.y_dot * way - derivedOf(scene).gravity_in_plane * fall,
    theta: arc.theta + arc.theta_dot * decay(scene.air?.rotation_drag, s).way,
  };
}
