// The quantities of a scene that the server derives, for drawings: lengths, outline, gravity in the plane, target of the table.

/** Quantities of a scene that the server has not answered for. @type {Derived} */
const UNKNOWN = { gravity_in_plane: 0, contact_distance: 0, radius_of_gyration: null, outline: null, target: null };

/** @param {Scene} scene to draw @returns {Derived} */
export const derivedOf = (scene) => scene.derived ?? UNKNOWN;

/** Centre of gravity to contact point, m; 0 for a point mass. @param {Scene} scene */
export const contactDistance = (scene) => derivedOf(scene).contact_distance;

/** Height of the body above its centre of gravity, m. @param {Scene} scene */
export function reachAbove(scene) {
  const { contact_distance: l, radius_of_gyration: rho, outline } = derivedOf(scene);
  return outline ? Math.max(...outline.map(([, y]) => y)) : Math.max(l, rho ?? 0);
}

/**
 * A typed scene to draw, before the server has answered for it and after.
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

/** The usual height of a throw, in distances from contact point to centre of gravity. */
export const THROWN = 2.25;
