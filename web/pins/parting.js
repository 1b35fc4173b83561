// The distance of two runs on one clock, as it grows.

import { CanvasView } from '../charts/surface.js';
import { h } from '../dom/elements.js';
import { number, quantity } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';

/** Strikes that the curve has room for; those before are left out. */
const STRIKES = 1000;
/** Angles that differ by less are the same, rad. */
const LEAST = 1e-12;
/** Room for the numbers of the axis, px. */
const LEFT = 70;
/** Least time between two writings of a distance that changes, ms. */
const WRITTEN_MS = 100;

export class Parting extends CanvasView {
  #run;
  /** @type {{run: RunState, name: string} | null} */
  #other = null;
  #told = h('output', { id: 'drop-told', 'aria-live': 'off' });
  /** Logarithms of the differences of θ at the strikes, and the ends of what is in them. */
  #curve = new Float64Array(STRIKES);
  #begin = 0;
  #end = 0;
  #said_ms = -Infinity;

  /** @param {RunState} run */
  constructor(run) {
    const box = h('div', { class: 'parting', role: 'img', 'aria-label': 'Difference of the angles at the strikes' });
    super(box, 1);
    this.#run = run;
    this.element = h('div', { class: 'drop', hidden: true }, box, this.#told);
    const redraw = () => this.redraw();
    run.watch({ changed: redraw, struck: redraw, moved: redraw, cleared: () => this.#forget() });
  }

  /** @param {RunState | null} other @param {string} [name] */
  show(other, name = '') {
    if (other !== (this.#other?.run ?? null)) this.#forget();
    this.#other = other && { run: other, name };
    this.element.hidden = !other;
    this.redraw();
  }

  /** A new run parts anew. */
  #forget() {
    this.#begin = 0;
    this.#end = 0;
    this.redraw();
  }

  /** Takes in the strikes that are new. @param {RunState} other */
  #extend(other) {
    const { impacts } = this.#run;
    if (impacts.end < this.#end) this.#forget();
    this.#begin = Math.max(this.#begin, impacts.end - STRIKES, impacts.begin);
    for (let place = Math.max(this.#end, this.#begin); place < impacts.end; place += 1) {
      const there = other.poseAt(impacts.at('t', place));
      const apart = there ? Math.abs(there.theta - impacts.at('theta', place)) : NaN;
      this.#curve[place % STRIKES] = Math.log10(Math.max(LEAST, apart));
    }
    this.#end = impacts.end;
  }

  /** @override @param {number} now_ms */
  draw(now_ms) {
    if (!this.#other) return false;
    const { pace } = this.#run;
    const stale = this.takeStale();
    this.#extend(this.#other.run);
    // At once while the run stands still: no other drawing may follow.
    if (pace === 0 || stale || now_ms - this.#said_ms > WRITTEN_MS) {
      this.#said_ms = now_ms;
      const words = this.#wordsOf(this.#other);
      if (this.#told.textContent !== words) this.#told.textContent = words;
    }
    if (stale) this.#paint();
    return pace > 0;
  }

  /** @param {{run: RunState, name: string}} other */
  #wordsOf({ run, name }) {
    const t = this.#run.shown;
    const [here, there] = [this.#run.poseAt(t), run.poseAt(t)];
    if (!here || !there) return `${name} waits for the run`;
    const [angle, apart] = [Math.abs(here.theta - there.theta), Math.hypot(here.x - there.x, here.y - there.y)];
    return `${name} and the run differ by ${quantity(angle, 'rad', 3)} and are ${number(1000 * apart, 3)}\u202fmm apart`;
  }

  #paint() {
    const [surface] = this.layers;
    const { context, width, height } = surface;
    surface.clear();
    // In the unit that is shown.
    const shift = Math.log10(shownFactor('rad'));
    const points = Array.from({ length: this.#end - this.#begin }, (_, index) => ({
      index,
      value: this.#curve[(this.#begin + index) % STRIKES] + shift,
    })).filter(({ value }) => !Number.isNaN(value));
    if (points.length === 0) return;
    const values = points.map(({ value }) => value);
    const low = Math.floor(Math.min(...values));
    const high = Math.max(low + 1, Math.ceil(Math.max(...values)));
    const x = (/** @type {number} */ index) =>
      LEFT + (index / Math.max(10, this.#end - this.#begin)) * (width - LEFT - 6);
    const y = (/** @type {number} */ value) => height - 5 - ((value - low) / (high - low)) * (height - 16);
    const look = /** @type {const} */ ({ colour: 'muted', baseline: 'middle' });
    for (const value of [low, high]) {
      surface.line('faint', LEFT, y(value), width, y(value));
      surface.text(number(10 ** value), LEFT - 6, Math.max(7, y(value)), { ...look, align: 'right' });
    }
    surface.text(`|Δθ| / ${shownUnit('rad')}`, LEFT + 4, 7, look);
    context.beginPath();
    for (const { index, value } of points) context.lineTo(x(index), y(value));
    surface.stroke('accent', { width: 1.5 });
  }
}
