// The body on its flight between two impacts, in closed form.

import { contactDistance, derivedOf } from './body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/**
 * @typedef {object} Pose
 * @property {number} x of the centre of gravity, m
 * @property {number} y
 * @property {number} theta rad
 *
 * @typedef {object} Arc the flight that starts at `t`
 * @property {number} t
 * @property {number} x
 * @property {number} y
 * @property {number} theta
 * @property {number} x_dot
 * @property {number} y_dot
 * @property {number} theta_dot
 * @property {number} duration s; 0 when there is no flight
 */

/** Gravity in the plane, m/s². @param {Scene} scene */
export const effectiveGravity = (scene) => derivedOf(scene).gravity;

/**
 * Share of a velocity that drag leaves after a time, way at 1 m/s, and fall at 1 m/s².
 * @param {number | undefined} rate 1/s
 * @param {number} t s
 */
export function decay(rate, t) {
  const z = (rate ?? 0) * t;
  const way = z < 1e-5 ? t * (1 - z / 2) : (-Math.expm1(-z) / z) * t;
  return { left: Math.exp(-z), way, fall: z < 1e-5 ? (t * t) / 2 : ((t - way) / z) * t };
}

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
  const { way, fall } = decay(scene.air?.drag, s);
  return {
    x: arc.x + arc.x_dot * way,
    y: arc.y + arc.y_dot * way - effectiveGravity(scene) * fall,
    theta: arc.theta + arc.theta_dot * decay(scene.air?.rotation_drag, s).way,
  };
}
