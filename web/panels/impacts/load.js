// The run as numbers: its newest impacts in a table to copy, and the demand on the table as the server computes it for the run up to now.
// Both follow the run while they are in sight.

import { saveCsv } from '../../app/late/share.js';
import { copy } from '../../dom/clipboard.js';
import { paced } from '../../dom/debounce.js';
import { byId, h } from '../../dom/elements.js';
import { fixed, fixedIn, number } from '../../dom/numbers.js';
import { UNITS, angles } from '../../dom/units.js';
import { html, render, useEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { QUANTITIES, quantityOf } from '../../run/quantities.js';
import { useAnswer } from '../ask.js';
import { Loads } from '../figures.js';
import { Table, useNear } from '../parts.js';

/** Rows are added at most so often, ms. */
const PACE_MS = 250;
/** Rows that are kept. */
const LISTED = 200;
/** While a run goes on, its demand is asked for anew after so much more of it. */
const GROWTH = 1.5;
/** Impacts that it is asked for at most: the answer has them all. */
const MOST = 20_000;

const COLUMNS = /** @type {Column[]} */ (['n', ...Object.keys(QUANTITIES)]);
const HEAD = COLUMNS.map((column) => (column === 'n' ? 'n' : quantityOf(column).name));

/** @param {Page} page */
export function bringImpacts(page) {
  const root = h('div', { class: 'run-numbers' });
  byId('impacts-bar').after(root);
  render(html`<${RunNumbers} page=${page} />`, root);
}

/** The demand on the table, as far as the run has come. @param {Page} page @param {boolean} near */
function useDemand({ run, playedQuery }, near) {
  const asked = useRef({ query: '', n: 0 });
  const n = Math.min(MOST, run.impacts.last?.n ?? 0);
  const of = String(playedQuery ?? '');
  const before = asked.current;
  const early = run.phase === 'running' && of === before.query && n >= before.n && n < GROWTH * before.n;
  if (near && !early) asked.current = { query: of, n };
  const path = `v1/trajectories?${asked.current.query}&bounces=`;
  const answered = useAnswer(of && asked.current.n > 0 ? path + asked.current.n : null);
  /** @type {Trajectory | null} */
  const answer = answered.of?.startsWith(path) ? answered.answer : null;
  // That of a run before this one may be further.
  return answer && answer.impacts.n.length <= n ? answer : null;
}

/** An impact, drawn anew only where it has changed. @param {{values: number[]}} props in the order of the columns */
const ImpactRow = ({ values }) =>
  useMemo(() => {
    const cells = values.map((value, index) => fixedIn(value, quantityOf(COLUMNS[index]).unit, index === 0 ? 0 : 4));
    return html`<tr>${cells.map((cell) => html`<td>${cell}</td>`)}</tr>`;
  }, [...values, angles()]);

/** @param {{page: Page}} props */
function RunNumbers({ page }) {
  const { run } = page;
  const { impacts } = run;
  const [place, near] = useNear();
  const [, again] = useState({});
  const seen = useRef(near);
  seen.current = near;
  useEffect(() => {
    const soon = paced(PACE_MS, () => {
      if (seen.current) again({});
    });
    run.watch({ changed: soon, struck: soon, cleared: soon });
    document.addEventListener(UNITS, soon);
  }, []);
  const { begin, end } = impacts;
  const count = Math.min(LISTED, end - begin);
  const places = Array.from({ length: count }, (_, index) => end - 1 - index);
  const valuesAt = (/** @type {number} */ at) => COLUMNS.map((column) => impacts.at(column, at));

  /** Copies the rows, in SI units with all digits, parted by tabs as spreadsheets take them. @param {{currentTarget: HTMLElement}} event */
  const copyRows = ({ currentTarget }) => {
    const texts = places.map((at) => valuesAt(at).map((value) => (Number.isFinite(value) ? String(value) : '')));
    void copy(currentTarget, [HEAD, ...texts].map((cells) => cells.join('\t')).join('\n'));
  };
  const answer = useDemand(page, near);
  // A strike that a limit forbids is not among the impacts.
  const refused = run.outcome?.kind === 'beyond_limits' && run.outcome.quantity ? run.outcome : null;
  const values = { ...answer?.demand, ...(refused && { [String(refused.quantity)]: refused.value }) };
  const told = count < end ? `The last ${count} of ${fixed(end, 0)} impacts.` : '';
  return html`<section class="card" id="impacts" aria-labelledby="impacts-title" ref=${place}>
      <div class="card-head">
        <h2 id="impacts-title">Bounces of this run</h2>
        <button type="button" id="impacts-copy" disabled=${end === 0} onClick=${copyRows}>Copy rows</button>
        <button type="button" id="impacts-csv" disabled=${end === 0} onClick=${() => saveCsv(page)}>Save all as CSV</button>
      </div>
      <${Table} label="Impacts of this run, the newest first" head=${HEAD} children=${places.map((at) => html`<${ImpactRow} key=${at} values=${valuesAt(at)} />`)} />
      <p id="impacts-told" class="muted small">${end === 0 ? 'A run writes its bounces here.' : told}</p>
    </section>
    <section class="card" id="demand" aria-labelledby="demand-title">
      <div class="card-head"><h2 id="demand-title">Demand on the table</h2></div>
      <div class="demand">
        <${Loads} label="Largest values and limits" values=${values} limits=${run.asked?.table?.limits ?? {}} />
        <p id="demand-told" class="muted small">${answer && `Up to bounce ${number(answer.impacts.n.length, 8)}.`}</p>
      </div>
    </section>`;
}
