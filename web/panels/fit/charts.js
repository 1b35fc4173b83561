// Charts of measured bounces as SVG, read by pointer and keys: their residuals, the bounces over those of a run, and the convergence of a fit.

import { roundRange } from '../../charts/axes.js';
import { readColumns } from '../../charts/readable/server-figure.js';
import { svg } from '../../charts/svg.js';
import { fixed, number, quantity as worded, ticks } from '../../dom/numbers.js';
import { angles, shownUnit } from '../../dom/units.js';
import { html, useMemo, useState } from '../../vendor/preact/preact.js';
import { useAnswer } from '../ask.js';
import { Chart } from '../figures.js';
import { matchByNumber, matchByTime } from '../measured/match.js';
import { COMPARED, QUANTITIES, nameOf, shownOf } from '../measured/read.js';
import WORDS from './words.json' with { type: 'json' };
import { Choice, Folded, NumberField, Row, Table } from '../parts.js';

/** @import { Column, Compared, Measured, Reading } from '../measured/read.js' */
/** @import { Match, Simulated } from '../measured/match.js' */
/** @typedef {(value: number) => number} Scale px of a value */
/** A strip on the screen, with the ticks of the axis along. @typedef {{x: Scale, y: Scale, left: number, right: number, top: number, bottom: number, along: number[]}} Area */

/**
 * @typedef {object} Strip
 * @property {string} name
 * @property {number} height px
 * @property {Interval} range
 * @property {number[]} ticks
 * @property {number} [zero] the tick with a stronger line
 * @property {number} [band] half the width of a band around 0
 * @property {boolean} [log]
 * @property {(area: Area) => Element[]} marks
 */

/** Room around the strips and between them, px. */
const [LEFT, RIGHT, TOP, BETWEEN, BELOW] = [58, 12, 24, 20, 34];

/**
 * @param {HTMLElement} box
 * @param {object} what
 * @param {Interval} what.along
 * @param {string} what.name of the axis along
 * @param {boolean} [what.whole] its ticks are whole numbers
 * @param {Strip[]} what.strips
 * @param {number[]} what.items places along that can be read
 * @param {(item: number) => string} what.words
 */
function plot(box, { along, name, whole = false, strips, items, words }) {
  const { width } = box.getBoundingClientRect();
  box.replaceChildren();
  if (width < 120 || strips.length === 0) return null;
  const [left, right] = [LEFT, width - RIGHT];
  const x = (/** @type {number} */ at) => left + ((at - along.low) / (along.high - along.low)) * (right - left);
  const across = ticks(along, Math.max(2, Math.floor((right - left) / 75))).filter(
    (at) => !whole || Number.isInteger(at),
  );
  const panel = { 'data-panel': '', 'data-x': `${along.low} ${along.high}` };
  /** @type {Element[]} */
  const parts = [];
  let top = TOP;
  for (const { name: said, height, range, ticks: up, zero, band = 0, log, marks } of strips) {
    const scale = log ? Math.log : Number;
    const [low, high] = [scale(range.low), scale(range.high)];
    const bottom = top + height;
    const y = (/** @type {number} */ value) => bottom - ((scale(value) - low) / (high - low)) * height;
    if (band > 0)
      parts.push(svg('rect', { class: 'band', x: left, y: y(band), width: right - left, height: y(-band) - y(band) }));
    for (const value of up)
      parts.push(
        svg('path', { class: value === zero ? 'zero' : 'grid', d: `M${left} ${y(value).toFixed(1)}H${right}` }),
        svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, number(value, 3)),
      );
    parts.push(
      svg('rect', { class: 'edge', x: left, y: top, width: right - left, height, ...panel }),
      svg('text', { class: 'name', x: 2, y: top - 7 }, said),
      ...marks({ x, y, left, right, top, bottom, along: across }),
    );
    top = bottom + BETWEEN;
  }
  const bottom = top - BETWEEN;
  const height = bottom + BELOW;
  parts.push(
    ...across.map((at) => svg('text', { x: x(at), y: bottom + 15, 'text-anchor': 'middle' }, number(at, 7))),
    svg('text', { class: 'name', x: right, y: height - 3, 'text-anchor': 'end' }, name),
  );
  const size = { viewBox: `0 0 ${width} ${height}`, width, height };
  const figure = /** @type {SVGSVGElement} */ (svg('svg', { ...size, 'aria-hidden': 'true' }, ...parts));
  box.replaceChildren(figure);
  return readColumns(figure, items, words);
}

/** A way through places, and nothing without any. @param {string[]} places as `x y` */
const way = (places) => (places.length > 0 ? `M${places.join('L')}` : '');

// Residuals over the number of the bounce: measured less computed, a strip for each quantity.

/** Residuals of a bounce in SI units, NaN where one is not there; `outlier` has a value that was left out. @typedef {{n: number, line: number | undefined, outlier?: boolean} & Record<Column, number>} Residual */

/** Heights of a strip of residuals, of the lane of bounces without a pair, of the picture over a run, and of the convergence, px. */
const [STRIP, LANE, OVER, CONVERGENCE] = [62, 14, 152, 114];
/** Half bands beyond which a value of a bounce with an outlier is that outlier. */
const FAR = 1.5;

/** @param {Residual[]} rows @param {Column} quantity @param {number} half of the band, in SI units @returns {Strip} */
function stripOf(rows, quantity, half) {
  const band = shownOf(quantity, half);
  const known = rows
    .filter((one) => Number.isFinite(one[quantity]))
    .map(({ n, outlier, [quantity]: value }) => ({ n, outlier, value: shownOf(quantity, value) }));
  const isFar = (/** @type {typeof known[number]} */ { outlier, value }) => outlier && Math.abs(value) > FAR * band;
  const told = known.filter((one) => !isFar(one));
  const most = Math.max(band, ...told.map(({ value }) => Math.abs(value)));
  const range = roundRange({ low: -most, high: most }, { symmetric: true, span: most === 0 ? 2 : 0 });
  /** @type {Strip['marks']} */
  const marks = ({ x, y, top, bottom, along }) => {
    const places = told.map(({ n, value }) => `${x(n).toFixed(1)} ${y(value).toFixed(1)}`);
    return [
      ...along.map((n) => svg('path', { class: 'grid', d: `M${x(n).toFixed(1)} ${top}V${bottom}` })),
      svg('path', { class: 'way', d: way(places) }),
      svg('path', { class: 'dots', d: places.map((place) => `M${place}h0`).join('') }),
      // They would leave no room for the others, so that they stand at the edge.
      ...known.filter(isFar).map(({ n, value }) => {
        const edge = Math.max(range.low, Math.min(range.high, value));
        return svg('circle', { class: 'far', cx: x(n), cy: y(edge), r: 4 });
      }),
    ];
  };
  return { name: `δ${nameOf(quantity)}`, height: STRIP, range, ticks: ticks(range, 2), zero: 0, band, marks };
}

/** A strip of bounces without a pair. @param {Interval} along @param {number[]} missed @param {number[]} extra @returns {Strip} */
const unpairedStrip = (along, missed, extra) => ({
  name: 'missed ○, extra ×',
  height: LANE,
  range: { low: 0, high: 1 },
  ticks: [],
  marks: ({ x, y }) => {
    const shaped = (/** @type {number[]} */ numbers, /** @type {string} */ shape) => {
      const seen = numbers.filter((n) => n >= along.low && n <= along.high);
      return svg('path', { class: 'unpaired', d: seen.map((n) => `M${x(n).toFixed(1)} ${y(0.5)}${shape}`).join('') });
    };
    return [shaped(missed, 'm-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0'), shaped(extra, 'm-4 -4l8 8m0 -8l-8 8')];
  },
});

/**
 * @param {object} props
 * @param {string} props.name the beginning of its ids
 * @param {string} props.label for those who do not see it
 * @param {string} [props.hint]
 * @param {Residual[]} props.rows
 * @param {Column[]} props.quantities that there are
 * @param {Partial<Record<Column, number>>} [props.bands] half the width of a band around 0
 * @param {number[]} [props.missed] numbers of bounces that were not measured
 * @param {number[]} [props.extra] those at which there are measured ones too many
 */
export function Residuals({ name, label, hint = '', rows, quantities, bands = {}, missed = [], extra = [] }) {
  const [low, last] = [rows[0]?.n ?? 0, rows.at(-1)?.n ?? 0];
  const along = { low, high: Math.max(low + 1, last) };
  const words = (/** @type {number} */ item) => {
    const { n, line, outlier, ...values } = rows[item];
    const told = quantities
      .filter((one) => Number.isFinite(values[one]))
      .map((one) => `δ${QUANTITIES[one].symbol} ${worded(values[one], QUANTITIES[one].unit, 3)}`);
    const place = [`n ${number(n, 7)}`, line && `line ${number(line, 7)}`];
    return [...place, ...told, outlier && 'a value left out'].filter(Boolean).join('   ');
  };
  const draw = (/** @type {HTMLElement} */ box) => {
    const strips = quantities.map((one) => stripOf(rows, one, bands[one] ?? 0));
    if (missed.length + extra.length > 0) strips.push(unpairedStrip(along, missed, extra));
    return plot(box, { along, name: 'bounce', whole: true, strips, items: rows.map(({ n }) => n), words });
  };
  return html`<${Chart} name=${name} label=${label} draw=${draw} inputs=${[rows, angles()]}
    hint=${`${hint}With keys: left and right go from bounce to bounce.`} />`;
}

// Measured bounces over those of the run of the rig's values, and how far the two are apart.

/** A run with the pairs of its bounces and the measured ones. @typedef {{simulated: Simulated, match: Match}} Found */
/** A value at a time on the clock of the run. @typedef {{t: number, value: number}} Place */

/** Bounces that are simulated for each measured one, at least and at most. */
const [EACH, LEAST, MOST] = [4, 200, 10_000];
/** Numbers and lines that are named one by one; more are counted. */
const NAMED = 8;
/** More rows than these are no reading. */
const LISTED = 500;

/** A count with its noun. @param {number} count @param {string} noun */
const counted = (count, noun) => `${number(count, 7)} ${noun}${count === 1 ? '' : 's'}`;

/** The first of them. @param {number[]} all */
const listed = (all) =>
  all
    .slice(0, NAMED)
    .map((one) => number(one, 7))
    .join(', ') + (all.length > NAMED ? ' …' : '');

/** The offset of two clocks: in ms, unless one of them counts from long ago. @param {number} offset s */
const clocks = (offset) =>
  Math.abs(offset) < 100 ? `${fixed(Math.abs(offset) * 1e3, 1)}\u202fms` : `${fixed(Math.abs(offset), 3)}\u202fs`;

/** The bounces of a run in columns, to be matched. @param {Trajectory['impacts']} impacts @returns {Simulated | null} */
function simulatedOf(impacts) {
  const column = (/** @type {string} */ name) =>
    impacts.t.map((_, index) => Number(/** @type {Record<string, any>} */ (impacts)[name]?.[index] ?? NaN));
  const columns = Object.fromEntries(['n', ...COMPARED].map((name) => [name, column(name)]));
  if (impacts.t.length === 0) return null;
  const flight = column('flight_time').findLast((one) => one > 0) ?? columns.t[0];
  return /** @type {Simulated} */ ({ ...columns, flight });
}

/** How the bounces are paired, in sentences. @param {Reading} reading @param {Found} found @param {boolean} byTime */
function matchWords({ impacts: rows, lines }, { simulated, match }, byTime) {
  const { pairs, missed, extra, later, offset, alike } = match;
  if (pairs.length === 0) return 'None of them is in the run of these values.';
  if (missed.length + extra.length > pairs.length)
    return 'The run of these values is another one: values or release differ from those of the rig. The fit below needs no release.';
  const clock = Number.isNaN(offset)
    ? ''
    : `: the measured clock is ${clocks(offset)} ${offset < 0 ? 'behind' : 'ahead of'} the simulated one`;
  const unpaired = [
    missed.length > 0 &&
      `${counted(missed.length, 'bounce')} missed (n = ${listed(missed.map((place) => simulated.n[place]))})`,
    extra.length > 0 && `${counted(extra.length, 'row')} extra (line ${listed(extra.map((row) => lines[row]))})`,
  ].filter(Boolean);
  const untimed = byTime ? rows.filter(({ t }) => Number.isNaN(t)).length : 0;
  return [
    pairs.length === rows.length - untimed
      ? `All ${counted(pairs.length, 'bounce')} are in the run.`
      : `${number(pairs.length, 7)} of ${counted(rows.length, 'measured bounce')} are in the run.`,
    untimed > 0 && `${counted(untimed, 'row')} without t left out.`,
    `Matched by ${byTime ? 'time' : 'number'}${clock}.`,
    `${unpaired.join(', ') || 'None missed, none extra'}.`,
    alike && later.length === 0 && 'Other offsets fit about as well, so the numbers of the bounces decide.',
  ]
    .filter(Boolean)
    .join(' ');
}

/**
 * Draws a quantity of both over time.
 * @param {HTMLElement} box
 * @param {{rows: Measured[], curve: Place[], offset: number, quantity: Compared, of: string}} what `of` is what the curve is
 */
function drawOver(box, { rows, curve, offset, quantity, of }) {
  const seen = rows
    .map((one) => ({ n: one.n, t: one.t - offset, value: shownOf(quantity, one[quantity]) }))
    .filter(({ t, value }) => Number.isFinite(t) && Number.isFinite(value));
  const [first, last] = [Math.min(...seen.map(({ t }) => t)), Math.max(...seen.map(({ t }) => t))];
  const room = (last - first || 1) * 0.04;
  const along = { low: first - room, high: last + room };
  const run = curve
    .map(({ t, value }) => ({ t, value: shownOf(quantity, value) }))
    .filter(({ t, value }) => t >= along.low && t <= along.high && Number.isFinite(value));
  const values = [...seen, ...run].map(({ value }) => value);
  const most = Math.max(...values.map(Math.abs), 1e-9) * 1.1;
  const range = { low: Math.min(...values) < 0 ? -most : 0, high: Math.max(...values) > 0 ? most : 0 };
  const { symbol, unit } = QUANTITIES[quantity];
  /** @type {Strip['marks']} */
  const marks = ({ x, y, right, top }) => {
    const at = (/** @type {Place} */ { t, value }) => `${x(t).toFixed(1)} ${y(value).toFixed(1)}`;
    return [
      svg('path', { class: 'run', d: way(run.map(at)) }),
      svg('path', { class: 'run-dots', d: run.map((one) => `M${at(one)}h0`).join('') }),
      svg('path', { class: 'diamonds', d: seen.map((one) => `M${at(one)}m0 -5l5 5l-5 5l-5 -5z`).join('') }),
      svg('path', { class: 'diamonds', d: `M${right - 178} ${top - 16}l5 5l-5 5l-5 -5z` }),
      svg('text', { x: right - 168, y: top - 7 }, 'measured'),
      svg('path', { class: 'run-dots', d: `M${right - 92} ${top - 11}h0` }),
      svg('text', { x: right - 84, y: top - 7 }, of),
    ];
  };
  return plot(box, {
    along,
    name: 't / s',
    strips: [{ name: nameOf(quantity), height: OVER, range, ticks: ticks(range, 4), zero: 0, marks }],
    items: seen.map(({ t }) => t),
    words: (item) =>
      `bounce ${number(seen[item].n, 7)}   t ${fixed(seen[item].t, 3)} s   ${symbol} ${number(seen[item].value)} ${shownUnit(unit)}`,
  });
}

/** The bounces of a fit, as measured less the residuals: each window begins with a first state of its own. @param {import('contract').Fit} fit @param {Measured[]} rows @param {Compared} quantity @returns {Place[]} */
const fittedOf = ({ residuals: { row, ...residuals } }, rows, quantity) =>
  row.map((place, index) => ({
    t: rows[place - 1].t - (residuals.t[index] ?? 0),
    value: rows[place - 1][quantity] - (quantity === 't' ? 0 : (residuals[quantity][index] ?? NaN)),
  }));

/** @param {{page: PanelPage, reading: Reading, fit: import('contract').Fit | null}} props `fit` whose values are in use */
export function Overlay({ page, reading, fit }) {
  const [by, matchBy] = useState('time');
  const [first, begin] = useState(/** @type {number | null} */ (null));
  const [chosen, choose] = useState('');
  const rows = reading.impacts;
  const bounces = Math.min(MOST, Math.max(LEAST, EACH * rows.length));
  const path = page.query && `v1/trajectories?${page.query}&bounces=${bounces}`;
  const { answer, current } = useAnswer(path, { quiet_ms: 100 });
  const isTimed = rows.some(({ t }) => !Number.isNaN(t));
  const byTime = isTimed && by === 'time';
  /** @type {Found | null} */
  const found = useMemo(() => {
    const simulated = answer ? simulatedOf(answer.impacts) : null;
    if (!simulated) return null;
    const match = byTime ? matchByTime(rows, simulated, first) : matchByNumber(rows, simulated, first ?? rows[0].n);
    return { simulated, match };
  }, [answer, reading, byTime, first]);
  const quantities = COMPARED.filter((one) => one !== 't' && reading.columns.includes(one));
  /** Undefined for times alone. @type {Compared | undefined} */
  const quantity = quantities.find((one) => one === chosen) ?? quantities[0];
  const draw = (/** @type {HTMLElement} */ box) => {
    if (!quantity) return null;
    const { simulated, match } = found ?? {};
    const offset = match && !Number.isNaN(match.offset) ? match.offset : (rows[0].t || 0) - (simulated?.t[0] ?? 0);
    const curve = fit
      ? fittedOf(fit, rows, quantity).map(({ t, value }) => ({ t: t - offset, value }))
      : Array.from(simulated?.t ?? [], (t, index) => ({ t, value: simulated?.[quantity][index] ?? NaN }));
    return drawOver(box, { rows, curve, offset, quantity, of: fit ? 'the fit' : 'these values' });
  };
  // A table of some hundred rows is not made anew at each turn of a knob.
  const apart = useMemo(
    () =>
      found !== null &&
      found.match.pairs.length > 0 &&
      html`<${Apart} found=${found} reading=${reading}>
        <p class="row">
          <label for="measured-by">Match </label>
          <${Choice} id="measured-by" value=${byTime ? 'time' : 'number'} disabled=${!isTimed} choices=${{ time: 'by time', number: 'by number' }} changed=${matchBy} />
          <label for="measured-first">The first measured bounce is n = </label>
          <${NumberField} id="measured-first" value=${first ?? undefined} open
            placeholder=${String(found.simulated.n[found.match.pairs[0][1]])}
            fault=${(/** @type {number} */ value) => (Number.isInteger(value) && value >= 1 ? null : 'It must be a whole number from 1.')}
            changed=${(/** @type {number | undefined} */ value) => begin(value ?? null)} />
        </p>
      <//>`,
    [found, first, angles()],
  );
  return html`<div class=${`overlay ${current ? '' : 'stale'}`} id="overlay">
    <h3>Over the ${fit ? 'fit' : 'run of these values'}</h3>
    ${fit && html`<p>The fit begins with a first state of its own, which is no release of the rig.</p>`}
    <p id="matched">${found ? matchWords(reading, found, byTime) : 'Asking for the run…'}</p>
    ${
      quantities.length > 1 &&
      html`<p><label for="overlay-shown">Show </label><${Choice} id="overlay-shown" value=${quantity} choices=${Object.fromEntries(quantities.map((one) => [one, nameOf(one)]))} changed=${choose} /></p>`
    }
    ${quantity && isTimed && html`<${Chart} name="overlay" label=${`${QUANTITIES[quantity].symbol} of ${counted(rows.length, 'measured bounce')} over that of the ${fit ? 'fit' : 'run'}`} draw=${draw} inputs=${[found, reading, quantity, fit, angles()]} hint="With keys: left and right go from bounce to bounce." />`}
    ${apart}
  </div>`;
}

/** Measured less simulated, bounce by bounce. @param {{found: Found, reading: Reading, children: unknown}} props */
function Apart({ found: { simulated, match }, reading: { impacts, lines }, children }) {
  const { pairs, missed, extra, offset } = match;
  const rows = pairs.map(([row, place]) => {
    const off = COMPARED.map((one) => [one, impacts[row][one] - simulated[one][place] - (one === 't' ? offset : 0)]);
    return { n: simulated.n[place], line: lines[row], ...Object.fromEntries(off) };
  });
  const sums = COMPARED.map((quantity) => {
    const values = rows.map((row) => row[quantity]).filter((one) => !Number.isNaN(one));
    const squares = values.reduce((sum, one) => sum + one ** 2, 0);
    const largest = values.reduce((most, one) => (Math.abs(one) > Math.abs(most) ? one : most), 0);
    return { quantity, count: values.length, rms: Math.sqrt(squares / values.length), largest };
  }).filter(({ count }) => count > 0);
  const spoken = sums
    .map(({ quantity, rms }) => {
      const { symbol, unit } = QUANTITIES[quantity];
      return `${symbol}: RMS ${number(shownOf(quantity, rms))} ${shownUnit(unit)}`;
    })
    .join('; ');
  const cells = (/** @type {(sum: typeof sums[number]) => number} */ of) =>
    sums.map((sum) => number(shownOf(sum.quantity, of(sum)), 3));
  /** An extra one stands half a bounce after the one before it, and nowhere without one. @param {number} row */
  const besides = (row) => simulated.n[pairs.findLast(([one]) => one < row)?.[1] ?? -1] + 0.5;
  return html`<${Folded} title=${`Residuals of the run, bounce by bounce: ${spoken}`}>
    <${Residuals} name="overlay-residuals" label=${`Residuals of ${counted(rows.length, 'bounce')}. ${spoken}`} rows=${rows}
      quantities=${sums.map(({ quantity }) => quantity)} missed=${missed.map((place) => simulated.n[place])} extra=${extra.map(besides)} />
    <${Table} label="Residuals" head=${['bounce', ...sums.map(({ quantity }) => nameOf(quantity))]}>
      <${Row} cells=${['RMS', ...cells(({ rms }) => rms)]} />
      <${Row} cells=${['largest', ...cells(({ largest }) => largest)]} />
      ${rows.slice(0, LISTED).map((row) => html`<${Row} cells=${[number(row.n, 7), ...cells(({ quantity }) => row[quantity])]} />`)}
    <//>
    ${children}
  <//>`;
}

// The convergence of a fit.

/** @typedef {import('contract').FitProgress['progress']} Step */
/** A step with a residual. @typedef {Step & {residual: number}} Point */

/** @type {Record<Step['stage'], string>} */
const STAGES = WORDS.stages;
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
  /** @type {Strip['marks']} */
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
      {
        name: 'residual',
        height: CONVERGENCE,
        range,
        ticks: decades(range.low, range.high),
        zero: 1,
        log: true,
        marks,
      },
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
