// The drawn things of a scene: rods, table, the path of a typed scene. Where they are is said by who draws them.

import { disc, line } from '../charts/axes.js';
import { theme } from '../charts/theme.js';
import { contactDistance, derivedOf } from '../physics/body.js';
import { poseOn } from '../physics/flight.js';

/** @typedef {CanvasRenderingContext2D} Context */
/** @typedef {import('./camera.js').Scale} Scale */
/** @typedef {import('../physics/flight.js').Pose} Pose */

/** @typedef {'ink' | 'good' | 'series-1' | 'series-2' | 'series-3' | 'measured'} RodColour */
/** @typedef {{run: import('../run/run-state.js').RunState, colour: RodColour}} OtherRod the rod of another run */

/**
 * @typedef {object} Drawn what was drawn, for parts that go with it
 * @property {import('../api/scene-fields.js').Scene} scene
 * @property {Pose} pose
 * @property {{x: number, y: number, alpha: number}} table
 * @property {boolean} struck the marks of a strike are there
 * @property {number} half of the table's width, m
 * @property {Scale} scale
 * @property {number} zoom CSS px in one of the scale's
 */

/** Opacity of the rods of other runs. */
const OPACITY = 0.6;
/** Flights of a typed scene that are drawn, and points along any flight. */
const FLIGHTS = 6;
const POINTS = 24;

/**
 * The rod from its contact point through its centre of gravity, with marks at ±ρ: two half masses there would turn like it; or the
 * outline of a polygon.
 * @param {Context} context
 * @param {Scale} scale
 * @param {import('../api/scene-fields.js').Scene} scene
 * @param {Pose} pose
 * @param {{colour?: RodColour, opacity?: number}} [look]
 */
export function drawRod(context, scale, scene, pose, { colour = 'ink', opacity = 1 } = {}) {
  const { surface, [colour]: ink } = theme();
  const l = contactDistance(scene);
  const { radius_of_gyration: rho, outline } = derivedOf(scene);
  context.save();
  context.globalAlpha = opacity;
  context.translate(scale.x(pose.x), scale.y(pose.y));
  if (l === 0) {
    centre(context, 8, ink);
    return context.restore();
  }
  // The canvas turns clockwise, θ counter-clockwise.
  context.rotate(-pose.theta);
  const bottom = l * scale.metre;
  const top = -Math.max(l, rho ?? 0) * scale.metre;
  const half = Math.max(3, Math.min(9, 0.013 * scale.metre));
  context.beginPath();
  if (outline) {
    for (const [x, y] of outline) context.lineTo(x * scale.metre, -y * scale.metre);
  } else {
    context.moveTo(0, bottom);
    context.lineTo(half, bottom - 2.4 * half);
    context.lineTo(half, top + half);
    context.arc(0, top + half, half, 0, Math.PI, true);
    context.lineTo(-half, bottom - 2.4 * half);
  }
  context.closePath();
  context.fillStyle = surface;
  context.fill();
  context.globalAlpha = (outline ? 0.16 : 1) * opacity;
  context.fillStyle = ink;
  context.fill();
  context.globalAlpha = opacity;
  context.lineWidth = 1.5;
  context.strokeStyle = ink;
  context.stroke();
  for (const at of outline || rho === null || !scale.measured ? [] : [-rho, rho]) {
    if (at <= l) line(context, ink, -half - 3, at * scale.metre, half + 3, at * scale.metre);
  }
  context.rotate(pose.theta);
  centre(context, Math.max(6, half + 2), ink);
  disc(context, bottom * Math.sin(pose.theta), bottom * Math.cos(pose.theta), 3, { fill: ink });
  context.restore();
}

/** The sign for a centre of gravity: a circle in quarters. @param {Context} context @param {number} r @param {string} ink */
function centre(context, r, ink) {
  disc(context, 0, 0, r, { fill: theme().surface });
  context.fillStyle = ink;
  for (const from of [0, Math.PI]) {
    context.beginPath();
    context.moveTo(0, 0);
    context.arc(0, 0, r, from, from + Math.PI / 2);
    context.closePath();
    context.fill();
  }
  disc(context, 0, 0, r, { stroke: ink, width: 1.5 });
}

/** The rods of other runs, at the same time since their release. @param {Context} context @param {Scale} scale @param {OtherRod[]} others @param {number} t s */
export function drawOthers(context, scale, others, t) {
  for (const { run, colour } of others) {
    const pose = run.poseAt(t);
    if (pose && run.scene) drawRod(context, scale, run.scene, pose, { colour, opacity: OPACITY });
  }
}

/**
 * @param {Context} context
 * @param {Scale} scale
 * @param {{x: number, y: number, alpha: number}} table the middle of its face, and its tilt
 * @param {number} half of its width, m
 * @param {number} floor px
 */
export function drawTable(context, scale, table, half, floor) {
  const { accent, surface, line: stand } = theme();
  const x = scale.x(table.x);
  const y = scale.y(table.y);
  const reach = half * scale.metre;
  context.lineWidth = 8;
  context.lineCap = 'round';
  line(context, stand, x, y + 16, x, floor - 8);
  context.lineCap = 'butt';
  context.save();
  context.translate(x, y);
  context.rotate(-table.alpha);
  context.fillStyle = accent;
  context.beginPath();
  context.roundRect(-reach, 0, 2 * reach, 10, 5);
  context.fill();
  context.restore();
  disc(context, x, y + 13, 5, { fill: surface, stroke: accent, width: 2 });
}

/** The path of the centre of gravity on a flight, up to a time. @param {Context} context @param {Scale} scale @param {import('../physics/flight.js').Arc} arc @param {number} end s @param {import('../api/scene-fields.js').Scene} scene */
export function drawFlight(context, scale, arc, end, scene) {
  context.beginPath();
  for (let k = 0; k <= POINTS; k += 1) {
    const { x, y } = poseOn(arc, arc.t + ((end - arc.t) * k) / POINTS, scene);
    context.lineTo(scale.x(x), scale.y(y));
  }
  context.stroke();
}

/** A faint path before a release: later flights are fainter; a dot marks each impact. @param {Context} context @param {Scale} scale @param {import('../run/run-state.js').RunState} run */
export function drawFlights(context, scale, run) {
  const { accent } = theme();
  for (let flight = 0; flight < Math.min(FLIGHTS, run.impacts.end); flight += 1) {
    const arc = run.arcAt(flight === 0 ? -1 : run.impacts.at('t', flight - 1));
    if (!arc || !run.scene) return;
    const end = arc.t + arc.duration;
    context.globalAlpha = 0.5 * (1 - flight / (FLIGHTS + 1));
    context.lineWidth = 1.5;
    context.strokeStyle = accent;
    drawFlight(context, scale, arc, end, run.scene);
    const { x, y } = poseOn(arc, end, run.scene);
    disc(context, scale.x(x), scale.y(y), 2.5, { fill: accent });
  }
  context.globalAlpha = 1;
}
