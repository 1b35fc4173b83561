// Measured bounces over those of the run of the rig's values, and how far the two are apart. What is loaded stays in this page.

import { ticks } from '../../charts/axes.js';
import { onThemeChange } from '../../charts/theme.js';
import { svg } from '../../charts/svg.js';
import { fixed, number } from '../../dom/numbers.js';
import { shownFactor, shownUnit } from '../../dom/units.js';
import { COMPARED, SYMBOLS, numbersOf, residuals, sums } from '../../panels/measured/compare.js';
import { measured } from '../../panels/measured/file.js';
import { matchByNumber, matchByTime } from '../../panels/measured/match.js';
import { drawResiduals } from '../../panels/measured/residual-chart.js';
import { html, useEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { useAnswer } from '../ask.js';
import { NumberField, useRig } from '../parts.js';

/** @typedef {import('../../panels/measured/compare.js').Compared} Compared */
/** @typedef {import('../../panels/measured/match.js').Match} Match */
/** @typedef {import('../../panels/measured/match.js').Simulated} Simulated */
/** @typedef {import('../../panels/measured/read.js').Measured} Measured */

/** Bounces that are simulated for each measured one, at least and at most. */
const [EACH, LEAST, MOST] = [4, 200, 10_000];
/** Numbers and lines that are named one by one; more are counted. */
const NAMED = 8;
/** More rows than these are no reading. */
const LISTED = 500;
/** Size of the picture, px, and room around it. */
const HEIGHT = 210;
const MARGIN = { left: 58, right: 12, top: 24, bottom: 34 };

/** Name and shown unit of a quantity. @param {Compared} quantity */
const nameOf = (quantity) => SYMBOLS[quantity].map(shownUnit).join(' / ');

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
  /** @type {Record<string, any>} */
  const columns = impacts;
  const column = (/** @type {string} */ name) =>
    impacts.t.map((_, index) => {
      const one = columns[name]?.[index] ?? null;
      return one === null ? NaN : Number(one);
    });
  const t = column('t');
  if (t.length === 0) return null;
  const flight = column('flight_time').findLast((one) => one > 0) ?? t[0];
  return {
    n: column('n'),
    t,
    theta: column('theta'),
    x_dot: column('x_dot'),
    y_dot: column('y_dot'),
    theta_dot: column('theta_dot'),
    flight,
  };
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
 * @param {HTMLElement} box @param {Measured[]} rows @param {Simulated | null} simulated @param {number} offset of the measured clock @param {Compared} quantity
 */
function drawOver(box, rows, simulated, offset, quantity) {
  const { width } = box.getBoundingClientRect();
  if (width < 120) return box.replaceChildren();
  const factor = shownFactor(SYMBOLS[quantity][1]);
  const seen = rows.flatMap((one) =>
    Number.isFinite(one.t) && Number.isFinite(one[quantity]) ? [[one.t - offset, one[quantity] * factor]] : [],
  );
  const [first, last] = [Math.min(...seen.map(([t]) => t)), Math.max(...seen.map(([t]) => t))];
  const room = (last - first || 1) * 0.04;
  const along = { low: first - room, high: last + room };
  const run = Array.from(simulated?.t ?? [], (t, index) => [t, (simulated?.[quantity][index] ?? NaN) * factor]).filter(
    ([t, value]) => t >= along.low && t <= along.high && Number.isFinite(value),
  );
  const values = [...seen, ...run].map(([, value]) => value);
  const most = Math.max(...values.map(Math.abs), 1e-9) * 1.1;
  const up = { low: Math.min(...values) < 0 ? -most : 0, high: Math.max(...values) > 0 ? most : 0 };
  const [left, right, bottom] = [MARGIN.left, width - MARGIN.right, HEIGHT - MARGIN.bottom];
  const x = (/** @type {number} */ t) => left + ((t - along.low) / (along.high - along.low)) * (right - left);
  const y = (/** @type {number} */ value) => bottom - ((value - up.low) / (up.high - up.low)) * (bottom - MARGIN.top);
  const at = (/** @type {number[]} */ [t, value]) => `${x(t).toFixed(1)} ${y(value).toFixed(1)}`;
  const parts = [
    ...ticks(up, 4).flatMap((value) => [
      svg('path', { class: value === 0 ? 'zero' : 'grid', d: `M${left} ${y(value).toFixed(1)}H${right}` }),
      svg('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, number(value, 3)),
    ]),
    ...ticks(along, Math.max(2, Math.floor((right - left) / 80))).map((t) =>
      svg('text', { x: x(t), y: bottom + 16, 'text-anchor': 'middle' }, number(t, 4)),
    ),
    svg('rect', { class: 'edge', x: left, y: MARGIN.top, width: right - left, height: bottom - MARGIN.top }),
    svg('path', { class: 'run', d: run.length > 0 ? `M${run.map(at).join('L')}` : '' }),
    svg('path', { class: 'run-dots', d: run.map((one) => `M${at(one)}h0`).join('') }),
    svg('path', { class: 'diamonds', d: seen.map((one) => `M${at(one)}m0 -5l5 5l-5 5l-5 -5z`).join('') }),
    svg('text', { class: 'name', x: 2, y: MARGIN.top - 9 }, nameOf(quantity)),
    svg('text', { class: 'name', x: right, y: HEIGHT - 3, 'text-anchor': 'end' }, 't / s'),
    svg('path', { class: 'diamonds', d: `M${right - 178} ${MARGIN.top - 18}l5 5l-5 5l-5 -5z` }),
    svg('text', { x: right - 168, y: MARGIN.top - 9 }, 'measured'),
    svg('path', { class: 'run-dots', d: `M${right - 92} ${MARGIN.top - 13}h0` }),
    svg('text', { x: right - 84, y: MARGIN.top - 9 }, 'these values'),
  ];
  box.replaceChildren(
    svg('svg', { viewBox: `0 0 ${width} ${HEIGHT}`, width, height: HEIGHT, 'aria-hidden': 'true' }, ...parts),
  );
}

/** A box that is drawn by script, anew with its width. @param {{label: string, draw: (box: HTMLElement) => void}} props */
function Drawn({ label, draw }) {
  const box = useRef(/** @type {HTMLElement | null} */ (null));
  const newest = useRef(draw);
  newest.current = draw;
  useEffect(() => {
    if (box.current) draw(box.current);
  });
  useEffect(() => {
    const again = () => box.current && newest.current(box.current);
    const watch = new ResizeObserver(again);
    if (box.current) watch.observe(box.current);
    onThemeChange(again);
    return () => watch.disconnect();
  }, []);
  return html`<div class="measured-box" role="img" aria-label=${label} ref=${box} />`;
}

/** @param {{rig: import('../rig.js').Rig}} props */
export function Overlay({ rig }) {
  useRig(rig);
  const [file, take] = useState({ reading: measured.reading });
  const [by, matchBy] = useState('time');
  const [first, number_] = useState(/** @type {number | null} */ (null));
  const [shown, show] = useState(/** @type {Compared | null} */ (null));
  useEffect(() => {
    measured.watch((fresh) => {
      if (fresh) number_(null);
      take({ reading: measured.reading });
    });
  }, []);
  const { reading } = file;
  const rows = reading?.impacts ?? [];
  const bounces = Math.min(MOST, Math.max(LEAST, EACH * rows.length));
  const { answer, current } = useAnswer(
    reading && rig.query !== null ? `v1/trajectories?${rig.query}&bounces=${bounces}` : null,
    100,
  );
  const isTimed = rows.some(({ t }) => !Number.isNaN(t));
  const byTime = isTimed && by === 'time';
  const found = useMemo(() => {
    const simulated = answer && rows.length > 0 ? simulatedOf(answer.impacts) : null;
    if (!simulated) return null;
    const match = byTime ? matchByTime(rows, simulated, first) : matchByNumber(rows, simulated, first ?? rows[0].n);
    return {
      simulated,
      match,
      all: residuals(rows, simulated, match),
      numbers: numbersOf(rows, simulated, match, first ?? rows[0].n),
    };
  }, [answer, reading, byTime, first]);
  if (!reading) return null;
  const { simulated = null, match = null, all = [], numbers = [] } = found ?? {};
  const quantities = COMPARED.filter((one) => one !== 't' && reading.columns.includes(one));
  const quantity = shown && quantities.includes(shown) ? shown : quantities[0];
  const factor = (/** @type {Compared} */ one) => shownFactor(SYMBOLS[one][1]);
  const told = sums(all);
  const scaled = all.map((one) => ({
    ...one,
    theta: one.theta * factor('theta'),
    theta_dot: one.theta_dot * factor('theta_dot'),
  }));
  const offset = match && !Number.isNaN(match.offset) ? match.offset : (rows[0].t || 0) - (simulated?.t[0] ?? 0);
  const spoken = told
    .map(
      (one) =>
        `${SYMBOLS[one.quantity][0]}: RMS ${number(one.rms * factor(one.quantity))} ${shownUnit(SYMBOLS[one.quantity][1])}`,
    )
    .join('; ');
  return html`<div class=${`overlay ${current ? '' : 'stale'}`} id="overlay">
    <h3>Over the run of these values</h3>
    <p id="matched">${found ? wordsOf(rows, reading.lines, simulated, match, byTime) : 'Asking for the run…'}</p>
    ${
      quantities.length > 1 &&
      html`<p><label for="overlay-shown">Show </label><select id="overlay-shown" onChange=${(/** @type {Event} */ event) => show(/** @type {Compared} */ (/** @type {HTMLSelectElement} */ (event.currentTarget).value))}>
      ${quantities.map((one) => html`<option value=${one} selected=${one === quantity}>${nameOf(one)}</option>`)}
    </select></p>`
    }
    ${quantity && isTimed && html`<${Drawn} label=${`${SYMBOLS[quantity][0]} of ${counted(rows.length, 'measured bounce')} over that of the run`} draw=${(/** @type {HTMLElement} */ box) => drawOver(box, rows, simulated, offset, quantity)} />`}
    ${
      told.length > 0 &&
      html`<details>
      <summary>Residuals, bounce by bounce: ${spoken}</summary>
      <${Drawn} label=${`Residuals of ${counted(all.length, 'bounce')}. ${spoken}`} draw=${(
        /** @type {HTMLElement} */ box,
      ) =>
        void drawResiduals(
          box,
          scaled,
          told.map((one) => [one.quantity, nameOf(one.quantity)]),
          undefined,
          {
            missed: match?.missed.map((place) => simulated?.n[place] ?? NaN) ?? [],
            extra: match?.extra.map((row) => numbers[row]) ?? [],
          },
        )} />
      <div class="table-box" tabindex="0" role="region" aria-label="Residuals">
        <table><thead><tr><th scope="col">bounce</th>${told.map((one) => html`<th scope="col">${nameOf(one.quantity)}</th>`)}</tr></thead>
          <tbody>
            ${['RMS', 'largest'].map((name) => html`<tr><th scope="row">${name}</th>${told.map((one) => html`<td>${number((name === 'RMS' ? one.rms : one.largest) * factor(one.quantity), 3)}</td>`)}</tr>`)}
            ${scaled.slice(0, LISTED).map((one) => html`<tr><th scope="row">${number(one.n, 7)}</th>${told.map(({ quantity: name }) => html`<td>${number(one[name], 3)}</td>`)}</tr>`)}
          </tbody></table>
      </div>
      <p class="matching">
        <label for="measured-by">Match </label>
        <select id="measured-by" disabled=${!isTimed} onChange=${(/** @type {Event} */ event) => matchBy(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>
          <option value="time">by time</option><option value="number" selected=${!byTime}>by number</option>
        </select>
        <label for="measured-first">The first measured bounce is n = </label>
        <${NumberField} id="measured-first" label="Number of the first measured bounce" unit="" value=${first ?? undefined}
          placeholder=${String(numbers[match?.extra.includes(0) ? (match.pairs[0]?.[0] ?? 0) : 0] ?? '')}
          fault=${(/** @type {number} */ value) => (Number.isInteger(value) && value >= 1 ? null : 'It must be a whole number from 1.')}
          changed=${(/** @type {number | undefined} */ value) => number_(value ?? null)} />
      </p>
    </details>`
    }
  </div>`;
}
