// Draws a run at a time: the body on its flight, the table on its way to the next strike, the last strike and the trail.

import { theme } from '../charts/theme.js';
import { fixed, fixedQuantity, unbroken } from '../dom/numbers.js';
import { contactDistance } from '../physics/body.js';
import { fallen } from '../physics/falling.js';
import { effectiveGravity, poseOn } from '../physics/flight.js';
import { strikeOf, strikeToCome, tableBetween } from '../physics/table.js';
import { MODES } from '../run/impact-messages.js';
import { drawRod, drawTable } from './bodies.js';
import { drawOthers } from './other-rods.js';
import { drawGrid, drawRulers, drawTarget } from './rulers.js';
import { drawStrike, tellStrike } from './strike-marks.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../charts/surface.js').Surface} Surface */
/** @typedef {(surface: Surface, scale: import('./camera.js').Scale, scene: Scene) => void} Under draws marks on the floor */
/** @typedef {{run: import('../run/run.js').Run, readout: HTMLElement, surface: Surface, camera: import('./camera.js').Camera, under: () => Under | null, tilt: () => number | null, others: () => import('./other-rods.js').OtherRod[], drew: (drawn: Pick<import('./bodies.js').Drawn, 'scene' | 'pose' | 'table' | 'struck'>) => void}} Parts */
/** @typedef {import('../run/impacts.js').Impact} Impact */
/** @typedef {import('../physics/flight.js').Arc} Arc */
/** @typedef {import('../physics/table.js').Strike} Strike */

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
    const { run, surface, camera, under, others, drew } = this.#parts;
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
    camera.follow(pose.x, (run.pace > 0 && moving) || this.falls ? since_s : null);
    drawGrid(surface, camera);
    const { scale } = camera;
    drawTarget(surface, camera, scene);
    under()?.(surface, scale, scene);
    this.#drawTrail(scene, place, t);
    const last = impact ? strikeOf(impact, scene) : firstTable(arc, scene);
    const next = this.#strikeAfter(place, scene) ?? last;
    const ownTable = held?.table ?? tableBetween(last, next, t);
    const tilt = run.phase === 'running' ? this.#parts.tilt() : null;
    const table = tilt === null ? ownTable : { ...ownTable, alpha: tilt };
    drawTable(context, scale, table, camera.halfTable(scene), camera.floor);
    drawOthers(context, scale, others(), t);
    const isKept = run.fate === 'kept' && run.past === null;
    drawRod(context, scale, scene, pose, { colour: isKept ? 'good' : 'ink' });
    const strength = impact && !held ? this.#glow(now, impact.t, moving) : 0;
    if (impact && strength > 0) drawStrike(context, scale, impact, last, strength);
    if (impact && !held)
      this.#numbersAt = tellStrike(context, scale, impact, camera.floor, scale.x(table.x), this.#numbersAt);
    drew({ scene, pose, table, struck: strength > 0 });
    drawRulers(surface, camera);
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
      context.beginPath();
      for (let k = 0; k <= 24; k += 1) {
        const pose = poseOn(arc, arc.t + ((end - arc.t) * k) / 24, scene);
        if (k === 0) context.moveTo(scale.x(pose.x), scale.y(pose.y));
        else context.lineTo(scale.x(pose.x), scale.y(pose.y));
      }
      context.stroke();
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
