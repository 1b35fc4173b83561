// The world of a scene on its canvas: the part that is shown, with its grid, its rulers and its marks of height; rods, table and flights in it.

import { CanvasView } from '../charts/surface.js';
import { number, roundStep, ticks } from '../dom/numbers.js';
import { contactDistance, derivedOf } from '../physics/body.js';
import { poseOn } from '../physics/flight.js';

/** The rod of another run. @typedef {{run: RunState, colour: Colour}} OtherRod */

/**
 * Drawings around the body and its table.
 * @typedef {object} Around
 * @property {Colour} [ink] of the body
 * @property {(stage: Stage) => void} [under] the table
 * @property {(stage: Stage) => void} [beside] between table and body
 * @property {(stage: Stage) => boolean} [over] the body; true where that is a strike
 */

/** Height of the ruler below the scene, px. */
const RULER = 22;
/** Least width with room for the gravity beside the body, px. */
const WIDE = 400;
/** Height shown while no scene is typed, m. */
const NO_SCENE_M = 0.3;

/** A view of the world: the part of it that is shown, and what stands in it. */
export class World extends CanvasView {
  /** True where rulers, symbols and numbers of strikes are drawn. */
  measured = true;
  /** The place in the middle, m. */
  x = 0;
  #top = 0;
  /** Draws marks on the floor. @type {((stage: Stage, scene: Scene) => void) | null} */
  under = null;
  /** The tilt of a table in somebody's hand, rad. @type {number | null} */
  tilt = null;
  /** The rods of other runs on this stage. @type {OtherRod[]} */
  others = [];
  /** Parts that go with the drawn body; some draw over it. @type {((drawn: Drawn) => void)[]} */
  followers = [];

  get #surface() {
    return this.layers[0];
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
    const free = this.#surface.width / this.stage.metre / 6;
    const edge = Math.max(0, 3 * free - half);
    const within = (/** @type {number} */ value, /** @type {number} */ middle, /** @type {number} */ room) =>
      Math.max(middle - room, Math.min(middle + room, value));
    const excess = within(within(this.x, x, free), table, 0.8 * edge) - this.x;
    this.x += since_s !== null && Math.abs(excess) < free * 6 ? excess * Math.min(1, since_s * 6) : excess;
    this.x = within(this.x, table, edge);
  }

  /** The height that fills the picture, m. */
  get #shown() {
    return this.#top > 0 ? this.#top : NO_SCENE_M;
  }

  /** @returns {Stage} */
  get stage() {
    const surface = this.#surface;
    const { measured } = this;
    const floor = surface.height - (measured ? RULER : 0);
    // Below the height of the contacts there is room for a tilted table and its foot.
    const ground = floor - Math.min(Math.max(58, floor * 0.2), floor * 0.3);
    const metre = Math.max(1e-9, (ground - 6) / this.#shown);
    const [middle, at] = [surface.width / 2, this.x];
    return { surface, x: (x) => middle + (x - at) * metre, y: (y) => ground - y * metre, metre, floor, measured };
  }

  /** Half the table's width, m. @param {Scene} scene */
  halfTable(scene) {
    return Math.min(0.7 * (contactDistance(scene) || 0.12), (this.#surface.width * 0.3) / this.stage.metre);
  }

  /** Round places across the picture, m and px. @param {number} count @returns {[number, number][]} */
  #columns(count) {
    const { surface, x, metre } = this.stage;
    const half = surface.width / 2 / metre;
    return ticks({ low: this.x - half, high: this.x + half }, count).map((at) => [at, Math.round(x(at)) + 0.5]);
  }

  /** Round heights from the contacts up, m and px. @returns {[number, number][]} */
  get #rows() {
    const { y } = this.stage;
    return ticks({ low: 0, high: this.#shown }, 4).map((at) => [at, Math.round(y(at)) + 0.5]);
  }

  /** An empty picture with its grid. */
  drawGrid() {
    const { surface, y, floor, measured } = this.stage;
    surface.clear();
    if (!measured) return surface.line('line', 0, y(0), surface.width, y(0));
    for (const [, x] of this.#columns(8)) surface.line('faint', x, 0, x, floor);
    for (const [height, row] of this.#rows) surface.line(height === 0 ? 'line' : 'faint', 0, row, surface.width, row);
  }

  /** The rulers lie over everything: x moves with the ground, y is the height of the centre of gravity. */
  #drawRulers() {
    const { surface, floor, metre, measured } = this.stage;
    if (!measured) return;
    const { context, width, height } = surface;
    context.beginPath();
    context.rect(0, floor, width, height - floor);
    surface.fill('surface');
    surface.line('line', 0, floor + 0.5, width, floor + 0.5);
    for (const [place, x] of this.#columns(Math.max(3, width / 90))) {
      if (x < 56 || x > width - 16) continue;
      surface.line('muted', x, floor, x, floor + 4);
      surface.text(number(place), x, floor + 7, { colour: 'muted', align: 'center' });
    }
    surface.text('x / m', 6, floor + 7, { colour: 'muted' });
    for (const [at, row] of this.#rows)
      if (row > 14)
        surface.text(at === 0 ? '0\u202fm' : number(at), 6, row - 2.5, { colour: 'muted', baseline: 'bottom' });
    // A bar of a round length.
    const length = roundStep(100 / metre, 1);
    const right = width - 14;
    const left = right - length * metre;
    surface.line('ink', left, 20, right, 20, { width: 2 });
    for (const end of [left, right]) surface.line('ink', end, 16, end, 24, { width: 2 });
    const words = length < 0.1 ? `${number(length * 100)}\u202fcm` : `${number(length)}\u202fm`;
    surface.text(words, (left + right) / 2, 26, { colour: 'ink', align: 'center' });
  }

  /** The gravity of the plane, and the height that the table steers for. @param {Scene} scene */
  #drawTarget(scene) {
    const { surface, y, measured } = this.stage;
    const { gravity_in_plane: gravity, target } = derivedOf(scene);
    if (gravity === 0) return;
    const right = surface.width - 8;
    const { incline } = scene;
    const plane = incline && gravity < scene.gravity ? `plane at ${number((incline * 180) / Math.PI)}°, ` : '';
    // Beside a body in a narrow picture it would lie over the symbols.
    if (measured && surface.width >= WIDE)
      surface.text(`${plane}G = ${number(gravity)}\u202fm/s²`, right - 6, 46, { colour: 'muted', align: 'right' });
    if (!target) return;
    const row = Math.round(y(target.height)) + 0.5;
    surface.line('good', 0, row, surface.width, row, { dashes: [5, 4] });
    const words = `target y* = ${number(target.height)}\u202fm`;
    surface.text(words, right, row - 2, { colour: 'good', align: 'right', baseline: 'bottom' });
  }

  /** @param {Scene} scene @param {Pose} pose @param {TablePose} table @param {Around} around */
  paint(scene, pose, table, { ink, under, beside, over }) {
    const { stage } = this;
    const half = this.halfTable(scene);
    this.drawGrid();
    this.#drawTarget(scene);
    under?.(stage);
    drawTable(stage, table, half);
    beside?.(stage);
    drawRod(stage, scene, pose, ink);
    const struck = over?.(stage) ?? false;
    for (const follow of this.followers) follow({ stage, scene, pose, table, half, struck });
    this.#drawRulers();
  }
}

/** Opacity of the rods of other runs. */
const OPACITY = 0.6;
/** Flights of a typed scene that are drawn, and points along any flight. */
const FLIGHTS = 6;
const POINTS = 24;

/**
 * The rod from its contact point through its centre of gravity, with marks at ±ρ: two half masses there would turn like it; or the
 * outline of a polygon.
 * @param {Stage} stage @param {Scene} scene @param {Pose} pose @param {Colour} [ink]
 */
function drawRod({ surface, x: across, y: up, metre, measured }, scene, pose, ink = 'ink') {
  const { context } = surface;
  const l = contactDistance(scene);
  const { radius_of_gyration: rho, outline } = derivedOf(scene);
  context.save();
  context.translate(across(pose.x), up(pose.y));
  if (l > 0) {
    // The canvas turns clockwise, θ counter-clockwise.
    context.rotate(-pose.theta);
    const bottom = l * metre;
    const top = -Math.max(l, rho ?? 0) * metre;
    const half = Math.max(3, Math.min(9, 0.013 * metre));
    context.beginPath();
    if (outline) {
      for (const [x, y] of outline) context.lineTo(x * metre, -y * metre);
    } else {
      context.moveTo(0, bottom);
      context.lineTo(half, bottom - 2.4 * half);
      context.lineTo(half, top + half);
      context.arc(0, top + half, half, 0, Math.PI, true);
      context.lineTo(-half, bottom - 2.4 * half);
    }
    context.closePath();
    surface.fill('surface');
    surface.faintly(outline ? 0.16 : 1, () => surface.fill(ink));
    surface.stroke(ink, { width: 1.5 });
    for (const at of outline || rho === null || !measured ? [] : [-rho, rho])
      if (at <= l) surface.line(ink, -half - 3, at * metre, half + 3, at * metre, { width: 1.5 });
    context.rotate(pose.theta);
    drawCentre(surface, Math.max(6, half + 2), ink);
    surface.disc(bottom * Math.sin(pose.theta), bottom * Math.cos(pose.theta), 3, { fill: ink });
  } else drawCentre(surface, 8, ink);
  context.restore();
}

/** The sign for a centre of gravity: a circle in quarters. @param {Surface} surface @param {number} r @param {Colour} ink */
function drawCentre(surface, r, ink) {
  surface.disc(0, 0, r, { fill: 'surface' });
  const { context } = surface;
  context.beginPath();
  for (const from of [0, Math.PI]) {
    context.moveTo(0, 0);
    context.arc(0, 0, r, from, from + Math.PI / 2);
    context.closePath();
  }
  surface.fill(ink);
  surface.disc(0, 0, r, { stroke: ink, width: 1.5 });
}

/** The rods of other runs, at the same time since their release. @param {Stage} stage @param {OtherRod[]} others @param {number} t s */
export function drawOthers(stage, others, t) {
  stage.surface.faintly(OPACITY, () => {
    for (const { run, colour } of others) {
      const pose = run.poseAt(t);
      if (pose && run.scene) drawRod(stage, run.scene, pose, colour);
    }
  });
}

/** @param {Stage} stage @param {TablePose} table @param {number} half of its width, m */
function drawTable({ surface, x: across, y: up, metre, floor }, table, half) {
  const { context } = surface;
  const [x, y] = [across(table.x), up(table.y)];
  const reach = half * metre;
  surface.line('line', x, y + 16, x, floor - 8, { width: 8, cap: 'round' });
  context.save();
  context.translate(x, y);
  context.rotate(-table.alpha);
  context.beginPath();
  context.roundRect(-reach, 0, 2 * reach, 10, 5);
  surface.fill('accent');
  context.restore();
  surface.disc(x, y + 13, 5, { fill: 'surface', stroke: 'accent', width: 2 });
}

/** The path of the centre of gravity on a flight, up to a time. @param {Stage} stage @param {Arc} arc @param {number} end s @param {Scene} scene @param {number} [width] px */
export function drawFlight({ surface, x: across, y: up }, arc, end, scene, width = 1.5) {
  const { context } = surface;
  context.beginPath();
  for (let k = 0; k <= POINTS; k += 1) {
    const { x, y } = poseOn(arc, arc.t + ((end - arc.t) * k) / POINTS, scene);
    context.lineTo(across(x), up(y));
  }
  surface.stroke('accent', { width });
}

/** A faint path before a release: later flights are fainter; a dot marks each impact. @param {Stage} stage @param {RunState} run */
export function drawFlights(stage, run) {
  for (let flight = 0; flight < Math.min(FLIGHTS, run.impacts.end); flight += 1) {
    const arc = run.arcAt(flight === 0 ? -1 : run.impacts.at('t', flight - 1));
    const { scene } = run;
    if (!arc || !scene) return;
    const end = arc.t + arc.duration;
    stage.surface.faintly(0.5 * (1 - flight / (FLIGHTS + 1)), () => {
      drawFlight(stage, arc, end, scene);
      const { x, y } = poseOn(arc, end, scene);
      stage.surface.disc(stage.x(x), stage.y(y), 2.5, { fill: 'accent' });
    });
  }
}
