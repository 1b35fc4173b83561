// The table at the next strike, and on its way between two strikes.

import { effectiveGravity, poseOn } from './flight.js';
import { contactDistance } from './body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./flight.js').Arc} Arc */

/**
 * @typedef {object} Strike the table as it meets the rod
 * @property {number} t
 * @property {number} x of the contact point
 * @property {number} y of it, not 0 where the table strikes early or late
 * @property {number} alpha rad
 * @property {number} speed along the normal, m/s
 */

/**
 * The tilt the table will have when it meets this state: α = κθ, or −K·state with feedback.
 * @param {Scene} scene
 * @param {{x: number, theta: number, x_dot: number, y_dot: number, theta_dot: number}} state
 * @returns {number}
 */
function tilt(scene, state) {
  const { tilt_gain = 0, feedback } = scene.table ?? {};
  if (feedback) {
    return -(
      (feedback.x ?? 0) * state.x +
      (feedback.theta ?? 0) * state.theta +
      (feedback.x_dot ?? 0) * state.x_dot +
      (feedback.theta_dot ?? 0) * state.theta_dot
    );
  }
  const angle = contactDistance(scene) === 0 ? Math.atan2(state.x_dot, -state.y_dot) : state.theta;
  return tilt_gain * angle;
}

/**
 * The strike at the end of a flight, before the server has told of it.
 * @param {Arc} arc
 * @param {Scene} scene
 * @returns {Strike}
 */
export function strikeAfter(arc, scene) {
  const gravity = effectiveGravity(scene);
  const end = poseOn(arc, arc.t + arc.duration, scene);
  const state = {
    x: end.x,
    theta: end.theta,
    x_dot: arc.x_dot,
    y_dot: arc.y_dot - gravity * arc.duration,
    theta_dot: arc.theta_dot,
  };
  const alpha = tilt(scene, state);
  const l = contactDistance(scene);
  let speed = 0;
  if (scene.table?.strike !== 'still') {
    // The table makes up the loss, and a little more or less for the wanted height: eq. (25), (28).
    const e = scene.table?.assumed_restitution ?? scene.contact?.restitution ?? 1;
    const normal =
      -Math.sin(alpha) * state.x_dot +
      Math.cos(alpha) * state.y_dot +
      l * state.theta_dot * Math.sin(end.theta - alpha);
    const lack =
      (scene.table?.energy_gain ?? 0) *
      (gravity * (scene.table?.target_height ?? 0) - gravity * l * Math.cos(end.theta) - state.y_dot ** 2 / 2);
    speed = -((1 - e) / (1 + e) + lack) * normal;
  }
  return {
    t: arc.t + arc.duration,
    x: end.x + l * Math.sin(end.theta),
    y: end.y - l * Math.cos(end.theta),
    alpha,
    speed,
  };
}

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
