// The tab of the run: its newest impacts as numbers, and the demand on the table. Both follow the run while they are in sight.

import { byId, h } from '../../dom/elements.js';
import { styles } from '../../dom/styles.js';
import { UNITS } from '../../dom/units.js';
import { TableDemand } from './demand.js';
import { ImpactTable } from './table.js';

/** Rows are added at most so often, ms. */
const PACE_MS = 250;

/**
 * @param {object} parts
 * @param {import('../../run/run.js').Run} parts.run
 * @param {() => URLSearchParams | null} parts.query of the run with what was done to it
 * @param {() => string | null} parts.csv the call that gives all impacts as CSV
 */
export async function bringImpacts({ run, query, csv }) {
  await styles('panels/impacts/impacts.css').catch(() => {});
  const rows = new ImpactTable(run.impacts);
  const demand = new TableDemand({ run, query });
  const told = h('p', { id: 'impacts-told', class: 'muted small' });
  const save = () => {
    const href = csv();
    if (href) h('a', { href, download: 'equipoise-impacts.csv' }).click();
  };
  const copies = h('button', { type: 'button', id: 'impacts-copy', click: () => void rows.copy(copies) }, 'Copy rows');
  const saves = h('button', { type: 'button', id: 'impacts-csv', click: save }, 'Save all as CSV');
  const card = h(
    'section',
    { class: 'card', id: 'impacts', 'aria-labelledby': 'impacts-title' },
    h('div', { class: 'card-head' }, h('h2', { id: 'impacts-title' }, 'Bounces of this run'), copies, saves),
    rows.element,
    told,
  );
  const beside = h(
    'section',
    { class: 'card', id: 'demand', 'aria-labelledby': 'demand-title' },
    h('div', { class: 'card-head' }, h('h2', { id: 'demand-title' }, 'Demand on the table')),
    demand.element,
  );
  byId('impacts-bar').after(h('div', { class: 'run-numbers' }, card, beside));

  let seen = false;
  let waiting = false;
  const fill = () => {
    waiting = false;
    if (!seen) return;
    rows.fill();
    for (const button of [copies, saves]) button.disabled = run.impacts.end === 0;
    told.textContent = run.impacts.end === 0 ? 'A run writes its bounces here.' : rows.words;
    if (demand.follow(performance.now())) soon();
  };
  const soon = () => {
    if (!waiting) setTimeout(fill, PACE_MS);
    waiting = true;
  };
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    if (seen) fill();
  }).observe(card);
  run.watch({
    changed: () => {
      demand.retell();
      soon();
    },
    struck: soon,
    cleared: () => {
      rows.clear();
      demand.clear();
      soon();
    },
  });
  document.addEventListener(UNITS, () => {
    rows.clear();
    demand.retell();
    fill();
  });
}
