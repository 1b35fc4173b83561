// The convergence of a fit as a chart that is read by pointer and keys.

import { svg } from '../../charts/svg.js';
import { number } from '../../dom/numbers.js';
import { html } from '../../vendor/preact/preact.js';
import { plot, way } from '../measured/plot.js';
import { Chart } from '../figures.js';

/** @typedef {import('contract').FitProgress['progress']} Step */
/** A step with a residual. @typedef {Step & {residual: number}} Point */

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
const HEIGHT = 114;
/** Room above and below the curve, as a factor. */
const ROOM = 2;
/** The least residual that is shown before there are other searches than tries, as a share of the greatest. */
const LOWEST = 1e-4;
/** Room for a name along the axis, px. */
const NAME = 74;

/** The progress in words. @param {Step} step */
export function stepWords({ stage, search, iterations, residual }) {
  const words = stage === 'starts' ? `${STAGES.starts} ${search}` : STAGES[stage];
  const size = residual === null ? [] : [`residual ${number(residual, 3)}`];
  return [words, `iteration ${number(iterations, 7)}`, ...size].join(', ');
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

/** The range of the chart. A try in windows of hardly any impacts follows any data, and would leave no room for the others. @param {Point[]} points */
function rangeOf(points) {
  const sizes = (/** @type {Point[]} */ some) => some.map(({ residual }) => residual);
  const high = Math.max(...sizes(points)) * ROOM;
  const best = sizes(points.filter((point) => !isTry(point)));
  const low = best.length > 0 ? Math.min(...best) : Math.max(high * LOWEST, Math.min(...sizes(points)));
  return { low: low / ROOM, high };
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

/** @param {HTMLElement} box @param {Point[]} points */
function drawConvergence(box, points) {
  const range = rangeOf(points);
  /** @type {import('../measured/plot.js').Strip['marks']} */
  const marks = ({ x, y, right, top, bottom }) => {
    let named = -Infinity;
    const stages = points
      .filter(({ stage }, index) => stage !== points[index - 1]?.stage)
      .flatMap(({ stage, iterations }) => {
        const at = x(iterations);
        const line = svg('path', { class: 'grid', d: `M${at.toFixed(1)} ${top}V${bottom}` });
        if (at - named < NAME || right - at < NAME) return [line];
        named = at;
        return [line, svg('text', { x: at + 3, y: top + 12 }, stage.replace('_', ' '))];
      });
    const curves = searches(points).map((search) => {
      const places = search.map(({ iterations, residual }) => `${x(iterations).toFixed(1)} ${y(residual).toFixed(1)}`);
      return svg('path', { class: isTry(search[0]) ? 'way' : 'best', d: `${way(places)}h0` });
    });
    return [...stages, ...curves];
  };
  return plot(box, {
    along: { low: 0, high: Math.max(1, points[points.length - 1].iterations) },
    name: 'iteration',
    whole: true,
    strips: [
      { name: 'residual', height: HEIGHT, range, ticks: decades(range.low, range.high), zero: 1, log: true, marks },
    ],
    items: points.map(({ iterations }) => iterations),
    words: (index) => stepWords(points[index]),
  });
}

/** The residual by iteration, drawn while the fit goes on and kept after it. @param {{points: Point[], open: boolean}} props */
export function Convergence({ points, open }) {
  const [first, last] = [points[0], points[points.length - 1]];
  const told = first
    ? `residual ${number(first.residual, 3)} at first, ${number(last.residual, 3)} after ${number(last.iterations, 7)} iterations`
    : '';
  return html`<details id="fit-convergence" hidden=${!first} open=${open}>
    <summary>Convergence: ${told}</summary>
    ${
      first &&
      html`<${Chart} name="fit-convergence" label=${`Residual by iteration: ${told}`} draw=${(/** @type {HTMLElement} */ box) => drawConvergence(box, points)} inputs=${[points, points.length]}
        hint="Root mean square of the residuals over their standard deviations; about 1 where those are given and the model explains the data. Thin lines are tries, of the numbering and of other first values; one that goes below the chart has windows too short to say anything. With keys: left and right go from iteration to iteration." />`
    }
  </details>`;
}
