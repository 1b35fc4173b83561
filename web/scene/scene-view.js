// The rod and the table to scale, between and at the strikes. Draws what the run's clock says; keeps no time of its own.

import { h } from '../dom/dom.js';
import { drawRod, drawStrike, drawTable } from './bodies.js';
import { MODES } from '../run/impact-messages.js';
import { line, roundStep } from '../charts/axes.js';
import { SANS, onThemeChange, theme } from '../charts/theme.js';
import { contactDistance, corners, effectiveGravity, poseOn, strikeAfter, tableBetween } from '../physics/flight.js';
import { invalidate, surfaces } from '../charts/surface.js';
import { fixed, number, unbroken } from '../dom/numbers.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../run/run.js').Run} Run */
/** @typedef {import('../physics/flight.js').Arc} Arc */
/** @typedef {import('../physics/flight.js').Strike} Strike */

// How long a strike stays to be seen, in wall time.
const GLOW_S = 0.28;
const TRAIL_FLIGHTS = 3;
const RULER = 22;

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class SceneView {
  #run;
  #box;
  #surface;
  /** Draws marks on the floor. @type {((surface: import('../charts/surface.js').Surface, scale: import('./bodies.js').Scale, scene: Scene) => void) | null} */
  under = null;
  #readout;
  /** What to draw while there is no run. @type {Scene | null} */
  #draft = null;
  /** Flights in between are drawn unless motion is unwanted. */
  #moving = !stillness.matches;
  #camera = 0;
  #top = 0;
  #drawn_ms = 0;
  #read_ms = -Infinity;
  /** Scrolled out of sight, it costs nothing. */
  #seen = true;

  /**
   * @param {HTMLElement} box
   * @param {HTMLElement} readout
   * @param {Run} run
   */
  constructor(box, readout, run) {
    this.#run = run;
    this.#box = box;
    this.#readout = readout;
    box.setAttribute('role', 'img');
    box.setAttribute('aria-label', 'The scene');
    this.layers = surfaces(box, 1, () => this.redraw());
    [this.#surface] = this.layers;
    onThemeChange(() => this.redraw());
    new IntersectionObserver(([entry]) => {
      this.#seen = entry.isIntersecting;
      this.redraw();
    }).observe(box);
    const motion = h('input', {
      type: 'checkbox',
      change: () => {
        this.#moving = motion.checked;
        this.redraw();
      },
    });
    motion.checked = this.#moving;
    const offer = h(
      'label',
      { class: 'motion check', hidden: !stillness.matches },
      motion,
      'Draw the flights, not only the strikes',
    );
    box.after(offer);
    stillness.addEventListener('change', () => {
      offer.hidden = !stillness.matches;
      motion.checked = this.#moving = !stillness.matches;
      this.redraw();
    });
  }

  /** @param {Scene | null} scene */
  draft(scene) {
    this.#draft = scene;
    if (this.#run.phase === 'idle') this.#top = 0;
    this.redraw();
  }

  /** The camera and the scale start over with a new run. */
  reset() {
    this.#camera = 0;
    this.#top = 0;
    this.redraw();
  }

  redraw() {
    invalidate(this);
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    const since_s = Math.min(0.1, (now_ms - this.#drawn_ms) / 1000);
    this.#drawn_ms = now_ms;
    const { phase } = this.#run;
    const live = phase !== 'idle' && this.#run.scene;
    if (live) this.#drawRun(now_ms, since_s);
    else if (this.#draft) this.#drawRelease(this.#draft);
    else this.#ground();
    return Boolean(live) && phase === 'running' && this.#moving && this.#seen;
  }

  /** @param {Scene} scene */
  #drawRelease(scene) {
    const { height = 0, theta = 0, x = 0 } = scene.release ?? {};
    const l = contactDistance(scene);
    const y = Math.max(height, l * Math.cos(theta));
    this.#frame(scene, y);
    this.#camera = x;
    this.#ground();
    const scale = this.#scale();
    this.#wanted(scale, scene);
    drawTable(
      this.#surface.context,
      scale,
      { x: x + l * Math.sin(theta), y: 0, alpha: 0 },
      this.#plate(scene),
      this.#floor(),
    );
    drawRod(this.#surface.context, scale, scene, { x, y, theta });
    this.#rulers();
    this.#readout.textContent = `Released at ${fixed(height, 3)} m, θ ${fixed(theta, 3)} rad`;
    this.#box.setAttribute(
      'aria-label',
      `The scene before release: the centre of gravity ${number(height)} m high, tilted by ${number(theta)} rad`,
    );
  }

  /**
   * @param {number} now_ms
   * @param {number} since_s
   */
  #drawRun(now_ms, since_s) {
    const run = this.#run;
    const scene = /** @type {Scene} */ (run.scene);
    const now = run.phase === 'ended' ? (run.outcome?.t ?? Infinity) : run.clock.runTime();
    const place = run.placeAt(now);
    const impact = place === null ? null : run.impacts.row(place);
    const arc = run.arcAt(now);
    if (!arc) return this.#ground();
    // Where flights are not wanted, the pose of the last strike stands still until the next one.
    const t = this.#moving || !impact ? now : arc.t;
    const pose = poseOn(arc, t, scene);
    this.#frame(scene, arc.y + (arc.y_dot ** 2 * Math.sign(Math.max(0, arc.y_dot))) / (2 * effectiveGravity(scene)));
    this.#follow(pose.x, since_s);
    const { context } = this.#surface;
    this.#ground();
    const scale = this.#scale();
    this.#wanted(scale, scene);
    this.under?.(this.#surface, scale, scene);
    this.#trail(scale, scene, place, t);
    const last = strikeOf(impact, scene) ?? {
      t: 0,
      x: arc.x + contactDistance(scene) * Math.sin(arc.theta),
      y: 0,
      alpha: 0,
      speed: 0,
    };
    const next = arc.duration > 0 ? strikeAfter(arc, scene) : last;
    drawTable(context, scale, tableBetween(last, next, t), this.#plate(scene), this.#floor());
    drawRod(context, scale, scene, pose);
    if (impact) {
      const age_s =
        run.phase === 'running' && this.#moving
          ? (now - impact.t) / Math.max(run.clock.speed, 1e-6)
          : now - impact.t < 1e-6 || !this.#moving
            ? 0
            : GLOW_S / 2;
      // Slower runs keep the strike as long as it can be seen; one that stands still keeps it.
      const strength = run.phase === 'ended' ? 1 : Math.max(0, 1 - age_s / GLOW_S);
      if (strength > 0) drawStrike(context, scale, impact, last, strength);
    }
    this.#rulers();
    this.#say(now_ms, now, pose, impact);
  }

  /** Shows in numbers what is drawn, at a pace one can read. @param {number} now_ms @param {number} t @param {import('../physics/flight.js').Pose} pose @param {import('../run/impacts.js').Impact | null} impact */
  #say(now_ms, t, pose, impact) {
    const moving = this.#run.phase === 'running';
    if (moving && now_ms - this.#read_ms < 100) return;
    // What stands still can be read to the last digit that matters.
    const [seconds, rest] = moving ? [2, 3] : [4, 5];
    this.#readout.textContent = unbroken(
      `t ${fixed(t, seconds)} s   impact ${impact?.n ?? 0}   θ ${fixed(pose.theta, rest)} rad   x ${fixed(pose.x, rest)} m   y ${fixed(pose.y, rest)} m${contactWords(impact, rest)}`,
    );
    if (!moving || now_ms - this.#read_ms > 2000 || this.#read_ms === -Infinity) {
      this.#box.setAttribute(
        'aria-label',
        `The rod and the table after impact ${impact?.n ?? 0}: tilted by ${fixed(pose.theta, 2)} rad at x = ${fixed(pose.x, 2)} m${contactWords(impact, 3).replace(/ {3}/g, ', ')}`,
      );
    }
    this.#read_ms = now_ms;
  }

  /** Room for the highest point of the rod on this flight; it grows when it must and never shrinks in a run. @param {Scene} scene @param {number} apex */
  #frame(scene, apex) {
    const above = scene.body?.point
      ? 0.03
      : Math.max(
          contactDistance(scene),
          scene.body?.radius_of_gyration ?? Math.max(0, ...(corners(scene) ?? []).map(([x, y]) => Math.hypot(x, y))),
        );
    const wanted = (Math.max(apex, scene.table?.target_height ?? 0) + above) * 1.08;
    if (wanted > this.#top && Number.isFinite(wanted)) this.#top = wanted;
  }

  /** The camera lets the rod wander through the middle third and then goes with it. @param {number} x @param {number} since_s */
  #follow(x, since_s) {
    const free = this.#surface.width / this.#scale().metre / 6;
    const excess = x - this.#camera - Math.max(-free, Math.min(free, x - this.#camera));
    const { phase } = this.#run;
    this.#camera +=
      phase === 'running' && this.#moving && Math.abs(excess) < free * 6 ? excess * Math.min(1, since_s * 6) : excess;
  }

  /** The height that fills the picture; a scene not yet typed has none of its own. */
  get #shown() {
    return this.#top > 0 ? this.#top : 0.3;
  }

  #floor() {
    return this.#surface.height - RULER;
  }

  #scale() {
    const { width, height } = this.#surface;
    // Below the height of the contacts there is room for a tilted table and its foot.
    const depth = Math.max(58, (height - RULER) * 0.2);
    const metre = Math.max(1e-9, (height - RULER - depth - 6) / this.#shown);
    return {
      x: (/** @type {number} */ x) => width / 2 + (x - this.#camera) * metre,
      y: (/** @type {number} */ y) => height - RULER - depth - y * metre,
      metre,
      right: width,
    };
  }

  /** Half the table's width, m. @param {Scene} scene */
  #plate(scene) {
    return Math.min(0.7 * (contactDistance(scene) || 0.12), (this.#surface.width * 0.3) / this.#scale().metre);
  }

  #ground() {
    const { context, width, height } = this.#surface;
    const colours = theme();
    context.clearRect(0, 0, width, height);
    const scale = this.#scale();
    const step = roundStep(width / scale.metre, 8);
    const first = Math.ceil((this.#camera - width / 2 / scale.metre) / step);
    context.lineWidth = 1;
    for (let k = first; scale.x(k * step) < width; k += 1)
      line(
        context,
        colours.faint,
        Math.round(scale.x(k * step)) + 0.5,
        0,
        Math.round(scale.x(k * step)) + 0.5,
        this.#floor(),
      );
    const rung = roundStep(this.#shown, 4);
    for (let k = 0; scale.y(k * rung) > 0; k += 1)
      line(
        context,
        k === 0 ? colours.line : colours.faint,
        0,
        Math.round(scale.y(k * rung)) + 0.5,
        width,
        Math.round(scale.y(k * rung)) + 0.5,
      );
  }

  /** The rulers lie over everything: x moves with the ground, y is the height of the centre of gravity, and a bar gives the scale. */
  #rulers() {
    const { context, width, height } = this.#surface;
    const colours = theme();
    const scale = this.#scale();
    const floor = this.#floor();
    context.fillStyle = colours.surface;
    context.fillRect(0, floor, width, height - floor);
    context.lineWidth = 1;
    line(context, colours.line, 0, floor + 0.5, width, floor + 0.5);
    context.font = `11px ${SANS}`;
    context.fillStyle = colours.muted;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    const step = roundStep(width / scale.metre, Math.max(3, width / 90));
    for (let k = Math.ceil((this.#camera - width / 2 / scale.metre) / step); scale.x(k * step) < width; k += 1) {
      const x = Math.round(scale.x(k * step)) + 0.5;
      if (x < 56 || x > width - 16) continue;
      line(context, colours.muted, x, floor, x, floor + 4);
      context.fillText(number(k * step), x, floor + 7);
    }
    context.textAlign = 'left';
    context.fillText('x / m', 6, floor + 7);
    context.textBaseline = 'bottom';
    const rung = roundStep(this.#shown, 4);
    for (let k = 0; scale.y(k * rung) > 14; k += 1)
      context.fillText(k === 0 ? '0\u202fm' : number(k * rung), 6, scale.y(k * rung) - 2);
    this.#scaleBar(scale.metre);
  }

  /** The height the table steers for, and the gravity of the plane. @param {import('./bodies.js').Scale} scale @param {Scene} scene */
  #wanted(scale, scene) {
    const { context, width } = this.#surface;
    const colours = theme();
    const { energy_gain: gain, target_height: height } = scene.table ?? {};
    context.font = `11px ${SANS}`;
    context.textAlign = 'left';
    context.textBaseline = 'top';
    context.fillStyle = colours.muted;
    const incline = scene.incline ?? Math.PI / 2;
    const tilted = Math.abs(incline - Math.PI / 2) > 1e-9;
    context.fillText(
      `${tilted ? `plane at ${number((incline * 180) / Math.PI)}°, ` : ''}G = ${number(effectiveGravity(scene))}\u202fm/s²`,
      44,
      10,
    );
    if (!gain || !height) return;
    const y = Math.round(scale.y(height)) + 0.5;
    context.setLineDash([5, 4]);
    context.lineWidth = 1;
    line(context, colours.good, 0, y, width, y);
    context.setLineDash([]);
    context.fillStyle = colours.good;
    context.textAlign = 'right';
    context.textBaseline = 'bottom';
    context.fillText(`target y* = ${number(height)}\u202fm`, width - 8, y - 2);
  }

  /** @param {number} metre px */
  #scaleBar(metre) {
    const { context, width } = this.#surface;
    const colours = theme();
    const length = roundStep(100 / metre, 1);
    const right = width - 14;
    const left = right - length * metre;
    context.lineWidth = 2;
    line(context, colours.ink, left, 20, right, 20);
    line(context, colours.ink, left, 16, left, 24);
    line(context, colours.ink, right, 16, right, 24);
    context.font = `11px ${SANS}`;
    context.fillStyle = colours.ink;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    context.fillText(
      length < 0.1 ? `${number(length * 100)}\u202fcm` : `${number(length)}\u202fm`,
      (left + right) / 2,
      26,
    );
  }

  /** The way of the centre of gravity on the last flights. @param {import('./bodies.js').Scale} scale @param {Scene} scene @param {number | null} place @param {number} t */
  #trail(scale, scene, place, t) {
    const { context } = this.#surface;
    const { impacts } = this.#run;
    context.strokeStyle = theme().accent;
    context.lineWidth = 1.5;
    for (let back = 0; back <= TRAIL_FLIGHTS; back += 1) {
      const at = place === null ? -1 - back : place - back;
      if (at < impacts.begin - 1 || at < -1) break;
      const arc = at < impacts.begin ? this.#run.arcAt(-1) : arcAfterPlace(this.#run, at, scene);
      if (!arc) break;
      const end = Math.min(t, arc.t + arc.duration);
      context.globalAlpha = 0.5 * (1 - back / (TRAIL_FLIGHTS + 1));
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

/** @param {Run} run @param {number} place @param {Scene} scene */
const arcAfterPlace = (run, place, scene) => run.arcAt(run.impacts.at('t', place)) ?? poseless(scene);

/** @param {Scene} scene @returns {Arc} */
const poseless = (scene) => ({
  t: 0,
  x: 0,
  y: contactDistance(scene),
  theta: 0,
  x_dot: 0,
  y_dot: 0,
  theta_dot: 0,
  duration: 0,
});

/** @param {import('../run/impacts.js').Impact | null} impact @param {Scene} scene @returns {Strike | null} */
function strikeOf(impact, scene) {
  if (!impact) return null;
  const theta = contactDistance(scene) === 0 ? 0 : impact.theta;
  return {
    t: impact.t,
    x: impact.x + contactDistance(scene) * Math.sin(theta),
    y: impact.clearance || 0,
    alpha: impact.alpha,
    speed: Number.isNaN(impact.table_speed) ? 0 : impact.table_speed,
  };
}

/** What the newest contact was like, where there is more to it than a strike at y = 0. @param {import('../run/impacts.js').Impact | null} impact @param {number} decimals */
function contactWords(impact, decimals) {
  if (!impact) return '';
  const mode = MODES[impact.mode] ?? 'frictionless';
  return (
    (mode === 'frictionless' ? '' : `   contact: ${mode.replace('_', ' ')}`) +
    (impact.clearance ? `   struck at ${fixed(impact.clearance, decimals)} m` : '')
  );
}
