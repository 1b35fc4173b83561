// The distance of two runs on one clock, as it grows.

import { line, text } from '../charts/axes.js';
import { CanvasView } from '../charts/surface.js';
import { theme } from '../charts/theme.js';
import { h } from '../dom/elements.js';
import { number, quantity } from '../dom/numbers.js';
import { shownFactor, shownUnit } from '../dom/units.js';

/** @typedef {import('../run/run-state.js').RunState} RunState */

/** Strikes that the curve has room for; those before are left out. */
const STRIKES = 1000;
/** Angles that differ by less are the same, rad. */
const LEAST = 1e-12;

export class Parting extends CanvasView {
  element;
  #run;
  /** @type {{run: RunState, name: string} | null} */
  #other = null;
  #told = h('output', { id: 'drop-told', 'aria-live': 'off' });
  /** Logarithms of the differences of θ at the strikes. */
  #curve = new Float64Array(STRIKES);
  #judged = 0;
  #begun = 0;
  #said_ms = -Infinity;

  /** @param {RunState} run */
  constructor(run) {
    const box = h('div', { class: 'parting', role: 'img', 'aria-label': 'Difference of the angles at the strikes' });
    super(box, 1);
    this.#run = run;
    this.element = h('div', { class: 'drop', hidden: true }, box, this.#told);
  }

  /** @param {RunState | null} other @param {string} [name] */
  show(other, name = '') {
    if (other !== (this.#other?.run ?? null)) this.forget();
    this.#other = other && { run: other, name };
    this.element.hidden = !other;
    this.redraw();
  }

  /** A new run parts anew. */
  forget() {
    this.#judged = 0;
    this.#begun = 0;
    this.redraw();
  }

  #judge() {
    const { impacts } = this.#run;
    const other = this.#other?.run;
    if (!other) return;
    if (impacts.end < this.#judged) this.forget();
    this.#begun = Math.max(this.#begun, impacts.end - STRIKES, impacts.begin);
    for (let place = Math.max(this.#judged, this.#begun); place < impacts.end; place += 1) {
      const there = other.poseAt(impacts.at('t', place));
      const apart = there ? Math.abs(there.theta - impacts.at('theta', place)) : NaN;
      this.#curve[place % STRIKES] = Math.log10(Math.max(LEAST, apart));
      this.stale = true;
    }
    this.#judged = impacts.end;
  }

  /** @override @param {number} now_ms */
  draw(now_ms) {
    if (!this.#other) return false;
    this.#judge();
    const { pace, shown } = this.#run;
    const moves = pace > 0;
    // At once while the run stands still: no other drawing may follow.
    if (!moves || this.stale || now_ms - this.#said_ms > 100) {
      this.#said_ms = now_ms;
      this.#say(shown);
    }
    if (this.stale) this.#paint();
    this.stale = false;
    return moves;
  }

  /** @param {number} t */
  #say(t) {
    const other = /** @type {{run: RunState, name: string}} */ (this.#other);
    const [here, there] = [this.#run.poseAt(t), other.run.poseAt(t)];
    const words =
      here && there
        ? `${other.name} and the run differ by ${quantity(Math.abs(here.theta - there.theta), 'rad', 3)} and are ${number(1000 * Math.hypot(here.x - there.x, here.y - there.y), 3)}\u202fmm apart`
        : `${other.name} waits for the run`;
    if (this.#told.textContent !== words) this.#told.textContent = words;
  }

  #paint() {
    const { context, width, height } = this.layers[0];
    const colours = theme();
    context.clearRect(0, 0, width, height);
    let [low, high] = [Infinity, -Infinity];
    // In the unit that is shown.
    const shift = Math.log10(shownFactor('rad'));
    for (let place = this.#begun; place < this.#judged; place += 1) {
      const value = this.#curve[place % STRIKES] + shift;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (!(high >= low)) return;
    low = Math.floor(low);
    high = Math.max(low + 1, Math.ceil(high));
    const left = 70;
    const look = { colour: colours.muted, baseline: /** @type {const} */ ('middle') };
    const x = (/** @type {number} */ place) =>
      left + ((place - this.#begun) / Math.max(10, this.#judged - this.#begun)) * (width - left - 6);
    const y = (/** @type {number} */ value) => height - 5 - ((value - low) / (high - low)) * (height - 16);
    context.lineWidth = 1;
    for (const value of [low, high]) {
      line(context, colours.faint, left, y(value), width, y(value));
      const words = number(10 ** value);
      text(context, words, left - 6, Math.max(7, y(value)), { ...look, align: 'right' });
    }
    text(context, `|Δθ| / ${shownUnit('rad')}`, left + 4, 7, look);
    context.beginPath();
    for (let place = this.#begun; place < this.#judged; place += 1)
      context.lineTo(x(place), y(this.#curve[place % STRIKES] + shift));
    context.lineWidth = 1.5;
    context.strokeStyle = colours.accent;
    context.stroke();
  }
}
