// Draws a run at a time: the body on its flight, the table on its way to the next strike, the last strike and the trail.

import { theme } from '../charts/theme.js';
import { fixed, fixedQuantity, unbroken } from '../dom/numbers.js';
import { contactDistance, derivedOf, reachAbove } from '../physics/body.js';
import { effectiveGravity, poseOn } from '../physics/flight.js';
import { strikeOf, strikeToCome, tableBetween } from '../physics/table.js';
import { MODES } from '../run/impacts.js';
import { drawFlight, drawOthers } from './bodies.js';
import { drawGrid } from './camera.js';
import { drawStrike, tellStrike } from './strike-marks.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./camera.js').Scale} Scale */
/** @typedef {import('../run/impacts.js').Impact} Impact */
/** @typedef {import('../physics/flight.js').Arc} Arc */
/** @typedef {import('../physics/table.js').Strike} Strike */

/**
 * @typedef {object} Moment the body over its table, and what goes with them
 * @property {Scene} scene
 * @property {import('../physics/flight.js').Pose} pose
 * @property {{x: number, y: number, alpha: number}} table
 * @property {import('./bodies.js').RodColour} [colour]
 * @property {(scale: Scale) => void} [under] draws what lies under the table
 * @property {(scale: Scale) => void} [beside] draws what lies between table and body
 * @property {(scale: Scale) => boolean} [over] draws what lies over the body; true where that is a strike
 */

/**
 * @typedef {object} Parts of the view
 * @property {import('../run/run.js').Run} run
 * @property {HTMLElement} readout
 * @property {import('../charts/surface.js').Surface} surface
 * @property {import('./camera.js').Camera} camera
 * @property {{under: ((surface: import('../charts/surface.js').Surface, scale: Scale, scene: Scene) => void) | null, tilt: number | null, others: import('./bodies.js').OtherRod[]}} guests marks on the floor, the tilt of a table in somebody's hand, other rods
 * @property {(moment: Moment) => void} paint
 */

/** Time for which the marks of a strike are visible, in wall time. */
const GLOW_S = 0.28;
const TRAIL_FLIGHTS = 5;
/** The ground lies so far above the lower edge of the picture, px, and within this share of the way from there to the table. */
const GROUND_PX = 72;
const GROUND_SHARE = 0.65;

export class RunDrawing {
  #parts;
  #drawn_ms = 0;
  /** The time at which the fall was first drawn. @type {number | null} */
  #fell_ms = null;
  /** True while the body is on its way to the ground. */
  falls = false;
  #read_ms = -Infinity;
  /** The end of the picture with the numbers of the newest strike. @type {'left' | 'right'} */
  #numbersAt = 'right';

  /** @param {Parts} parts of the view */
  constructor(parts) {
    this.#parts = parts;
  }

  /** @param {number} now_ms @param {boolean} moving flights are drawn, not only strikes */
  draw(now_ms, moving) {
    const { run, surface, camera, guests, paint } = this.#parts;
    const { context } = surface;
    const since_s = Math.min(0.1, (now_ms - this.#drawn_ms) / 1000);
    this.#drawn_ms = now_ms;
    const now = run.shown;
    const scene = /** @type {Scene} */ (run.sceneAfter(now));
    const place = run.placeAt(now);
    const impact = place === null ? null : run.impacts.row(place);
    const arc = run.arcAt(now);
    if (!arc) return drawGrid(surface, camera);
    // Without flights, the pose of the last strike is held until the next one.
    const t = moving || !impact ? now : arc.t;
    const held = run.holds?.at(now, impact?.t ?? -Infinity, scene);
    const fall = this.#fall(now_ms, impact, arc, scene, moving);
    const pose = fall ?? held?.pose ?? poseOn(arc, t, scene);
    camera.contain(scene, arc.y + Math.max(0, arc.y_dot) ** 2 / (2 * effectiveGravity(scene)));
    const last = impact ? strikeOf(impact, scene) : firstTable(arc, scene);
    const ownTable = held?.table ?? tableBetween(last, this.#strikeAfter(place, scene) ?? last, t);
    const tilt = run.phase === 'running' ? guests.tilt : null;
    const table = tilt === null ? ownTable : { ...ownTable, alpha: tilt };
    const half = camera.halfTable(scene);
    camera.follow(pose.x, { x: table.x, half }, (run.pace > 0 && moving) || this.falls ? since_s : null);
    const strength = impact && !held ? this.#glow(now, impact.t, moving) : 0;
    paint({
      scene,
      pose,
      table,
      colour: run.fate === 'kept' && run.past === null ? 'good' : 'ink',
      under: (scale) => {
        guests.under?.(surface, scale, scene);
        this.#drawTrail(scene, place, t);
      },
      beside: (scale) => drawOthers(context, scale, guests.others, t),
      over: (scale) => {
        if (!impact || held) return false;
        if (strength > 0) drawStrike(context, scale, impact, last, strength);
        this.#numbersAt = tellStrike(context, scale, impact, camera.floor, scale.x(table.x), this.#numbersAt);
        return strength > 0;
      },
    });
    this.#say(now_ms, now, pose, impact);
  }

  /**
   * The strike at the end of the flight from an impact, or from the release.
   * @param {number | null} place
   * @param {Scene} scene
   * @returns {Strike | null}
   */
  #strikeAfter(place, scene) {
    const { impacts, nextStrike } = this.#parts.run;
    const after = place === null ? impacts.begin : place + 1;
    if (after < impacts.end) return strikeOf(impacts.row(after), scene);
    return nextStrike?.n === (impacts.last?.n ?? 0) + 1 ? strikeToCome(nextStrike) : null;
  }

  /**
   * The pose of a body that has fallen off the table, on its way to the ground; null before.
   * @param {number} now_ms
   * @param {Impact | null} impact the last
   * @param {Arc} arc after it
   * @param {Scene} scene
   * @param {boolean} moving else it lies at once
   */
  #fall(now_ms, impact, arc, scene, moving) {
    const { run, camera } = this.#parts;
    this.falls = false;
    if (run.fate !== 'fell' || run.outcome?.contact || run.past !== null) {
      this.#fell_ms = null;
      return null;
    }
    this.#fell_ms ??= now_ms;
    const { scale } = camera;
    const below = camera.floor - scale.y(0);
    const ground = -(below - Math.min(GROUND_PX, GROUND_SHARE * below)) / scale.metre;
    const flies = !impact || !Number.isNaN(impact.y_dot_after);
    const from = flies ? { ...arc, ...poseOn(arc, run.present, scene) } : { ...arc, ...velocities(impact) };
    if (flies) from.y_dot -= effectiveGravity(scene) * Math.max(0, run.present - arc.t);
    const { pose, lies } = fallen(
      from,
      scene,
      ground,
      moving ? ((now_ms - this.#fell_ms) / 1000) * run.clock.speed : Infinity,
    );
    this.falls = !lies;
    return pose;
  }

  /**
   * The strength of a strike's marks, from 0 to 1: they fade as the run goes on, and stay when it stands still.
   * @param {number} now
   * @param {number} struck
   * @param {boolean} moving
   */
  #glow(now, struck, moving) {
    const { run } = this.#parts;
    if (run.phase === 'ended' && run.past === null) return 1;
    const still = now - struck < 1e-6 || !moving ? 0 : GLOW_S / 2;
    // Divided by the speed, run time is wall time.
    const age_s = run.pace > 0 && moving ? (now - struck) / Math.max(run.pace, 1e-6) : still;
    return Math.max(0, 1 - age_s / GLOW_S);
  }

  /**
   * Writes the drawn values as text, at most ten times a second while running.
   * @param {number} now_ms
   * @param {number} t
   * @param {import('../physics/flight.js').Pose} pose
   * @param {Impact | null} impact
   */
  #say(now_ms, t, pose, impact) {
    const { run, readout, surface } = this.#parts;
    const running = run.pace > 0;
    if (running && now_ms - this.#read_ms < 100) return;
    // More digits are legible while the picture stands still.
    const [seconds, rest] = running ? [2, 3] : [4, 5];
    const n = impact?.n ?? 0;
    readout.textContent = unbroken(
      `t ${fixed(t, seconds)} s   bounce ${n}   θ ${fixedQuantity(pose.theta, 'rad', rest)}   x ${fixed(pose.x, rest)} m   y ${fixed(pose.y, rest)} m${contactWords(impact, rest)}`,
    );
    if (!running || now_ms - this.#read_ms > 2000 || this.#read_ms === -Infinity) {
      const contact = contactWords(impact, 3).replace(/ {3}/g, ', ');
      surface.canvas.setAttribute(
        'aria-label',
        `The rod and the table after bounce ${n}: tilted by ${fixedQuantity(pose.theta, 'rad', 2)} at x = ${fixed(pose.x, 2)} m${contact}`,
      );
    }
    this.#read_ms = now_ms;
  }

  /**
   * Draws the path of the centre of gravity on the last flights.
   * @param {Scene} scene
   * @param {number | null} place
   * @param {number} t
   */
  #drawTrail(scene, place, t) {
    const {
      run,
      surface: { context, zoom },
      camera: { scale },
    } = this.#parts;
    const { impacts } = run;
    // Seen from the back of a room.
    const strong = zoom > 1;
    context.strokeStyle = theme().accent;
    context.lineWidth = strong ? 2.5 : 1.5;
    for (let back = 0; back <= TRAIL_FLIGHTS; back += 1) {
      const at = place === null ? -1 - back : place - back;
      if (at < impacts.begin - 1 || at < -1) break;
      const arc = run.arcAt(at < impacts.begin ? -1 : impacts.at('t', at));
      if (!arc) break;
      const end = Math.min(t, arc.t + arc.duration);
      context.globalAlpha = (strong ? 1 : 0.5) * (1 - back / (TRAIL_FLIGHTS + 1));
      drawFlight(context, scale, arc, end, scene);
      if (at < impacts.begin) break;
    }
    context.globalAlpha = 1;
  }
}

/** The table below the release, before its first strike. @param {Arc} arc @param {Scene} scene @returns {Strike} */
const firstTable = (arc, scene) => ({
  t: 0,
  x: arc.x + contactDistance(scene) * Math.sin(arc.theta),
  y: 0,
  alpha: 0,
  speed: 0,
});

/**
 * Describes the newest contact; empty for a frictionless strike at y = 0.
 * @param {Impact | null} impact
 * @param {number} decimals
 */
function contactWords(impact, decimals) {
  if (!impact) return '';
  const mode = MODES[impact.mode] ?? 'frictionless';
  const told = mode === 'frictionless' ? '' : `   contact: ${mode.replace('_', ' ')}`;
  return told + (impact.clearance ? `   struck at ${fixed(impact.clearance, decimals)} m` : '');
}

/** @param {Impact} impact at which no strike could be made */
const velocities = ({ x_dot, y_dot, theta_dot }) => ({ x_dot, y_dot, theta_dot: theta_dot || 0 });

/** @typedef {import('../physics/flight.js').Pose & {x_dot: number, y_dot: number, theta_dot: number}} State */

/** Step of the picture, s, and the longest fall that is drawn. */
const STEP_S = 1 / 400;
const LONGEST_S = 3;

/**
 * The body after a fall: a picture, since the table has left it. It flies, an end touches the ground and stays there, and the body turns about it.
 * @param {State} from the state as it fell
 * @param {Scene} scene
 * @param {number} ground height of the ground, m
 * @param {number} t time since then, s
 * @returns {{pose: import('../physics/flight.js').Pose, lies: boolean}}
 */
function fallen(from, scene, ground, t) {
  const { contact_distance: l, radius_of_gyration: rho } = derivedOf(scene);
  const gravity = effectiveGravity(scene);
  const above = reachAbove(scene);
  let { x, y, theta, x_dot, y_dot, theta_dot } = from;
  const square = (rho ?? 0) ** 2;
  /** From the centre of gravity to the end on the ground along the body, m; null in flight. @type {number | null} */
  let end = null;
  for (let s = 0; s < Math.min(t, LONGEST_S); s += STEP_S) {
    if (end === null) {
      y_dot -= gravity * STEP_S;
      x += x_dot * STEP_S;
      y += y_dot * STEP_S;
      theta += theta_dot * STEP_S;
      for (const one of [-l, above]) {
        if (end !== null || y + one * Math.cos(theta) > ground) continue;
        end = one;
        // About that end the angular momentum stays.
        const [rx, ry] = [one * Math.sin(theta), -one * Math.cos(theta)];
        theta_dot = (square * theta_dot + rx * y_dot - ry * x_dot) / (square + one ** 2 || 1);
      }
    } else {
      theta_dot += ((gravity * -end * Math.sin(theta)) / (square + end ** 2 || 1)) * STEP_S;
      const foot = x - end * Math.sin(theta);
      theta += theta_dot * STEP_S;
      x = foot + end * Math.sin(theta);
      y = ground - end * Math.cos(theta);
      const other = end === -l ? above : -l;
      if (y + other * Math.cos(theta) <= ground) return { pose: { x, y, theta }, lies: true };
    }
  }
  return { pose: { x, y, theta }, lies: t >= LONGEST_S };
}
