// The bar over a run's time: drag it, or step along it by keys. Strikes are ticks while there are few.

import { line } from '../charts/axes.js';
import { drawMark } from '../charts/marks.js';
import { invalidate, surfaces } from '../charts/surface.js';
import { onThemeChange, theme } from '../charts/theme.js';
import { h } from '../dom/elements.js';

/** @typedef {import('./run-marks.js').Mark} Mark */

/** Room at both ends for half the thumb, px. */
const MARGIN = 9;
/** The least distance of ticks, px. */
const APART = 4;
/** A tick that has moved by less is not drawn anew, px. */
const SEEN = 0.5;
/** Strikes that page up and page down go. */
const LEAP = 10;

export class ScrubBar {
  element = h('div', {
    id: 'scrub',
    class: 'scrub',
    role: 'slider',
    tabindex: 0,
    'aria-label': 'Time of the run',
    'aria-valuenow': 0,
  });
  /** @type {Mark[]} */
  marks = [];
  /** The time at which another run parts from this one. @type {number | null} */
  fork = null;
  #run;
  #playback;
  #surface;
  /** The drawn ends and the drawn time. */
  #drawn = { begin: 0, end: 0, shown: 0, place: 0 };
  #stale = true;
  #seen = true;
  /** The time before a drag, and the end of the bar meanwhile. @type {{past: number | null, end: number} | null} */
  #dragged = null;

  /** @param {import('../run/run-state.js').RunState} run @param {import('./playback.js').Playback} playback */
  constructor(run, playback) {
    this.#run = run;
    this.#playback = playback;
    [this.#surface] = surfaces(this.element, 1, () => this.redraw());
    onThemeChange(() => this.redraw());
    new IntersectionObserver(([entry]) => {
      this.#seen = entry.isIntersecting;
      this.redraw();
    }).observe(this.element);
    this.#listen();
  }

  redraw() {
    this.#stale = true;
    invalidate(this);
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
      const strikes = {
        ArrowRight: 1,
        ArrowUp: 1,
        ArrowLeft: -1,
        ArrowDown: -1,
        PageUp: LEAP,
        PageDown: -LEAP,
      }[event.key];
      if (strikes !== undefined) playback.step(strikes);
      else if (event.key === 'Home') playback.seek(-Infinity);
      else if (event.key === 'End') playback.toNow();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  #ends() {
    const { begin, end } = this.#playback;
    return { begin, end: Math.max(this.#dragged?.end ?? end, begin + 1e-3) };
  }

  /** Draws the bar where something has moved by a visible bit. */
  draw() {
    const { begin, end } = this.#ends();
    const { shown, impacts, pace, phase } = this.#run;
    const { width } = this.#surface;
    const scale = (width - 2 * MARGIN) / (end - begin);
    const before = this.#drawn;
    const moved = Math.max(Math.abs(end - before.end), Math.abs(begin - before.begin), Math.abs(shown - before.shown));
    if (this.#stale || before.place !== impacts.end || moved * scale > SEEN) {
      this.#drawn = { begin, end, shown, place: impacts.end };
      this.#stale = false;
      this.#paint(begin, (/** @type {number} */ t) => MARGIN + (Math.min(end, t) - begin) * scale);
    }
    return this.#seen && (pace > 0 || phase === 'running');
  }

  /** @param {number} begin @param {(t: number) => number} x */
  #paint(begin, x) {
    const { context, width, height } = this.#surface;
    const colours = theme();
    const { impacts, scene, past, shown } = this.#run;
    const y = Math.round(height / 2);
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
    context.beginPath();
    context.arc(at, y, 7, 0, 2 * Math.PI);
    context.fillStyle = past === null ? colours.accent : colours.surface;
    context.fill();
    context.lineWidth = 2.5;
    context.strokeStyle = past === null ? colours.surface : colours.accent;
    context.stroke();
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
  drawMark(context, mark, x, y, 3);
  context.fillStyle = colours[colour];
  context.fill();
}
