// The bar over a run's time: drag it, or step along it by keys. Strikes are ticks while there are few; kicks, changes and the end are marks.

import { disc, line } from '../charts/axes.js';
import { drawMark } from '../charts/marks.js';
import { CanvasView } from '../charts/surface.js';
import { theme } from '../charts/theme.js';
import { KEY_STEPS } from '../charts/readable/chart-reader.js';
import { h } from '../dom/elements.js';
import { quantity } from '../dom/numbers.js';

/** @typedef {{n: number, t: number, kind: 'kick' | 'set' | 'fell' | 'kept' | 'over', words: string}} Mark */

/** @typedef {{begin: number, end: number, seek: (t: number) => void, step: (strikes: number) => unknown}} Playback the past that is shown */

/** Room at both ends for half the thumb, px. */
const MARGIN = 9;
/** The least distance of ticks, px. */
const APART = 4;
/** A tick that has moved by less is not drawn anew, px. */
const SEEN = 0.5;

export class ScrubBar extends CanvasView {
  /** @type {Mark[]} */
  marks = [];
  /** The time at which another run parts from this one. @type {number | null} */
  fork = null;
  #run;
  #playback;
  /** The drawn ends and the drawn time. */
  #drawn = { begin: 0, end: 0, shown: 0, place: 0 };
  /** The time before a drag, and the end of the bar meanwhile. @type {{past: number | null, end: number} | null} */
  #dragged = null;

  /** @param {import('../run/run-state.js').RunState} run @param {Playback} playback */
  constructor(run, playback) {
    const element = h('div', {
      id: 'scrub',
      class: 'scrub',
      role: 'slider',
      tabindex: 0,
      'aria-label': 'Time of the run',
      'aria-valuenow': 0,
    });
    super(element, 1);
    this.element = element;
    this.#run = run;
    this.#playback = playback;
    this.#listen();
  }

  /** @param {PointerEvent} event */
  #timeAt(event) {
    const { left, width } = this.element.getBoundingClientRect();
    const share = (event.clientX - left - MARGIN) / Math.max(1, width - 2 * MARGIN);
    const { begin, end } = this.#ends();
    // The last pixel is the present, which goes on meanwhile.
    return share >= 1 ? Infinity : begin + Math.max(0, share) * (end - begin);
  }

  #listen() {
    const { element } = this;
    const run = this.#run;
    const playback = this.#playback;
    element.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || !event.isPrimary || !run.scene) return;
      this.#dragged = { past: run.past, end: playback.end };
      element.setPointerCapture(event.pointerId);
      playback.seek(this.#timeAt(event));
    });
    element.addEventListener('pointermove', (event) => {
      if (this.#dragged) playback.seek(this.#timeAt(event));
    });
    element.addEventListener('pointerup', () => {
      this.#dragged = null;
    });
    element.addEventListener('pointercancel', () => {
      // The finger only scrolled past.
      if (this.#dragged) playback.seek(this.#dragged.past ?? Infinity);
      this.#dragged = null;
    });
    element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const strikes = KEY_STEPS[event.key];
      if (strikes === undefined) return;
      playback.step(strikes);
      event.preventDefault();
      event.stopPropagation();
    });
  }

  #ends() {
    const { begin, end } = this.#playback;
    return { begin, end: Math.max(this.#dragged?.end ?? end, begin + 1e-3) };
  }

  /** Draws the bar where something has moved by a visible bit. @override */
  draw() {
    const { begin, end } = this.#ends();
    const { shown, impacts, pace, phase } = this.#run;
    const { width } = this.layers[0];
    const scale = (width - 2 * MARGIN) / (end - begin);
    const before = this.#drawn;
    const moved = Math.max(Math.abs(end - before.end), Math.abs(begin - before.begin), Math.abs(shown - before.shown));
    if (this.stale || before.place !== impacts.end || moved * scale > SEEN) {
      this.#drawn = { begin, end, shown, place: impacts.end };
      this.#paint(begin, (/** @type {number} */ t) => MARGIN + (Math.min(end, t) - begin) * scale);
    }
    return this.seen && (pace > 0 || phase === 'running');
  }

  /** @param {number} begin @param {(t: number) => number} x */
  #paint(begin, x) {
    const { context, width, height } = this.layers[0];
    const colours = theme();
    const { impacts, scene, past, shown } = this.#run;
    const y = Math.round(height / 2);
    this.stale = false;
    context.clearRect(0, 0, width, height);
    context.lineWidth = 4;
    context.lineCap = 'round';
    line(context, colours.line, MARGIN, y, width - MARGIN, y);
    if (!scene) return;
    const at = x(shown);
    line(context, colours.accent, MARGIN, y, at, y);
    context.lineCap = 'butt';
    context.lineWidth = 1;
    if ((impacts.end - impacts.begin) * APART < width) {
      for (let place = impacts.begin; place < impacts.end; place += 1) {
        const tick = Math.round(x(impacts.at('t', place))) + 0.5;
        line(context, colours.muted, tick, y + 4, tick, y + 9);
      }
    }
    if (this.fork !== null && this.fork >= begin) {
      context.lineWidth = 2;
      line(context, colours.measured, x(this.fork), y - 9, x(this.fork), y + 9);
    }
    for (const { t, kind } of this.marks) drawMoment(context, kind, x(t), y - 8);
    const [fill, stroke] = [colours.accent, colours.surface];
    disc(context, at, y, 7, past === null ? { fill, stroke, width: 2.5 } : { fill: stroke, stroke: fill, width: 2.5 });
  }
}

/** Shape and colour of a moment. */
const MOMENTS = /** @type {const} */ ({
  kick: [3, 'strike'],
  set: [1, 'series-1'],
  kept: [0, 'good'],
  over: [0, 'muted'],
});

/** A kick is a triangle, a change a square, a fall a cross, another end a dot. @param {CanvasRenderingContext2D} context @param {Mark['kind']} kind @param {number} x @param {number} y */
function drawMoment(context, kind, x, y) {
  const colours = theme();
  if (kind === 'fell') {
    context.lineWidth = 2.5;
    line(context, colours.strike, x - 4, y + 4, x + 4, y + 12);
    line(context, colours.strike, x - 4, y + 12, x + 4, y + 4);
    return;
  }
  const [mark, colour] = MOMENTS[kind];
  drawMark(context, mark, x, y, 3, colours[colour]);
}

/** @type {Record<string, [string, string]>} */
const VELOCITIES = { theta_dot: ['spin θ̇', 'rad/s'], x_dot: ['ẋ', 'm/s'], y_dot: ['ẏ', 'm/s'] };

/** @param {number} value @param {string} unit */
const signed = (value, unit) => (value > 0 ? '+' : '') + quantity(value, unit);

/**
 * In the order of the run; those of impacts that are not kept are left out.
 * @param {import('../run/run-state.js').RunState} run
 * @param {import('../api/scene-fields.js').Field[]} fields
 * @returns {Mark[]}
 */
export function marksOf(run, fields) {
  const { impacts, interventions, outcome, fate } = run;
  /** @type {Mark[]} */
  const marks = [];
  for (const { impact: n, set, kick, guide } of interventions) {
    const place = impacts.lastUpTo('n', n);
    if (place < impacts.begin || impacts.at('n', place) !== n) continue;
    const t = impacts.at('t', place);
    const kicks = Object.entries(kick).map(([name, by]) => `${signed(by, VELOCITIES[name][1])} ${VELOCITIES[name][0]}`);
    const sets = Object.entries(set).map(([path, value]) => {
      const field = fields.find((one) => one.field === path);
      const shown = typeof value === 'number' ? quantity(value, field?.unit ?? null) : value;
      return `${field?.title.toLowerCase() ?? path} ${shown}`;
    });
    if (kicks.length > 0) marks.push({ n, t, kind: 'kick', words: `kick ${kicks.join(', ')}` });
    const guides = new Set(Object.keys(guide).map((name) => name.split('.')[0]));
    for (const words of guides) marks.push({ n, t, kind: 'set', words });
    if (sets.length > 0) marks.push({ n, t, kind: 'set', words: sets.join(', ') });
  }
  if (outcome && fate) marks.push({ n: outcome.bounces, t: outcome.t, kind: fate, words: 'the end of the run' });
  return marks;
}
