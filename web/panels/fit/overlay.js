// Measured bounces over those of the run of the rig's values, and how far the two are apart. What is loaded stays in this page.

import { ticks } from '../../charts/axes.js';
import { svg } from '../../charts/svg.js';
import { fixed, number } from '../../dom/numbers.js';
import { angles, shownUnit } from '../../dom/units.js';
import { useAnswer } from '../ask.js';
import { COMPARED, QUANTITIES, nameOf, shownOf } from '../measured/quantities.js';
import { matchByNumber, matchByTime } from '../measured/match.js';
import { plot, way } from '../measured/plot.js';
import { Residuals } from '../measured/residuals.js';
import { Chart } from '../figures.js';
import { Choice, Folded, NumberField, Row, Table } from '../parts.js';
import { html, useMemo, useState } from '../../vendor/preact/preact.js';

/** @typedef {import('../measured/quantities.js').Compared} Compared */
/** @typedef {import('../measured/match.js').Match} Match */
/** @typedef {import('../measured/match.js').Simulated} Simulated */
/** @typedef {import('../measured/read.js').Measured} Measured */
/** @typedef {import('../measured/read.js').Reading} Reading */
/** A run with the pairs of its bounces and the measured ones. @typedef {{simulated: Simulated, match: Match}} Found */
/** A value at a time on the clock of the run. @typedef {{t: number, value: number}} Place */

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

/** How the bounces are paired, in sentences. @param {Reading} reading @param {Found} found @param {boolean} byTime */
function wordsOf({ impacts: rows, lines }, { simulated, match }, byTime) {
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
  const [letter, unit] = QUANTITIES[quantity];
  /** @type {import('../measured/plot.js').Strip['marks']} */
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
    strips: [{ name: nameOf(quantity), height: HEIGHT, range, ticks: ticks(range, 4), zero: 0, marks }],
    items: seen.map(({ t }) => t),
    words: (item) =>
      `bounce ${number(seen[item].n, 7)}   t ${fixed(seen[item].t, 3)} s   ${letter} ${number(seen[item].value)} ${shownUnit(unit)}`,
  });
}

/** The bounces of a fit, as measured less the residuals: each window begins with a first state of its own. @param {import('contract').Fit} fit @param {Measured[]} rows @param {Compared} quantity @returns {Place[]} */
const fittedOf = ({ residuals: { row, ...residuals } }, rows, quantity) =>
  row.map((place, index) => ({
    t: rows[place - 1].t - (residuals.t[index] ?? 0),
    value: rows[place - 1][quantity] - (quantity === 't' ? 0 : (residuals[quantity][index] ?? NaN)),
  }));

/** @param {{page: import('../settings.js').Page, reading: Reading, fit: import('contract').Fit | null}} props `fit` whose values are in use */
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
        <p class="matching">
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
    <p id="matched">${found ? wordsOf(reading, found, byTime) : 'Asking for the run…'}</p>
    ${
      quantities.length > 1 &&
      html`<p><label for="overlay-shown">Show </label><${Choice} id="overlay-shown" value=${quantity} choices=${Object.fromEntries(quantities.map((one) => [one, nameOf(one)]))} changed=${choose} /></p>`
    }
    ${quantity && isTimed && html`<${Chart} name="overlay" label=${`${QUANTITIES[quantity][0]} of ${counted(rows.length, 'measured bounce')} over that of the ${fit ? 'fit' : 'run'}`} draw=${draw} inputs=${[found, reading, quantity, fit, angles()]} hint="With keys: left and right go from bounce to bounce." />`}
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
      const [letter, unit] = QUANTITIES[quantity];
      return `${letter}: RMS ${number(shownOf(quantity, rms))} ${shownUnit(unit)}`;
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
