// The part of the world that the scene shows: its height, its middle and the pixels of a metre.

import { contactDistance, derivedOf } from '../physics/body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {{x: (x: number) => number, y: (y: number) => number, metre: number, right: number, measured: boolean}} Scale metres to pixels, the right end of the picture, and whether measures are drawn */

/** Height of the ruler below the scene, px. */
const RULER = 22;
/** Height shown while no scene is typed, m. */
const NO_SCENE_M = 0.3;

export class Camera {
  /** True where rulers, symbols and numbers of strikes are drawn. */
  measured = true;
  /** The place in the middle, m. */
  x = 0;
  #top = 0;
  #surface;

  /** @param {import('../charts/surface.js').Surface} surface */
  constructor(surface) {
    this.#surface = surface;
  }

  /** Forgets the height of the scene before. */
  forget() {
    this.#top = 0;
  }

  /** Makes room for the highest point of the body on a flight; the height never shrinks in a run. @param {Scene} scene @param {number} apex */
  contain(scene, apex) {
    const { contact_distance: l, radius_of_gyration: rho, outline, target } = derivedOf(scene);
    const reach = outline ? Math.max(...outline.map(([x, y]) => Math.hypot(x, y))) : (rho ?? 0);
    const above = l > 0 ? Math.max(l, reach) : 0.03;
    const wanted = (Math.max(apex, target?.height ?? 0) + above) * 1.08;
    if (wanted > this.#top && Number.isFinite(wanted)) this.#top = wanted;
  }

  /**
   * Lets the body wander through the middle third and then goes with it.
   * @param {number} x
   * @param {number | null} since_s time since the last picture; null for a jump
   */
  follow(x, since_s) {
    const free = this.#surface.width / this.scale.metre / 6;
    const excess = x - this.x - Math.max(-free, Math.min(free, x - this.x));
    this.x += since_s !== null && Math.abs(excess) < free * 6 ? excess * Math.min(1, since_s * 6) : excess;
  }

  /** The height that fills the picture, m. */
  get shown() {
    return this.#top > 0 ? this.#top : NO_SCENE_M;
  }

  /** The lower end of the picture above the ruler, px. */
  get floor() {
    return this.#surface.height - (this.measured ? RULER : 0);
  }

  /** @returns {Scale} */
  get scale() {
    const { width } = this.#surface;
    const { floor, measured } = this;
    // Below the height of the contacts there is room for a tilted table and its foot.
    const depth = Math.min(Math.max(58, floor * 0.2), floor * 0.3);
    const metre = Math.max(1e-9, (floor - depth - 6) / this.shown);
    return {
      x: (x) => width / 2 + (x - this.x) * metre,
      y: (y) => floor - depth - y * metre,
      metre,
      right: width,
      measured,
    };
  }

  /** Half the table's width, m. @param {Scene} scene */
  halfTable(scene) {
    return Math.min(0.7 * (contactDistance(scene) || 0.12), (this.#surface.width * 0.3) / this.scale.metre);
  }
}
