// Where rod and table are between two impacts, in closed form. Not the physics of an impact beyond what the next strike looks like.

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
 *
 * @typedef {object} Strike the table as it meets the rod
 * @property {number} t
 * @property {number} x of the contact point
 * @property {number} y of it, not 0 where the table strikes early or late
 * @property {number} alpha rad
 * @property {number} speed along the normal, m/s
 */

/** @param {Scene} scene */
export const effectiveGravity = (scene) => (scene.gravity ?? 9.81) * Math.sin(scene.incline ?? Math.PI / 2);

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
  return {
    x: arc.x + arc.x_dot * s,
    y: arc.y + arc.y_dot * s - (effectiveGravity(scene) * s * s) / 2,
    theta: arc.theta + arc.theta_dot * s,
  };
}

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
