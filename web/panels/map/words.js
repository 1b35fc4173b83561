// A map in words: its fields, a cell, the whole of it, and a table of some of its cells.

import { CLASSES } from './classes.js';
import { QUANTITIES, isOfCatches } from './settings.js';
import { endedAs, reasonOf } from '../verdict/plain-words.js';
import { h } from '../../dom/elements.js';
import { number, quantity as withUnit, unitAfter } from '../../dom/numbers.js';
import { shownFactor } from '../../dom/units.js';
import { row, table } from '../../dom/tables.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {{column: number, row: number}} Cell */

/** Cells of the table across and upwards. */
const SAMPLED = { columns: 7, rows: 7 };

export class MapWords {
  #fields;

  /** @param {Field[]} fields */
  constructor(fields) {
    this.#fields = fields;
  }

  /** @param {string} path */
  field(path) {
    return this.#fields.find((field) => field.field === path);
  }

  /** @param {string} path */
  title(path) {
    return this.field(path)?.title.toLowerCase() ?? path;
  }

  /** A symbol that can be printed in one line, else the title. @param {string} path */
  symbol(path) {
    const symbol = this.field(path)?.symbol;
    return symbol && !symbol.includes('_') ? symbol : this.title(path);
  }

  /** Names of the axes, in SI units. @param {Settings} settings */
  axes({ x, y }) {
    const [across, upwards] = [x, y].map(({ parameter }) => {
      const unit = this.field(parameter)?.unit;
      const symbol = this.symbol(parameter);
      const title = this.title(parameter);
      return `${symbol === title ? title : `${title} ${symbol}`}${unit && unit !== '1' ? ` / ${unit}` : ''}`;
    });
    return { x: across, y: upwards };
  }

  /** A value of a field in the digits that a cell of the map is wide. @param {Side} side @param {number} value @param {number} count of cells */
  rounded({ parameter, from, to }, value, count) {
    const unit = this.field(parameter)?.unit ?? '';
    const factor = shownFactor(unit);
    const decimals = Math.min(15, Math.max(0, Math.ceil(-Math.log10(((to - from) * factor) / (count - 1)))));
    return number(Number((value * factor).toFixed(decimals)), 15) + unitAfter(unit);
  }

  /** @param {Grid} grid @param {Cell} cell */
  place(grid, { column, row: upwards }) {
    const { x, y } = grid.settings;
    return [
      `${this.symbol(x.parameter)} ${this.rounded(x, grid.x(column), grid.columns)}`,
      `${this.symbol(y.parameter)} ${this.rounded(y, grid.y(upwards), grid.rows)}`,
    ];
  }

  /** The value of a cell. @param {Grid} grid @param {Cell} cell @returns {string[]} */
  value(grid, { column, row: upwards }) {
    const { quantity, impacts } = grid.settings;
    const value = grid.value(column, upwards);
    const outcome = grid.outcome(column, upwards);
    const kind = grid.classOf(outcome);
    if (isOfCatches(quantity) && outcome !== 'none')
      return [
        ...(quantity === 'caught' ? [] : [atRest(value)]),
        CLASSES[kind].name,
        ...(kind === 'lies' ? [] : [reasonOf(outcome)]),
      ];
    if (isOfCatches(quantity)) return ['no such scene'];
    if (Number.isNaN(value)) return [QUANTITIES[quantity].runs ? 'no such scene' : 'no fixed point'];
    if (quantity === 'residue') return [`R ${number(value)}`];
    if (quantity === 'spectral_radius') return [`max |λ| ${number(value, 6)}`];
    const reason = kind === 'falls' ? [reasonOf(outcome)] : [];
    return quantity === 'survival'
      ? [endedAs(outcome, outcome === 'completed' ? impacts : value), ...reason]
      : [`largest |θ| ${withUnit(value, 'rad')}`, CLASSES[kind].name, ...reason];
  }

  /** @param {Grid} grid @param {Cell} cell */
  cell(grid, cell) {
    return [...this.place(grid, cell), ...(grid.has(cell.row) ? this.value(grid, cell) : ['not computed yet'])].join(
      '   ',
    );
  }

  /** The whole map in a sentence. @param {Grid} grid */
  told(grid) {
    const total = number(grid.columns * grid.rows, 7);
    const { quantity, impacts } = grid.settings;
    if (quantity === 'rest_time')
      return `${total} cells, at rest within ${number(grid.scale.low)} to ${withUnit(grid.scale.high, 's')} of the release.`;
    if (!QUANTITIES[quantity].runs && quantity !== 'caught')
      return `${total} cells, from ${number(grid.scale.low)} to ${number(grid.scale.high)}.`;
    const shares = grid
      .shares()
      .map(([kind, share]) =>
        kind === 'survives'
          ? `survives ${number(impacts, 7)} bounces in ${percent(share)}`
          : `${CLASSES[kind].name} in ${percent(share)}`,
      );
    return `${total} cells: ${shares.join(', ')}.`;
  }

  /** @param {Grid} grid */
  label({ settings: { quantity, x, y } }) {
    /** @param {Side} side */
    const range = ({ parameter, from, to }) => {
      const unit = this.field(parameter)?.unit ?? '';
      return `${this.title(parameter)} from ${withUnit(from, unit)} to ${withUnit(to, unit)}`;
    };
    return `${isOfCatches(quantity) ? 'Reach' : 'Stability'} map. ${QUANTITIES[quantity].title} over ${range(x)} and ${range(y)}.`;
  }

  /** Some cells as a table, for those who do not see the map. @param {Grid} grid */
  table(grid) {
    const { x, y, quantity } = grid.settings;
    /** @param {number} count @param {number} all */
    const some = (count, all) =>
      Array.from({ length: count }, (_, index) => Math.round((index * (all - 1)) / (count - 1)));
    const columns = some(SAMPLED.columns, grid.columns);
    const [across, upwards] = [this.symbol(x.parameter), this.symbol(y.parameter)];
    const short = (/** @type {number} */ column, /** @type {number} */ at) => {
      const value = grid.value(column, at);
      if (Number.isNaN(value)) return '–';
      const kind = grid.classOf(grid.outcome(column, at));
      if (quantity === 'caught') return CLASSES[kind].name;
      if (quantity !== 'survival') return number(value);
      return kind === 'survives' ? CLASSES[kind].name : `${CLASSES[kind].name} at ${number(value, 7)}`;
    };
    return table(
      'Some cells of the map',
      [`${upwards} \\ ${across}`, ...columns.map((column) => this.rounded(x, grid.x(column), grid.columns))],
      h(
        'tbody',
        {},
        ...some(SAMPLED.rows, grid.rows)
          .reverse()
          .map((at) =>
            row(
              this.rounded(y, grid.y(at), grid.rows),
              columns.map((column) => short(column, at)),
            ),
          ),
      ),
    );
  }
}

/** @param {number} time since the release, s; NaN where it does not come to rest */
const atRest = (time) => (Number.isNaN(time) ? 'not at rest' : `at rest after ${withUnit(time, 's')}`);

/** @param {number} share */
export const percent = (share) => `${share > 0 && share < 0.01 ? '< 1' : Math.round(share * 100)}\u202f%`;
