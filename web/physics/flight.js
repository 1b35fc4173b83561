// The body on its flight between two impacts, in closed form.

import { contactDistance, derivedOf } from './body.js';

/** Below this ct the first terms of a series are exact enough, and the closed form is a small difference. */
const SMALL = 1e-5;

/** In the plane, m/s². @param {Scene} scene */
export const effectiveGravity = (scene) => derivedOf(scene).gravity_in_plane;

/** The flight from the release of a scene. @param {Scene} scene @param {number} duration s @returns {Arc} */
export function arcFrom({ release = {} }, duration) {
  const { x = 0, height: y = 0, x_dot = 0, y_dot = 0, theta, theta_dot } = release;
  // A point mass has no angle.
  return { t: 0, x, y, theta: theta ?? 0, x_dot, y_dot, theta_dot: theta_dot ?? 0, duration };
}

/** The flight after an impact. @param {Impact} impact @param {Scene} scene @returns {Arc} */
export function arcAfter(impact, scene) {
  const still = Number.isNaN(impact.y_dot_after);
  const l = contactDistance(scene);
  const theta = l === 0 ? 0 : impact.theta;
  return {
    t: impact.t,
    x: impact.x,
    theta,
    y: l * Math.cos(theta) + (impact.clearance || 0),
    x_dot: still ? 0 : impact.x_dot_after,
    y_dot: still ? 0 : impact.y_dot_after,
    theta_dot: still || l === 0 ? 0 : impact.theta_dot_after,
    duration: still || Number.isNaN(impact.flight_time) ? 0 : impact.flight_time,
  };
}

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

/** Acceleration along x by which a wind takes along a body at rest, m/s². @param {Scene['air']} air */
export const windPush = (air) => (air?.drag ?? 0) * (air?.wind ?? 0);

/** The pose on a flight, held at its ends. @param {Arc} arc @param {number} t @param {Scene} scene @returns {Pose} */
export function poseOn(arc, t, scene) {
  const s = Math.min(Math.max(0, t - arc.t), arc.duration);
  const { way, fall } = decay(scene.air?.drag, s);
  return {
    x: arc.x + arc.x_dot * way + windPush(scene.air) * fall,
    y: arc.y + arc.y_dot * way - effectiveGravity(scene) * fall,
    theta: arc.theta + arc.theta_dot * decay(scene.air?.rotation_drag, s).way,
  };
}
