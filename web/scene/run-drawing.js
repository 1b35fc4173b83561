// Draws a run at a time: the body on its flight, the table on its way to the next strike, the last strike and the trail.

import { fixed, fixedQuantity, unbroken } from '../dom/numbers.js';
import { contactDistance, derivedOf, reachAbove } from '../physics/body.js';
import { effectiveGravity, poseOn } from '../physics/flight.js';
import { strikeOf, strikeToCome, tableBetween } from '../physics/table.js';
import { MODES } from '../run/impacts.js';
import { drawFlight, drawOthers } from './world.js';

/** Time for which the marks of a strike are visible, in wall time. */
const GLOW_S = 0.28;
const TRAIL_FLIGHTS = 5;
/** The ground lies so far above the lower edge of the picture, px, and within this share of the way from there to the table. */
const GROUND_PX = 72;
const GROUND_SHARE = 0.65;
/** Least times between two writings of the numbers of a run that goes on, and of its spoken name, ms. */
const WRITTEN_MS = 100;
const SPOKEN_MS = 2000;

export class RunDrawing {
  #view;
  #drawn_ms = 0;
  /** The time at which the fall was first drawn. @type {number | null} */
  #fell_ms = null;
  /** True while the body is on its way to the ground. */
  falls = false;
  #written_ms = -Infinity;
  #spoken_ms = -Infinity;
  /** The end of the picture with the numbers of the newest strike. @type {'left' | 'right'} */
  #numbersAt = 'right';

  /** @param {import('./world.js').World & {run: Run, readout: HTMLElement}} view */
  constructor(view) {
    this.#view = view;
  }

  /** @param {number} now_ms @param {boolean} moving flights are drawn, not only strikes */
  draw(now_ms, moving) {
    const view = this.#view;
    const { run, under, others, tilt } = view;
    const since_s = Math.min(0.1, (now_ms - this.#drawn_ms) / 1000);
    this.#drawn_ms = now_ms;
    const now = run.shown;
    const scene = /** @type {Scene} */ (run.sceneAfter(now));
    const place = run.placeAt(now);
    const impact = place === null ? null : run.impacts.row(place);
    const arc = run.arcAt(now);
    if (!arc) return view.drawGrid();
    // Without flights, the pose of the last strike is held until the next one.
    const t = moving || !impact ? now : arc.t;
    const held = run.holds?.at(now, impact?.t ?? -Infinity, scene);
    const pose = this.#fall(now_ms, impact, arc, scene, moving) ?? held?.pose ?? poseOn(arc, t, scene);
    view.contain(scene, arc.y + Math.max(0, arc.y_dot) ** 2 / (2 * effectiveGravity(scene)));
    const last = impact ? strikeOf(impact, scene) : firstTable(arc, scene);
    const table = { ...(held?.table ?? tableBetween(last, this.#strikeAfter(place, scene) ?? last, t)) };
    if (run.phase === 'running' && tilt !== null) table.alpha = tilt;
    view.follow(
      pose.x,
      { x: table.x, half: view.halfTable(scene) },
      (run.pace > 0 && moving) || this.falls ? since_s : null,
    );
    view.paint(scene, pose, table, {
      ink: run.fate === 'kept' && run.past === null ? 'good' : 'ink',
      under: (stage) => {
        under?.(stage, scene);
        this.#drawTrail(stage, scene, place, t);
      },
      beside: (stage) => drawOthers(stage, others, t),
      over: (stage) => {
        if (!impact || held) return false;
        const strength = this.#glow(now, impact.t, moving);
        if (strength > 0) drawStrike(stage, impact, last, strength);
        this.#numbersAt = tellStrike(stage, impact, stage.x(table.x), this.#numbersAt);
        return strength > 0;
      },
    });
    this.#say(now_ms, now, pose, impact);
  }

  /** The strike at the end of the flight from an impact, or from the release. @param {number | null} place @param {Scene} scene @returns {Strike | null} */
  #strikeAfter(place, scene) {
    const { impacts, nextStrike } = this.#view.run;
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
    const { run } = this.#view;
    this.falls = false;
    if (run.fate !== 'fell' || run.outcome?.contact || run.past !== null) {
      this.#fell_ms = null;
      return null;
    }
    this.#fell_ms ??= now_ms;
    const { y, floor, metre } = this.#view.stage;
    const below = floor - y(0);
    const ground = -(below - Math.min(GROUND_PX, GROUND_SHARE * below)) / metre;
    const flies = !impact || !Number.isNaN(impact.y_dot_after);
    const from = flies ? { ...arc, ...poseOn(arc, run.present, scene) } : { ...arc, ...velocities(impact) };
    if (flies) from.y_dot -= effectiveGravity(scene) * Math.max(0, run.present - arc.t);
    const t = moving ? ((now_ms - this.#fell_ms) / 1000) * run.clock.speed : Infinity;
    const { pose, lies } = fallen(from, scene, ground, t);
    this.falls = !lies;
    return pose;
  }

  /** The strength of a strike's marks, from 0 to 1: they fade as the run goes on, and stay when it stands still. @param {number} now @param {number} struck @param {boolean} moving */
  #glow(now, struck, moving) {
    const { run } = this.#view;
    if (run.phase === 'ended' && run.past === null) return 1;
    const still = now - struck < 1e-6 || !moving ? 0 : GLOW_S / 2;
    // Divided by the speed, run time is wall time.
    const age_s = run.pace > 0 && moving ? (now - struck) / Math.max(run.pace, 1e-6) : still;
    return Math.max(0, 1 - age_s / GLOW_S);
  }

  /** Writes the drawn values as text. @param {number} now_ms @param {number} t @param {Pose} pose @param {Impact | null} impact */
  #say(now_ms, t, pose, impact) {
    const { run, readout, layers } = this.#view;
    const running = run.pace > 0;
    if (running && now_ms - this.#written_ms < WRITTEN_MS) return;
    this.#written_ms = now_ms;
    // More digits are legible while the picture stands still.
    const [seconds, rest] = running ? [2, 3] : [4, 5];
    const n = impact?.n ?? 0;
    readout.textContent = unbroken(
      `t ${fixed(t, seconds)} s   bounce ${n}   θ ${fixedQuantity(pose.theta, 'rad', rest)}   x ${fixed(pose.x, rest)} m   y ${fixed(pose.y, rest)} m${contactWords(impact, rest)}`,
    );
    if (!running || now_ms - this.#spoken_ms > SPOKEN_MS) {
      this.#spoken_ms = now_ms;
      const contact = contactWords(impact, 3).replace(/ {3}/g, ', ');
      layers[0].canvas.ariaLabel = `The rod and the table after bounce ${n}: tilted by ${fixedQuantity(pose.theta, 'rad', 2)} at x = ${fixed(pose.x, 2)} m${contact}`;
    }
  }

  /** Draws the path of the centre of gravity on the last flights. @param {Stage} stage @param {Scene} scene @param {number | null} place @param {number} t */
  #drawTrail(stage, scene, place, t) {
    const { run } = this.#view;
    const { impacts } = run;
    // Seen from the back of a room.
    const strong = stage.surface.zoom > 1;
    for (let back = 0; back <= TRAIL_FLIGHTS; back += 1) {
      const at = place === null ? -1 - back : place - back;
      if (at < impacts.begin - 1 || at < -1) break;
      const arc = run.arcAt(at < impacts.begin ? -1 : impacts.at('t', at));
      if (!arc) break;
      stage.surface.faintly((strong ? 1 : 0.5) * (1 - back / (TRAIL_FLIGHTS + 1)), () =>
        drawFlight(stage, arc, Math.min(t, arc.t + arc.duration), scene, strong ? 2.5 : 1.5),
      );
      if (at < impacts.begin) break;
    }
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

/** Describes the newest contact; empty for a frictionless strike at y = 0. @param {Impact | null} impact @param {number} decimals */
function contactWords(impact, decimals) {
  if (!impact) return '';
  const mode = MODES[impact.mode] ?? 'frictionless';
  const told = mode === 'frictionless' ? '' : `   contact: ${mode.replace('_', ' ')}`;
  return told + (impact.clearance ? `   struck at ${fixed(impact.clearance, decimals)} m` : '');
}

/** @param {Impact} impact at which no strike could be made */
const velocities = ({ x_dot, y_dot, theta_dot }) => ({ x_dot, y_dot, theta_dot: theta_dot || 0 });

/** @typedef {Pose & {x_dot: number, y_dot: number, theta_dot: number}} State */

/** Step of the picture, s, and the longest fall that is drawn. */
const STEP_S = 1 / 400;
const LONGEST_S = 3;

/**
 * The body after a fall: a picture, since the table has left it. It flies, an end touches the ground and stays there, and the body turns about it.
 * @param {State} from the state as it fell
 * @param {Scene} scene
 * @param {number} ground height of the ground, m
 * @param {number} t time since then, s
 * @returns {{pose: Pose, lies: boolean}}
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

// Metres of arrow for each m/s of impulse, so that an usual strike has an arrow of some 10 cm.
const ARROW_S = 0.04;
// Friction is much the smaller part.
const FRICTION_S = 0.2;
const LEAST_PX = 26;
// Over the table, on which it would not be seen.
const RAISED_PX = 8;
/** Height of a line of numbers, px. */
const LINE_PX = 16;
/** Width of a scene with no room for long lines beside the table’s stand, px. */
const NARROW_PX = 400;
/** From the numbers to the edge of the picture, and to the middle of the stand, px. */
const EDGE_PX = 10;
const STAND_PX = 32;

/** The strike with its strength from 0 to 1, where rod and table met. @param {Stage} stage @param {Impact} impact @param {Strike} strike @param {number} strength */
function drawStrike(stage, impact, strike, strength) {
  const { surface } = stage;
  const [x, y] = [stage.x(strike.x), stage.y(strike.y)];
  surface.faintly(strength, () => {
    if (stage.measured) drawImpulse(stage, impact, x, y);
    surface.disc(x, y, 4 + 10 * (1 - strength), { stroke: 'strike', width: 2 });
  });
}

/** The normal, the impulse and its part along the table, which is friction. @param {Stage} stage @param {Impact} impact @param {number} x px @param {number} y */
function drawImpulse({ surface, metre }, impact, x, y) {
  const [sin, cos] = [Math.sin(impact.alpha), Math.cos(impact.alpha)];
  /** @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {Colour} colour */
  const arrow = (x0, y0, x1, y1, colour) => {
    const angle = Math.atan2(y1 - y0, x1 - x0);
    surface.line(colour, x0, y0, x1 - Math.cos(angle) * 7, y1 - Math.sin(angle) * 7, { width: 2.5 });
    const { context } = surface;
    context.beginPath();
    context.moveTo(x1, y1);
    for (const side of [2.6, -2.6]) context.lineTo(x1 + 9 * Math.cos(angle + side), y1 + 9 * Math.sin(angle + side));
    context.closePath();
    surface.fill(colour);
  };
  // Farther than the rod, on which it would not be seen.
  const reach = 0.85 * y;
  surface.line('ink', x, y, x - sin * reach, y - cos * reach, { dashes: [4, 4] });
  surface.text('n', x - sin * reach + 5, y - cos * reach, { colour: 'ink', italic: true });
  const { dx, dy, along: impulse, friction, rubs } = impulseOf(impact);
  if (!(impulse > 0)) return;
  if (rubs) {
    // A small one still shows which way it goes; its number is beside it.
    const shown = Math.max(LEAST_PX, FRICTION_S * Math.abs(friction) * metre);
    const along = Math.sign(friction) * Math.min(shown, 0.3 * surface.width);
    const [fx, fy] = [x - sin * RAISED_PX, y - cos * RAISED_PX];
    arrow(fx, fy, fx + cos * along, fy - sin * along, 'good');
  }
  const length = Math.min(ARROW_S * impulse * metre, y * 0.8);
  if (length <= 9) return;
  // Beside the rod, so that the arrow is seen along its whole length, and not where friction points.
  const foot = x + ((rubs ? friction : dx) > 0 ? -16 : 16);
  const [tipX, tipY] = [foot + (dx / impulse) * length, y - (dy / impulse) * length];
  arrow(foot, y, tipX, tipY, 'strike');
  surface.text('P', tipX + 6, tipY, { colour: 'strike', italic: true });
}

/**
 * The numbers of the newest strike, below the level of the table: at one end, until the stand of the table comes there.
 * @param {Stage} stage
 * @param {Impact} impact
 * @param {number} stand its middle, px
 * @param {'left' | 'right'} end at which the numbers were last
 * @returns {'left' | 'right'}
 */
function tellStrike({ surface, floor, measured }, impact, stand, end) {
  const { along, friction, rubs } = impulseOf(impact);
  if (Number.isNaN(along) || !measured) return end;
  const { width } = surface;
  const per = width < NARROW_PX ? '/' : ' per ';
  /** @type {[colour: Colour, words: string][]} */
  const lines = [
    ['muted', `bounce ${impact.n}`],
    ['strike', `α ${fixedQuantity(impact.alpha, 'rad', 3)}`],
    ['strike', `impulse${per}mass ${fixed(along, 2)}\u202fm/s`],
  ];
  if (rubs) lines.push(['good', `friction${per}mass ${fixed(friction, 2)}\u202fm/s`]);
  const room = Math.max(...lines.map(([, words]) => surface.widthOf(words))) + EDGE_PX + STAND_PX;
  const align = end === 'right' && stand > width - room ? 'left' : end === 'left' && stand < room ? 'right' : end;
  const x = align === 'right' ? width - EDGE_PX : EDGE_PX;
  for (const [index, [colour, words]] of lines.toReversed().entries())
    surface.text(words, x, floor - 3 - index * LINE_PX, { colour, align, baseline: 'bottom' });
  return align;
}

/** The impulse per mass of a strike, and its part along the table. @param {Impact} impact */
function impulseOf(impact) {
  const dx = impact.x_dot_after - impact.x_dot;
  const dy = impact.y_dot_after - impact.y_dot;
  const along = Math.hypot(dx, dy);
  const friction = dx * Math.cos(impact.alpha) + dy * Math.sin(impact.alpha);
  const rubs = MODES[impact.mode] !== 'frictionless' && Math.abs(friction) > 1e-9 * along;
  return { dx, dy, along, friction, rubs };
}
