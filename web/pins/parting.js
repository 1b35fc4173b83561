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

/** @param {RunState} run */
export function bringParting(run) {
  const box = h('div', { class: 'parting', role: 'img', 'aria-label': 'Difference of the angles at the strikes' });
  const told = h('output', { id: 'drop-told', 'aria-live': 'off' });
  const element = h('div', { class: 'drop', hidden: true }, box, told);
  const view = new CanvasView(box, 1);
  /** @type {{run: RunState, name: string} | null} */
  let other = null;
  /** Logarithms of the differences of θ at the strikes, and the ends of what is in them. */
  const curve = new Float64Array(STRIKES);
  let begin = 0;
  let end = 0;
  let said_ms = -Infinity;

  /** A new run parts anew. */
  const forget = () => {
    begin = 0;
    end = 0;
    view.redraw();
  };

  /** Takes in the strikes that are new. @param {RunState} there */
  const extend = (there) => {
    const { impacts } = run;
    if (impacts.end < end) forget();
    begin = Math.max(begin, impacts.end - STRIKES, impacts.begin);
    for (let place = Math.max(end, begin); place < impacts.end; place += 1) {
      const pose = there.poseAt(impacts.at('t', place));
      const apart = pose ? Math.abs(pose.theta - impacts.at('theta', place)) : NaN;
      curve[place % STRIKES] = Math.log10(Math.max(LEAST, apart));
    }
    end = impacts.end;
  };

  /** @param {NonNullable<typeof other>} of */
  const wordsOf = ({ run: there, name }) => {
    const [one, two] = [run.poseAt(run.shown), there.poseAt(run.shown)];
    if (!one || !two) return `${name} waits for the run`;
    const [angle, apart] = [Math.abs(one.theta - two.theta), Math.hypot(one.x - two.x, one.y - two.y)];
    return `${name} and the run differ by ${quantity(angle, 'rad', 3)} and are ${number(1000 * apart, 3)}\u202fmm apart`;
  };

  const paint = () => {
    const [surface] = view.layers;
    const { context, width, height } = surface;
    surface.clear();
    // In the unit that is shown.
    const shift = Math.log10(shownFactor('rad'));
    const points = Array.from({ length: end - begin }, (_, index) => ({
      index,
      value: curve[(begin + index) % STRIKES] + shift,
    })).filter(({ value }) => !Number.isNaN(value));
    if (points.length === 0) return;
    const values = points.map(({ value }) => value);
    const low = Math.floor(Math.min(...values));
    const high = Math.max(low + 1, Math.ceil(Math.max(...values)));
    const x = (/** @type {number} */ index) => LEFT + (index / Math.max(10, end - begin)) * (width - LEFT - 6);
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
  };

  view.draw = (now_ms) => {
    if (!other) return false;
    const stale = view.takeStale();
    extend(other.run);
    // At once while the run stands still: no other drawing may follow.
    if (run.pace === 0 || stale || now_ms - said_ms > WRITTEN_MS) {
      said_ms = now_ms;
      const words = wordsOf(other);
      if (told.textContent !== words) told.textContent = words;
    }
    if (stale) paint();
    return run.pace > 0;
  };

  const redraw = () => view.redraw();
  run.watch({ changed: redraw, struck: redraw, moved: redraw, cleared: forget });
  return {
    element,
    /** @param {RunState | null} there @param {string} [name] */
    show: (there, name = '') => {
      if (there !== (other?.run ?? null)) forget();
      other = there && { run: there, name };
      element.hidden = !there;
      view.redraw();
    },
  };
}
