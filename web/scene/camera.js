// The part of the world that the scene shows, with its grid, its rulers and its marks of height.

import { line, roundStep, text } from '../charts/axes.js';
import { theme } from '../charts/theme.js';
import { number } from '../dom/numbers.js';
import { contactDistance, derivedOf } from '../physics/body.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../charts/surface.js').Surface} Surface */
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

  /** @param {Surface} surface */
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
   * Lets the body wander through the middle third, and the table up to the edges, and then goes with them.
   * @param {number} x of the body
   * @param {{x: number, half: number}} table its middle and half its width
   * @param {number | null} since_s time since the last picture; null for a jump
   */
  follow(x, { x: table, half }, since_s) {
    const free = this.#surface.width / this.scale.metre / 6;
    const edge = Math.max(0, 3 * free - half);
    const within = (/** @type {number} */ value, /** @type {number} */ middle, /** @type {number} */ room) =>
      Math.max(middle - room, Math.min(middle + room, value));
    const excess = within(within(this.x, x, free), table, 0.8 * edge) - this.x;
    this.x += since_s !== null && Math.abs(excess) < free * 6 ? excess * Math.min(1, since_s * 6) : excess;
    this.x = within(this.x, table, edge);
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

/** An empty picture with its grid. @param {Surface} surface @param {Camera} camera */
export function drawGrid({ context, width, height }, camera) {
  const colours = theme();
  context.clearRect(0, 0, width, height);
  const { scale, floor } = camera;
  context.lineWidth = 1;
  if (!camera.measured) return line(context, colours.line, 0, scale.y(0), width, scale.y(0));
  const step = roundStep(width / scale.metre, 8);
  const first = Math.ceil((camera.x - width / 2 / scale.metre) / step);
  for (let k = first; scale.x(k * step) < width; k += 1) {
    const x = Math.round(scale.x(k * step)) + 0.5;
    line(context, colours.faint, x, 0, x, floor);
  }
  const rung = roundStep(camera.shown, 4);
  for (let k = 0; scale.y(k * rung) > 0; k += 1) {
    const y = Math.round(scale.y(k * rung)) + 0.5;
    line(context, k === 0 ? colours.line : colours.faint, 0, y, width, y);
  }
}

/** The rulers lie over everything: x moves with the ground, y is the height of the centre of gravity. @param {Surface} surface @param {Camera} camera */
export function drawRulers({ context, width, height }, camera) {
  if (!camera.measured) return;
  const { surface, line: rule, muted } = theme();
  const { scale, floor } = camera;
  context.fillStyle = surface;
  context.fillRect(0, floor, width, height - floor);
  context.lineWidth = 1;
  line(context, rule, 0, floor + 0.5, width, floor + 0.5);
  const step = roundStep(width / scale.metre, Math.max(3, width / 90));
  for (let k = Math.ceil((camera.x - width / 2 / scale.metre) / step); scale.x(k * step) < width; k += 1) {
    const x = Math.round(scale.x(k * step)) + 0.5;
    if (x < 56 || x > width - 16) continue;
    line(context, muted, x, floor, x, floor + 4);
    text(context, number(k * step), x, floor + 7, { colour: muted, align: 'center' });
  }
  text(context, 'x / m', 6, floor + 7, { colour: muted });
  const rung = roundStep(camera.shown, 4);
  for (let k = 0; scale.y(k * rung) > 14; k += 1)
    text(context, k === 0 ? '0\u202fm' : number(k * rung), 6, scale.y(k * rung) - 2, {
      colour: muted,
      baseline: 'bottom',
    });
  drawScaleBar(context, width, scale.metre);
}

/** @param {CanvasRenderingContext2D} context @param {number} width @param {number} metre px */
function drawScaleBar(context, width, metre) {
  const { ink } = theme();
  const length = roundStep(100 / metre, 1);
  const right = width - 14;
  const left = right - length * metre;
  context.lineWidth = 2;
  line(context, ink, left, 20, right, 20);
  line(context, ink, left, 16, left, 24);
  line(context, ink, right, 16, right, 24);
  const words = length < 0.1 ? `${number(length * 100)}\u202fcm` : `${number(length)}\u202fm`;
  text(context, words, (left + right) / 2, 26, { colour: ink, align: 'center' });
}

/** The gravity of the plane, and the height that the table steers for. @param {Surface} surface @param {Camera} camera @param {Scene} scene */
export function drawTarget({ context, width }, { scale, measured }, scene) {
  const { muted, good } = theme();
  const { gravity_in_plane: gravity, target } = derivedOf(scene);
  if (gravity === 0) return;
  const { incline } = scene;
  const plane = incline && gravity < scene.gravity ? `plane at ${number((incline * 180) / Math.PI)}°, ` : '';
  if (measured)
    text(context, `${plane}G = ${number(gravity)}\u202fm/s²`, width - 14, 46, { colour: muted, align: 'right' });
  if (!target) return;
  const y = Math.round(scale.y(target.height)) + 0.5;
  context.lineWidth = 1;
  line(context, good, 0, y, width, y, [5, 4]);
  text(context, `target y* = ${number(target.height)}\u202fm`, width - 8, y - 2, {
    colour: good,
    align: 'right',
    baseline: 'bottom',
  });
}
