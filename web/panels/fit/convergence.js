// The convergence of a fit: the residual by iteration, drawn while the fit goes on and kept after it, readable by pointer and keys.

import { ChartReader, movedInRow } from '../../charts/readable/chart-reader.js';
import { ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';
import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';

/** @typedef {import('contract').FitProgress['progress']} Step */
/** A step with a residual. @typedef {Step & {residual: number}} Point */

/** A fit that is shorter is not shown under way, ms. */
const FLASH_MS = 300;
const MARGIN = { left: 58, right: 12, top: 22, bottom: 34 };
const HEIGHT = 170;
/** Room above and below the curve, as a factor. */
const ROOM = 2;
/** The least residual that is shown before there are other searches than tries, as a share of the greatest. */
const LOWEST = 1e-4;
/** Room for a name along the axis, px. */
const NAME = 74;

/** @type {Record<Step['stage'], string>} */
const STAGES = {
  numbers: 'numbers of the bounces',
  starts: 'start',
  short_windows: 'short windows',
  longer_windows: 'longer windows',
  outliers: 'outliers',
  beside: 'values beside the best',
  verdict: 'verdict',
};

/** @param {Step} step */
const stageWords = ({ stage, search }) => (stage === 'starts' ? `${STAGES.starts} ${search}` : STAGES[stage]);

/** The progress in words. @param {Step} step */
export function stepWords(step) {
  const residual = step.residual === null ? [] : [`residual ${number(step.residual, 3)}`];
  return [stageWords(step), `iteration ${number(step.iterations, 7)}`, ...residual].join(', ');
}

/** The round numbers of a logarithmic axis: powers of ten, with 2 and 5 where they are few. @param {number} low @param {number} high */
function decades(low, high) {
  const [from, to] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const step = Math.max(1, Math.ceil((to - from) / 5));
  const powers = Array.from({ length: to - from + 1 }, (_, k) => 10 ** (from + k));
  const all =
    to - from <= 2 ? powers.flatMap((power) => [power, 2 * power, 5 * power]) : powers.filter((_, k) => k % step === 0);
  return all.filter((value) => value >= low && value <= high);
}

/** @param {Point} point */
const isTry = ({ stage }) => stage === 'numbers' || stage === 'starts';

/**
 * The range of the chart. A try in windows of hardly any impacts follows any data, and would leave no room for the others.
 * @param {Point[]} points
 */
function rangeOf(points) {
  const sizes = (/** @type {Point[]} */ some) => some.map(({ residual }) => residual);
  const high = Math.max(...sizes(points)) * ROOM;
  const best = sizes(points.filter((point) => !isTry(point)));
  const low = best.length > 0 ? Math.min(...best) : Math.max(high * LOWEST, Math.min(...sizes(points)));
  return [low / ROOM, high];
}

export class Convergence {
  #summary = h('summary', {}, 'Convergence');
  #reader = new ChartReader('fit-convergence', 'Convergence');
  #mark = svg('path', { class: 'pointed', hidden: '' });
  element = h(
    'details',
    { id: 'fit-convergence', hidden: true },
    this.#summary,
    this.#reader.box,
    this.#reader.readout,
    this.#reader.spoken,
    h(
      'p',
      { class: 'muted small', id: 'fit-convergence-hint' },
      'Root mean square of the residuals over their standard deviations; about 1 where those are given and the model explains the data. Thin lines are tries, of the numbering and of other first values; one that goes below the chart has windows too short to say anything. With keys: left and right go from iteration to iteration.',
    ),
  );
  /** Points of the newest fit. @type {Point[]} */
  #points = [];
  /** Points of the fit whose answer is shown. @type {Point[]} */
  #kept = [];
  /** @type {((iterations: number) => number) | null} */
  #x = null;
  /** @type {number | null} */
  #at = null;
  #begun_ms = 0;
  #waits = false;

  constructor() {
    this.#reader.box.classList.add('measured-box');
    this.#reader.read({
      nearest: ({ clientX }) => {
        const along = clientX - this.#reader.box.getBoundingClientRect().left;
        const distance = (/** @type {number} */ index) =>
          Math.abs((this.#x?.(this.#points[index].iterations) ?? 0) - along);
        if (!this.#x) return null;
        return this.#points.reduce((best, _, index) => (distance(index) < distance(best) ? index : best), 0);
      },
      moved: (key, at) => movedInRow(key, at, 0, this.#points.length - 1),
      mark: (item) => this.#point(item),
      words: (index) => stepWords(this.#points[index]),
    });
    new ResizeObserver(() => this.#draw()).observe(this.#reader.box);
  }

  /** A fit begins. */
  begin() {
    this.#points = [];
    this.#begun_ms = performance.now();
  }

  /** @param {Step} step of the fit under way */
  hear(step) {
    if (step.residual !== null && step.residual > 0) this.#points.push(/** @type {Point} */ (step));
    if (this.#points.length === 0 || performance.now() - this.#begun_ms < FLASH_MS) return;
    this.element.hidden = false;
    this.element.open = true;
    if (this.#waits) return;
    // Many lines come at once.
    this.#waits = true;
    requestAnimationFrame(() => {
      this.#waits = false;
      this.#draw();
    });
  }

  /** @param {boolean} fitted true if there is an answer; else the curve is that of the answer before, if there was one */
  end(fitted) {
    if (fitted) this.#kept = this.#points;
    this.#points = this.#kept;
    this.#reader.point(null, false);
    this.element.hidden = this.#points.length === 0;
    this.element.open = false;
    this.#draw();
  }

  /** @param {number | null} item */
  #point(item) {
    this.#at = item;
    const point = item === null ? undefined : this.#points[item];
    this.#mark.toggleAttribute('hidden', !point || !this.#x);
    if (point && this.#x)
      this.#mark.setAttribute('d', `M${this.#x(point.iterations).toFixed(1)} ${MARGIN.top}V${HEIGHT - MARGIN.bottom}`);
  }

  #draw() {
    const points = this.#points;
    const { box } = this.#reader;
    const { width } = box.getBoundingClientRect();
    this.#x = null;
    if (points.length === 0 || width < 120) {
      box.replaceChildren();
      return;
    }
    const [first, last] = [points[0], points[points.length - 1]];
    const told = `residual ${number(first.residual, 3)} at first, ${number(last.residual, 3)} after ${number(last.iterations, 7)} iterations`;
    this.#summary.textContent = `Convergence: ${told}`;
    box.setAttribute('aria-label', `Residual by iteration: ${told}`);
    const [left, right, bottom] = [MARGIN.left, width - MARGIN.right, HEIGHT - MARGIN.bottom];
    const most = Math.max(1, last.iterations);
    const x = (/** @type {number} */ iterations) => left + (iterations / most) * (right - left);
    const [low, high] = rangeOf(points);
    const y = (/** @type {number} */ residual) =>
      bottom - (Math.log(Math.max(residual, low) / low) / Math.log(high / low)) * (bottom - MARGIN.top);
    /** @type {Element[]} */
    const parts = [];
    for (const value of decades(low, high))
      parts.push(
        svg('path', { class: value === 1 ? 'zero' : 'grid', d: `M${left} ${y(value).toFixed(1)}H${right}` }),
        svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, number(value, 2)),
      );
    for (const n of ticks({ low: 0, high: most }, Math.max(2, Math.floor((right - left) / 70))).filter(
      Number.isInteger,
    ))
      parts.push(svg('text', { x: x(n), y: bottom + 15, 'text-anchor': 'middle' }, number(n, 7)));
    let named = -Infinity;
    for (const [index, point] of points.entries()) {
      const at = x(point.iterations);
      if (index > 0 && points[index - 1].stage === point.stage) continue;
      parts.push(svg('path', { class: 'grid', d: `M${at.toFixed(1)} ${MARGIN.top}V${bottom}` }));
      if (at - named < NAME || right - at < NAME) continue;
      named = at;
      parts.push(svg('text', { x: at + 3, y: MARGIN.top + 11 }, point.stage.replace('_', ' ')));
    }
    parts.push(
      svg('rect', { class: 'edge', x: left, y: MARGIN.top, width: right - left, height: bottom - MARGIN.top }),
      ...searches(points).map((search) =>
        svg('path', {
          class: isTry(search[0]) ? 'way' : 'best',
          d: `M${search.map(({ iterations, residual }) => `${x(iterations).toFixed(1)} ${y(residual).toFixed(1)}`).join('L')}h0`,
        }),
      ),
      svg('text', { class: 'name', x: 2, y: MARGIN.top - 8 }, 'residual'),
      svg('text', { class: 'name', x: right, y: HEIGHT - 3, 'text-anchor': 'end' }, 'iteration'),
      this.#mark,
    );
    box.replaceChildren(
      svg('svg', { viewBox: `0 0 ${width} ${HEIGHT}`, width, height: HEIGHT, 'aria-hidden': 'true' }, ...parts),
    );
    this.#x = x;
    this.#point(this.#at);
  }
}

/** The points of each search. @param {Point[]} points */
function searches(points) {
  /** @type {Point[][]} */
  const found = [];
  for (const [index, point] of points.entries()) {
    const before = points[index - 1];
    if (before && before.stage === point.stage && before.search === point.search) found[found.length - 1].push(point);
    else found.push([point]);
  }
  return found;
}
