// The run as numbers: its newest impacts in a table to copy, and the demand on the table as the server computes it for the run up to now.
// Both follow the run while they are in sight.

import { get } from '../../api/client.js';
import { copy } from '../../dom/clipboard.js';
import { byId, h } from '../../dom/elements.js';
import { fixed, fixedIn, number } from '../../dom/numbers.js';
import { UNITS } from '../../dom/units.js';
import { html, render } from '../../vendor/preact/preact.js';
import { Table } from '../parts.js';
import { Loads } from '../figures.js';

/** Rows are added at most so often, ms. */
const PACE_MS = 250;
/** Rows that are kept. */
const LISTED = 200;
/** While a run goes on, its demand is asked for anew after so much more of it, and not sooner than, ms. */
const GROWTH = 1.5;
const DEMAND_PACE_MS = 2000;
/** Impacts that it is asked for at most: the answer has them all. */
const MOST = 20_000;

/** Columns with their names, and units where they have one that changes. @type {[column: import('../../run/impacts.js').Column, name: string, unit?: string][]} */
const COLUMNS = [
  ['n', 'n'],
  ['t', 't / s', 's'],
  ['x', 'x / m', 'm'],
  ['theta', 'θ / rad', 'rad'],
  ['x_dot', 'ẋ / m s⁻¹', 'm/s'],
  ['y_dot', 'ẏ / m s⁻¹', 'm/s'],
  ['theta_dot', 'θ̇ / rad s⁻¹', 'rad/s'],
  ['alpha', 'α / rad', 'rad'],
  ['table_speed', 'table / m s⁻¹', 'm/s'],
  ['contact_velocity', 'contact / m s⁻¹', 'm/s'],
  ['flight_time', 'flight / s', 's'],
  ['energy', 'E/m / J kg⁻¹', 'J/kg'],
];
const HEAD = COLUMNS.map(([, name]) => name);

/**
 * @param {object} parts
 * @param {import('../../run/run.js').Run} parts.run
 * @param {() => URLSearchParams | null} parts.query of the run with what was done to it
 * @param {() => string | null} parts.csv the call that gives all impacts as CSV
 */
export function bringImpacts({ run, query, csv }) {
  const { impacts } = run;
  const root = h('div', { class: 'run-numbers' });
  byId('impacts-bar').after(root);
  /** Rows of the newest impacts, the newest first. @type {unknown[]} */
  let rows = [];
  /** Place of the newest row; none before the first. */
  let newest = -1;
  /** @type {import('../figures.js').Demand | null} */
  let demand = null;
  /** The request that the demand answers, and the impacts in it. */
  let answered = { query: '', impacts: 0 };
  let asked_ms = -Infinity;
  /** @type {AbortController | null} */
  let request = null;
  let seen = false;
  let waiting = false;

  const oldest = () => Math.max(impacts.begin, impacts.end - LISTED);
  /** @param {number} place */
  const rowOf = (place) => html`<tr key=${place}>
    ${COLUMNS.map(([column, , unit]) => {
      const value = impacts.at(column, place);
      return html`<td>${unit ? fixedIn(value, unit, 4) : fixed(value, 0)}</td>`;
    })}
  </tr>`;

  /** Copies the rows, in SI units with all digits, parted by tabs as spreadsheets take them. @param {{currentTarget: HTMLElement}} event */
  const copyRows = ({ currentTarget }) => {
    const lines = [HEAD.join('\t')];
    for (let place = impacts.end - 1; place >= oldest(); place -= 1) {
      const values = COLUMNS.map(([column]) => impacts.at(column, place));
      lines.push(values.map((value) => (Number.isFinite(value) ? String(value) : '')).join('\t'));
    }
    void copy(currentTarget, lines.join('\n'));
  };
  const save = () => {
    const href = csv();
    if (href) h('a', { href, download: 'equipoise-impacts.csv' }).click();
  };

  const draw = () => {
    const { end } = impacts;
    const none = end === 0;
    const kept = end - oldest();
    const told = kept < end ? `The last ${kept} of ${fixed(end, 0)} impacts.` : '';
    // A strike that a limit forbids is not among the impacts.
    const refused = run.outcome?.kind === 'beyond_limits' && run.outcome.quantity ? run.outcome : null;
    const values = { ...demand, ...(refused && { [String(refused.quantity)]: refused.value }) };
    render(
      html`<section class="card" id="impacts" aria-labelledby="impacts-title">
          <div class="card-head">
            <h2 id="impacts-title">Bounces of this run</h2>
            <button type="button" id="impacts-copy" disabled=${none} onClick=${copyRows}>Copy rows</button>
            <button type="button" id="impacts-csv" disabled=${none} onClick=${save}>Save all as CSV</button>
          </div>
          <${Table} label="Impacts of this run, the newest first" head=${HEAD} children=${rows} />
          <p id="impacts-told" class="muted small">${none ? 'A run writes its bounces here.' : told}</p>
        </section>
        <section class="card" id="demand" aria-labelledby="demand-title">
          <div class="card-head"><h2 id="demand-title">Demand on the table</h2></div>
          <div class="demand">
            <${Loads} label="Largest values and limits" values=${values} limits=${run.asked?.table?.limits ?? {}} />
            <p id="demand-told" class="muted small">${demand && `Up to bounce ${number(answered.impacts, 8)}.`}</p>
          </div>
        </section>`,
      root,
    );
  };

  const clearRows = () => {
    rows = [];
    newest = -1;
  };
  const fill = () => {
    waiting = false;
    if (!seen) return;
    const { end } = impacts;
    if (end - 1 < newest) clearRows();
    const added = [];
    for (let place = end - 1; place > newest && place >= oldest(); place -= 1) added.push(rowOf(place));
    rows = [...added, ...rows].slice(0, LISTED);
    newest = end - 1;
    draw();
    if (follow(performance.now())) soon();
  };
  const soon = () => {
    if (!waiting) setTimeout(fill, PACE_MS);
    waiting = true;
  };

  /** Asks for the demand where it is behind the run. @param {number} now_ms @returns {boolean} true while it is behind */
  const follow = (now_ms) => {
    const wanted = { query: String(query() ?? ''), impacts: Math.min(MOST, impacts.last?.n ?? 0) };
    if (wanted.impacts === 0 || wanted.query === '') return false;
    const same = wanted.query === answered.query;
    if (same && wanted.impacts === answered.impacts) return false;
    const early = same && run.phase === 'running' && wanted.impacts < GROWTH * answered.impacts;
    if (early || request || now_ms - asked_ms < DEMAND_PACE_MS) return true;
    asked_ms = now_ms;
    void ask(wanted);
    return true;
  };
  /** @param {typeof answered} wanted */
  const ask = async (wanted) => {
    const own = new AbortController();
    request = own;
    const path = `v1/trajectories?${wanted.query}&bounces=${wanted.impacts}`;
    const answer = await get(path, own.signal).catch(() => null);
    if (request !== own) return;
    request = null;
    if (own.signal.aborted || !answer) return;
    demand = answer.demand;
    answered = wanted;
    draw();
  };

  draw();
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    if (seen) fill();
  }).observe(byId('impacts'));
  run.watch({
    changed: soon,
    struck: soon,
    cleared: () => {
      clearRows();
      request?.abort();
      request = null;
      demand = null;
      answered = { query: '', impacts: 0 };
      asked_ms = -Infinity;
      soon();
    },
  });
  document.addEventListener(UNITS, () => {
    clearRows();
    fill();
  });
}
