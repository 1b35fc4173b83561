// The release that leads to a wanted first impact, in closed form.

import { contactDistance } from './body.js';
import { effectiveGravity } from './flight.js';
import { number, quantity } from '../dom/numbers.js';

/** Fields to release with, and a remark on it; or why nothing does. @typedef {{values: Record<string, number> | null, words: string}} Start */

/** Contact points closer to the table than this touch it, m. */
const TOUCHING_M = 1e-9;
/** Steps to search a flight for an earlier contact: more than any that comes down at more than a graze. */
const STEPS = 2000;

/** The reason why no start is derived for a scene; null where there is none. @param {Scene} scene */
function lacking(scene) {
  if (scene.air?.drag || scene.air?.rotation_drag) return 'with drag the release for a bounce is not derived';
  return effectiveGravity(scene) > 0 ? null : 'the server has not answered for this scene yet';
}

/** @param {string} words @returns {Start} */
const refused = (words) => ({ values: null, words });

/**
 * The first impact at an angle with an angular velocity: only the release's own angle and spin are moved, and its height gives the time
 * T to the contact at y = l cos θ, so that θ₀ = θ − θ̇T. In flight the centre of gravity falls freely and the spin stays.
 * @param {Scene} scene
 * @param {number} theta
 * @param {number} theta_dot
 * @returns {Start}
 */
export function angleStart(scene, theta, theta_dot) {
  const lacks = scene.body?.point ? 'a point mass has no spin' : lacking(scene);
  if (lacks) return refused(lacks);
  const { height = 0, y_dot = 0 } = scene.release ?? {};
  const gravity = effectiveGravity(scene);
  const square = y_dot ** 2 + 2 * gravity * (height - contactDistance(scene) * Math.cos(theta));
  const T = (y_dot + Math.sqrt(square)) / gravity;
  if (!(T > 0)) return refused(`out of reach: released at ${number(height)}\u202fm`);
  return reached(scene, T, { theta: theta - theta_dot * T, theta_dot });
}

/**
 * The first impact with these velocities of the centre of gravity: ẋ is that of the release, and ẏ = ẏ₀ − GT gives T, hence the angle
 * at the contact and the height y₀ = l cos θ + (ẏ² − ẏ₀²)/(2G).
 * @param {Scene} scene
 * @param {number} x_dot
 * @param {number} y_dot
 * @returns {Start}
 */
export function velocityStart(scene, x_dot, y_dot) {
  const lacks = lacking(scene);
  if (lacks) return refused(lacks);
  const { y_dot: risen = 0, theta = 0, theta_dot = 0 } = scene.release ?? {};
  const gravity = effectiveGravity(scene);
  const T = (risen - y_dot) / gravity;
  if (!(T > 0)) return refused(`out of reach: needs ẏ < ${number(risen)}`);
  const height = contactDistance(scene) * Math.cos(theta + theta_dot * T) + (y_dot ** 2 - risen ** 2) / (2 * gravity);
  return reached(scene, T, { x_dot, height });
}

/** The start, if the contact point comes down to the table after T and not before. @param {Scene} scene @param {number} T s @param {Record<string, number>} release its values */
function reached(scene, T, release) {
  const gravity = effectiveGravity(scene);
  const l = contactDistance(scene);
  const { height = 0, y_dot = 0, theta = 0, theta_dot = 0 } = { ...scene.release, ...release };
  const h = (/** @type {number} */ t) =>
    height + y_dot * t - (gravity * t * t) / 2 - l * Math.cos(theta + theta_dot * t);
  if (h(0) < 0) return refused('out of reach: it would start below the table');
  if (y_dot - gravity * T + l * theta_dot * Math.sin(theta + theta_dot * T) >= 0)
    return refused('out of reach: the contact point would rise');
  // It falls no faster than this, so that no step of h over it passes a contact.
  const fastest = Math.abs(y_dot) + gravity * T + l * Math.abs(theta_dot);
  let t = h(0) < TOUCHING_M ? T * 1e-6 : 0;
  for (let step = 0; step < STEPS && h(t) >= TOUCHING_M; step += 1) t += h(t) / fastest;
  if (T - t > T * 1e-3) return refused('out of reach: it would strike before');
  const values = Object.fromEntries(Object.entries(release).map(([name, value]) => [`release.${name}`, value]));
  return { values, words: scene.noise?.timing_sd > 0 ? ', noise aside' : '' };
}

/** The start in words, unless it lies beyond what the server takes. @param {Start} start @param {Field[]} fields @returns {Start} */
export function within({ values, words }, fields) {
  if (values === null) return refused(words);
  const told = [];
  for (const [path, value] of Object.entries(values)) {
    const field = fields.find((one) => one.field === path);
    if (!field) continue;
    const { symbol, unit, minimum, maximum } = field;
    told.push(`${symbol} ${quantity(value, unit)}`);
    if (value < (minimum ?? -Infinity) || value > (maximum ?? Infinity))
      return refused(`out of range: ${told.at(-1)}, limit ${quantity(value > 0 ? maximum : minimum, unit)}`);
  }
  return { values, words: told.join(', ') + words };
}
