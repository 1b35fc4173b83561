// Measured bounces over those of the run of the rig's values, and how far the two are apart. What is loaded stays in this page.

import { ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';
import { fixed, number } from '../../dom/numbers.js';
import { angles, shownFactor, shownUnit } from '../../dom/units.js';
import { useAnswer } from '../ask.js';
import { numbersOf, residuals, sums } from '../measured/compare.js';
import { COMPARED, QUANTITIES, nameOf } from '../measured/quantities.js';
import { matchByNumber, matchByTime } from '../measured/match.js';
import { plot, residualStrips, way } from '../measured/plot.js';
import { Chart } from '../figures.js';
import { Choice, Folded, NumberField, Row, Table } from '../parts.js';
import { html, useMemo, useState } from '../../vendor/preact/preact.js';

/** @typedef {import('../measured/quantities.js').Compared} Compared */
/** @typedef {import('../measured/match.js').Match} Match */
/** @typedef {import('../measured/match.js').Simulated} Simulated */
/** @typedef {import('../measured/read.js').Measured} Measured */
/** A curve as times on the measured clock with values. @typedef {[t: number, value: number][]} Curve */

/** Bounces that are simulated for each measured one, at least and at most. */
const [EACH, LEAST, MOST] = [4, 200, 10_000];
/** Numbers and lines that are named one by one; more are counted. */
const NAMED = 8;
/** More rows than these are no reading. */
const LISTED = 500;
/** Height of the picture, px. */
const HEIGHT = 152;

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

/** The bounces of a run in columns, to be matched. @param {import('contract').Trajectory['impacts']} impacts @returns {Simulated | null} */
function simulatedOf(impacts) {
  const column = (/** @type {string} */ name) =>
    impacts.t.map((_, index) => Number(/** @type {Record<string, any>} */ (impacts)[name]?.[index] ?? NaN));
  const columns = Object.fromEntries(['n', ...COMPARED].map((name) => [name, column(name)]));
  if (impacts.t.length === 0) return null;
  const flight = column('flight_time').findLast((one) => one > 0) ?? columns.t[0];
  return /** @type {Simulated} */ ({ ...columns, flight });
}

/** How the bounces are paired, in sentences. @param {Measured[]} rows @param {number[]} lines @param {Simulated | null} simulated @param {Match | null} match @param {boolean} byTime */
function wordsOf(rows, lines, simulated, match, byTime) {
  if (!simulated || !match || match.pairs.length === 0) return 'None of them is in the run of these values.';
  const { pairs, missed, extra, later, offset, alike } = match;
  const clock = Number.isNaN(offset)
    ? ''
    : `: the measured clock is ${clocks(offset)} ${offset < 0 ? 'behind' : 'ahead of'} the simulated one`;
  const unpaired = [
    missed.length > 0 &&
      `${counted(missed.length, 'bounce')} missed (n = ${listed(missed.map((place) => simulated.n[place]))})`,
    extra.length > 0 && `${counted(extra.length, 'row')} extra (line ${listed(extra.map((row) => lines[row]))})`,
  ].filter(Boolean);
  if (missed.length + extra.length > pairs.length)
    return 'The run of these values is another one: values or release differ from those of the rig. The fit below needs no release.';
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
 * @param {{rows: Measured[], curve: Curve, offset: number, quantity: Compared, of: string}} what `curve` on the clock of the run, `of` what it is
 */
function drawOver(box, { rows, curve, offset, quantity, of }) {
  const factor = shownFactor(QUANTITIES[quantity][1]);
  const seen = rows
    .filter((one) => Number.isFinite(one.t) && Number.isFinite(one[quantity]))
    .map((one) => ({ n: one.n, t: one.t - offset, value: one[quantity] * factor }));
  const [first, last] = [Math.min(...seen.map(({ t }) => t)), Math.max(...seen.map(({ t }) => t))];
  const room = (last - first || 1) * 0.04;
  const along = { low: first - room, high: last + room };
  const run = curve
    .map(([t, value]) => ({ t, value: value * factor }))
    .filter(({ t, value }) => t >= along.low && t <= along.high && Number.isFinite(value));
  const values = [...seen, ...run].map(({ value }) => value);
  const most = Math.max(...values.map(Math.abs), 1e-9) * 1.1;
  const range = { low: Math.min(...values) < 0 ? -most : 0, high: Math.max(...values) > 0 ? most : 0 };
  const [letter, unit] = QUANTITIES[quantity];
  return plot(box, {
    along,
    name: 't / s',
    strips: [
      {
        name: nameOf(quantity),
        height: HEIGHT,
        range,
        ticks: ticks(range, 4),
        zero: 0,
        marks: ({ x, y, right, top }) => {
          const at = (/** @type {{t: number, value: number}} */ { t, value }) =>
            `${x(t).toFixed(1)} ${y(value).toFixed(1)}`;
          return [
            svg('path', { class: 'run', d: way(run.map(at)) }),
            svg('path', { class: 'run-dots', d: run.map((one) => `M${at(one)}h0`).join('') }),
            svg('path', { class: 'diamonds', d: seen.map((one) => `M${at(one)}m0 -5l5 5l-5 5l-5 -5z`).join('') }),
            svg('path', { class: 'diamonds', d: `M${right - 178} ${top - 16}l5 5l-5 5l-5 -5z` }),
            svg('text', { x: right - 168, y: top - 7 }, 'measured'),
            svg('path', { class: 'run-dots', d: `M${right - 92} ${top - 11}h0` }),
            svg('text', { x: right - 84, y: top - 7 }, of),
          ];
        },
      },
    ],
    items: seen.map(({ t }) => t),
    words: (item) =>
      `bounce ${number(seen[item].n, 7)}   t ${fixed(seen[item].t, 3)} s   ${letter} ${number(seen[item].value)} ${shownUnit(unit)}`,
  });
}

/** The bounces of a fit, as measured less the residuals: each window begins with a first state of its own. @param {import('contract').Fit} fit @param {Measured[]} rows @param {Compared} quantity @returns {Curve} */
const fittedOf = ({ residuals: { row, t, ...others } }, rows, quantity) =>
  row.map((place, index) => [
    rows[place - 1].t - (t[index] ?? 0),
    rows[place - 1][quantity] - (quantity === 't' ? 0 : (others[quantity][index] ?? NaN)),
  ]);

/** @param {{page: import('../settings.js').Page, reading: import('../measured/read.js').Reading, fit: import('contract').Fit | null}} props `fit` whose values are in use */
export function Overlay({ page, reading, fit }) {
  const [by, matchBy] = useState('time');
  const [first, begin] = useState(/** @type {number | null} */ (null));
  const [chosen, choose] = useState('');
  const rows = reading.impacts;
  const bounces = Math.min(MOST, Math.max(LEAST, EACH * rows.length));
  const path = page.query && `v1/trajectories?${page.query}&bounces=${bounces}`;
  const { answer, current } = useAnswer(path, 100);
  const isTimed = rows.some(({ t }) => !Number.isNaN(t));
  const byTime = isTimed && by === 'time';
  const found = useMemo(() => {
    const simulated = answer ? simulatedOf(answer.impacts) : null;
    if (!simulated) return null;
    const match = byTime ? matchByTime(rows, simulated, first) : matchByNumber(rows, simulated, first ?? rows[0].n);
    const numbers = numbersOf(rows, simulated, match, first ?? rows[0].n);
    return { simulated, match, all: residuals(rows, simulated, match), numbers };
  }, [answer, reading, byTime, first]);
  const { simulated = null, match = null, numbers = [] } = found ?? {};
  const quantities = COMPARED.filter((one) => one !== 't' && reading.columns.includes(one));
  /** Undefined for times alone. @type {Compared | undefined} */
  const quantity = quantities.find((one) => one === chosen) ?? quantities[0];
  const offset = match && !Number.isNaN(match.offset) ? match.offset : (rows[0].t || 0) - (simulated?.t[0] ?? 0);
  /** @param {Compared} of @returns {Curve} */
  const curveOf = (of) =>
    fit
      ? fittedOf(fit, rows, of).map(([t, value]) => [t - offset, value])
      : Array.from(simulated?.t ?? [], (t, index) => [t, simulated?.[of][index] ?? NaN]);
  const draw = (/** @type {HTMLElement} */ box) =>
    quantity
      ? drawOver(box, { rows, curve: curveOf(quantity), offset, quantity, of: fit ? 'the fit' : 'these values' })
      : null;
  const counts = counted(rows.length, 'measured bounce');
  // A table of some hundred rows is not made anew at each turn of a knob.
  const apart = useMemo(
    () =>
      found !== null &&
      found.all.length > 0 &&
      html`<${Residuals} found=${found}>
        <p class="matching">
          <label for="measured-by">Match </label>
          <${Choice} id="measured-by" value=${byTime ? 'time' : 'number'} disabled=${!isTimed} choices=${{ time: 'by time', number: 'by number' }} changed=${matchBy} />
          <label for="measured-first">The first measured bounce is n = </label>
          <${NumberField} id="measured-first" value=${first ?? undefined} open
            placeholder=${String(numbers[match?.extra.includes(0) ? (match.pairs[0]?.[0] ?? 0) : 0] ?? '')}
            fault=${(/** @type {number} */ value) => (Number.isInteger(value) && value >= 1 ? null : 'It must be a whole number from 1.')}
            changed=${(/** @type {number | undefined} */ value) => begin(value ?? null)} />
        </p>
      <//>`,
    [found, first, angles()],
  );
  return html`<div class=${`overlay ${current ? '' : 'stale'}`} id="overlay">
    <h3>Over the ${fit ? 'fit' : 'run of these values'}</h3>
    ${fit && html`<p>The fit begins with a first state of its own, which is no release of the rig.</p>`}
    <p id="matched">${found ? wordsOf(rows, reading.lines, simulated, match, byTime) : 'Asking for the run…'}</p>
    ${
      quantities.length > 1 &&
      html`<p><label for="overlay-shown">Show </label><${Choice} id="overlay-shown" value=${quantity} choices=${Object.fromEntries(quantities.map((one) => [one, nameOf(one)]))} changed=${choose} /></p>`
    }
    ${quantity && isTimed && html`<${Chart} name="overlay" label=${`${QUANTITIES[quantity][0]} of ${counts} over that of the ${fit ? 'fit' : 'run'}`} draw=${draw} inputs=${[found, reading, quantity, fit, angles()]} hint="With keys: left and right go from bounce to bounce." />`}
    ${apart}
  </div>`;
}

/**
 * Measured less simulated, bounce by bounce.
 * @param {{found: {simulated: Simulated, match: Match, all: import('../measured/compare.js').Residual[], numbers: number[]}, children: unknown}} props
 */
function Residuals({ found: { simulated, match, all, numbers }, children }) {
  const factor = (/** @type {Compared} */ one) => shownFactor(QUANTITIES[one][1]);
  const told = sums(all);
  const rows = all.map((one) => ({
    ...one,
    theta: one.theta * factor('theta'),
    theta_dot: one.theta_dot * factor('theta_dot'),
  }));
  const spoken = told
    .map(
      ({ quantity, rms }) =>
        `${QUANTITIES[quantity][0]}: RMS ${number(rms * factor(quantity))} ${shownUnit(QUANTITIES[quantity][1])}`,
    )
    .join('; ');
  const strips = residualStrips({
    rows,
    quantities: told.map(({ quantity }) => [quantity, nameOf(quantity)]),
    missed: match.missed.map((place) => simulated.n[place]),
    extra: match.extra.map((row) => numbers[row]),
  });
  const words = (/** @type {number} */ item) =>
    [
      `n ${number(rows[item].n, 7)}`,
      ...told.map(({ quantity }) => `${nameOf(quantity)} ${number(rows[item][quantity], 3)}`),
    ].join('   ');
  const sumCells = told.map(({ quantity, rms, largest }) =>
    [rms, largest].map((one) => number(one * factor(quantity), 3)),
  );
  return html`<${Folded} title=${`Residuals of the run, bounce by bounce: ${spoken}`}>
    <${Chart} name="overlay-residuals" label=${`Residuals of ${counted(all.length, 'bounce')}. ${spoken}`} draw=${(/** @type {HTMLElement} */ box) => plot(box, { ...strips, words })} inputs=${[all, angles()]} hint="With keys: left and right go from bounce to bounce." />
    <${Table} label="Residuals" head=${['bounce', ...told.map(({ quantity }) => nameOf(quantity))]}>
      <${Row} cells=${['RMS', ...sumCells.map(([rms]) => rms)]} />
      <${Row} cells=${['largest', ...sumCells.map(([, largest]) => largest)]} />
      ${rows.slice(0, LISTED).map((one) => html`<${Row} cells=${[number(one.n, 7), ...told.map(({ quantity }) => number(one[quantity], 3))]} />`)}
    <//>
    ${children}
  <//>`;
}
