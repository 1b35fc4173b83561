// A typed scene with what follows from it, before and after the server has answered for it.

import { UNKNOWN } from '../physics/body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Derived} Derived */

/**
 * @param {Scene} scene
 * @param {Derived | null} derived as the server said last, maybe for a scene that was typed before this one
 * @returns {Scene}
 */
export function drawable(scene, derived) {
  const { contact_distance: l, radius_of_gyration: rho } = scene.body ?? {};
  // The lengths of a rod are fields, so they need no answer.
  const rod = l > 0 && rho > 0 ? { contact_distance: l, radius_of_gyration: rho, outline: null } : {};
  return { ...scene, derived: { ...UNKNOWN, ...derived, ...rod } };
}
