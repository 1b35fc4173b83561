// Residuals of a fit over the impacts, readable by pointer and keys; outliers stand out.

import { ChartReader, movedInRow } from '../../charts/readable/chart-reader.js';
import { svg } from '../../charts/svg.js';
import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { shownFactor, shownUnit } from '../../dom/units.js';
import { SYMBOLS } from '../measured/compare.js';
import { drawResiduals } from '../measured/residual-chart.js';
import { COLUMNS } from './deviations.js';

/** @typedef {import('contract').Fit} Fit */
/** @typedef {import('./deviations.js').Column} Column */

const HINT =
  'The band is two standard deviations wide to each side; rings are values left out. With keys: left and right go from bounce to bounce.';

/** @param {Fit} fit @param {number[]} lines of the file */
export function residualChart({ residuals, sd }, lines) {
  const measured = COLUMNS.filter((column) => sd[column] !== null);
  const factor = (/** @type {Column} */ column) => shownFactor(SYMBOLS[column][1]);
  const rows = residuals.n.map((n, index) => {
    const values = measured.map((column) => [column, (residuals[column][index] ?? NaN) * factor(column)]);
    return /** @type {{n: number} & Record<string, number>} */ ({ n, ...Object.fromEntries(values) });
  });
  const bands = Object.fromEntries(measured.map((column) => [column, 2 * (sd[column] ?? 0) * factor(column)]));
  const outliers = new Set(residuals.n.filter((_, index) => residuals.outlier[index]));
  const label = `Residuals of ${rows.length} bounces: ${measured.map((column) => `${SYMBOLS[column][0]} within about ${quantity(sd[column], SYMBOLS[column][1], 2)}`).join(', ')}; ${outliers.size} with an outlier.`;
  const reader = new ChartReader('fit-residuals', label);
  reader.box.classList.add('measured-box');
  const line = svg('path', { class: 'pointed', hidden: '' });
  /** @type {ReturnType<typeof drawResiduals>} */
  let scale = null;
  /** @type {number | null} */
  let marked = null;
  const mark = (/** @type {number | null} */ item) => {
    marked = item;
    line.toggleAttribute('hidden', item === null || !scale);
    if (item !== null && scale)
      line.setAttribute('d', `M${scale.x(rows[item].n).toFixed(1)} ${scale.top}V${scale.bottom}`);
  };
  const draw = () => {
    scale = drawResiduals(
      reader.box,
      rows,
      measured.map((column) => [column, `δ${SYMBOLS[column].map(shownUnit).join(' / ')}`]),
      { bands, outliers },
    );
    reader.box.firstElementChild?.append(line);
    mark(marked);
  };
  reader.read({
    nearest: ({ clientX }) => {
      if (!scale) return null;
      const x = clientX - reader.box.getBoundingClientRect().left;
      const distance = (/** @type {number} */ index) => Math.abs((scale?.x(rows[index].n) ?? 0) - x);
      return rows.reduce((best, _, index) => (distance(index) < distance(best) ? index : best), 0);
    },
    moved: (key, at) => movedInRow(key, at, 0, rows.length - 1),
    mark,
    words: (index) => {
      const of = measured
        .filter((column) => residuals[column][index] !== null)
        .map((column) => `δ${SYMBOLS[column][0]} ${quantity(residuals[column][index], SYMBOLS[column][1], 3)}`);
      const place = lines[residuals.row[index] - 1];
      const told = [`n ${number(residuals.n[index], 7)}`, place && `line ${number(place, 7)}`, ...of];
      return [...told, residuals.outlier[index] && 'a value left out'].filter(Boolean).join('   ');
    },
  });
  new ResizeObserver(draw).observe(reader.box);
  return h(
    'section',
    { 'aria-labelledby': 'fit-residuals-title' },
    h('h3', { id: 'fit-residuals-title' }, 'Residuals: measured less fitted'),
    reader.box,
    reader.readout,
    reader.spoken,
    h('p', { class: 'muted small', id: 'fit-residuals-hint' }, HINT),
  );
}
