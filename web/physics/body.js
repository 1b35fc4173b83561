// The shape of the body: its contact point, and the outline of a polygon.

/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/** Centre of gravity to contact point; a point mass is its own contact point. @param {Scene} scene @returns {number} */
export const contactDistance = (scene) =>
  scene.body?.contact_distance ?? Math.abs(corners(scene)?.[contactVertex(scene)][1] ?? 0);

/** The vertex that bounces: the lowest, where none is named. @param {Scene} scene @returns {number} */
function contactVertex({ body }) {
  const heights = body.vertices.map((/** @type {number[]} */ [, y]) => y);
  return body.contact_vertex ?? heights.indexOf(Math.min(...heights));
}

/**
 * The vertices of a polygon about its centre of gravity, that straight above the contact vertex; of no polygon, null.
 * @param {Scene} scene
 * @returns {[number, number][] | null}
 */
export function corners(scene) {
  /** @type {[number, number][] | undefined} */
  const vertices = scene.body?.vertices;
  if (!vertices) return null;
  const [[left, low]] = vertices;
  const places = vertices.map(([x, y]) => [x - left, y - low]);
  let area = 0;
  let [x, y] = [0, 0];
  places.forEach(([ax, ay], index) => {
    const [bx, by] = places[(index + 1) % places.length];
    const part = ax * by - ay * bx;
    area += 3 * part;
    x += part * (ax + bx);
    y += part * (ay + by);
  });
  const about = places.map(([px, py]) => [px - x / area, py - y / area]);
  const [dx, dy] = about[contactVertex(scene)] ?? [0, -1];
  const l = Math.hypot(dx, dy);
  return about.map(([px, py]) => [(dx * py - dy * px) / l, -(dx * px + dy * py) / l]);
}
