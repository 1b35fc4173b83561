// A map in words: its fields, a cell, the whole of it, its legend, and a table of some of its cells.

import { number, quantity as withUnit, unitAfter } from '../../dom/numbers.js';
import { shownFactor } from '../../dom/units.js';
import { html } from '../../vendor/preact/preact.js';
import { Row, Table } from '../parts.js';
import { endedAs, reasonOf } from '../verdict/words.js';
import { CLASSES, expected } from './classes.js';
import { QUANTITIES, isOfCatches } from './settings.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {{column: number, row: number}} Cell */

/** Rows of the table, and its columns. */
const SAMPLED = 7;

/** Decimals that tell steps of this size apart. @param {number} step */
export const decimalsOf = (step) => Math.min(15, Math.max(0, Math.ceil(-Math.log10(step))));

/** @param {number} share */
const percent = (share) => `${share > 0 && share < 0.01 ? '< 1' : Math.round(share * 100)}\u202f%`;

/** The reason for a cell without a value. @param {string} quantity */
function lacking(quantity) {
  if (quantity === 'rest_time') return 'not at rest, or no such scene';
  return QUANTITIES[quantity].runs || isOfCatches(quantity) ? 'no such scene' : 'no fixed point';
}

/** The colours and lines of a map. @param {{grid: Grid}} props */
export function Legend({ grid }) {
  const shares = new Map(grid.shares());
  const { quantity } = grid.settings;
  const kinds = grid.classes ? [...new Set([...expected(quantity), ...shares.keys()])] : [];
  /** @type {[string, string][]} */
  const entries = kinds.map((kind) => {
    const share = shares.get(kind);
    return [kind, CLASSES[kind].name + (share === undefined ? '' : ` ${percent(share)}`)];
  });
  if (grid.limitCurves.some(({ residue }) => residue === 0 || residue === 1))
    entries.push(['limit', 'limit for small angles']);
  if (grid.lacks) entries.push(['none', lacking(quantity)]);
  return entries.map(
    ([kind, words]) => html`<span><span class=${`swatch ${kind}`} aria-hidden="true" />${words}</span>`,
  );
}

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
  #title(path) {
    return this.field(path)?.title.toLowerCase() ?? path;
  }

  /** @param {Side} side */
  #unit({ parameter }) {
    return this.field(parameter)?.unit ?? '';
  }

  /** A symbol that can be printed in one line, else the title. @param {string} path */
  #symbol(path) {
    const symbol = this.field(path)?.symbol;
    return symbol && !symbol.includes('_') ? symbol : this.#title(path);
  }

  /** The name of an axis, in SI units. @param {Side} side */
  axis(side) {
    const [title, symbol] = [this.#title(side.parameter), this.#symbol(side.parameter)];
    const unit = this.#unit(side);
    return (symbol === title ? title : `${title} ${symbol}`) + (unit && unit !== '1' ? ` / ${unit}` : '');
  }

  /** A value of a field in the digits that a cell of the map is wide. @param {Side} side @param {number} value @param {number} count of cells */
  #rounded(side, value, count) {
    const unit = this.#unit(side);
    const factor = shownFactor(unit);
    const decimals = decimalsOf(((side.to - side.from) * factor) / (count - 1));
    return number(Number((value * factor).toFixed(decimals)), 15) + unitAfter(unit);
  }

  /** The value of a cell. @param {Grid} grid @param {Cell} cell @returns {string[]} */
  #value(grid, { column, row: upwards }) {
    const { quantity, impacts } = grid.settings;
    const value = grid.value(column, upwards);
    const outcome = grid.outcome(column, upwards);
    const kind = grid.classOf(outcome);
    const { name } = CLASSES[kind];
    if (isOfCatches(quantity)) {
      if (outcome === 'none') return ['no such scene'];
      // It is not a number where the body does not come to rest.
      const rest = Number.isNaN(value) ? 'not at rest' : `at rest after ${withUnit(value, 's')}`;
      return [...(quantity === 'caught' ? [] : [rest]), name, ...(kind === 'lies' ? [] : [reasonOf(outcome)])];
    }
    if (Number.isNaN(value)) return [lacking(quantity)];
    if (quantity === 'residue') return [`R ${number(value)}`];
    if (quantity === 'spectral_radius') return [`max |λ| ${number(value, 6)}`];
    const reason = kind === 'falls' ? [reasonOf(outcome)] : [];
    return quantity === 'survival'
      ? [endedAs(outcome, outcome === 'completed' ? impacts : value), ...reason]
      : [`largest |θ| ${withUnit(value, 'rad')}`, name, ...reason];
  }

  /** @param {Grid} grid @param {Cell} cell */
  cell(grid, cell) {
    const { x, y } = grid.settings;
    return [
      `${this.#symbol(x.parameter)} ${this.#rounded(x, grid.x(cell.column), grid.columns)}`,
      `${this.#symbol(y.parameter)} ${this.#rounded(y, grid.y(cell.row), grid.rows)}`,
      ...(grid.has(cell.row) ? this.#value(grid, cell) : ['not computed yet']),
    ].join('   ');
  }

  /** The whole map in a sentence. @param {Grid} grid */
  told(grid) {
    const total = number(grid.columns * grid.rows, 7);
    const { quantity, impacts } = grid.settings;
    const [low, high] = [number(grid.scale.low), number(grid.scale.high)];
    if (quantity === 'rest_time')
      return `${total} cells, at rest within ${low} to ${high}${unitAfter('s')} of the release.`;
    if (!QUANTITIES[quantity].runs && quantity !== 'caught') return `${total} cells, from ${low} to ${high}.`;
    const shares = grid.shares().map(([kind, share]) => {
      const deed = kind === 'survives' ? `survives ${number(impacts, 7)} bounces` : CLASSES[kind].name;
      return `${deed} in ${percent(share)}`;
    });
    return `${total} cells: ${shares.join(', ')}.`;
  }

  /** @param {Grid} grid */
  label({ settings: { quantity, x, y } }) {
    const [across, upwards] = [x, y].map((side) => {
      const [from, to] = [side.from, side.to].map((end) => withUnit(end, this.#unit(side)));
      return `${this.#title(side.parameter)} from ${from} to ${to}`;
    });
    return `${isOfCatches(quantity) ? 'Reach' : 'Stability'} map. ${QUANTITIES[quantity].title} over ${across} and ${upwards}.`;
  }

  /** Some cells as a table, for those who do not see the map. @param {Grid} grid */
  table(grid) {
    const { x, y, quantity } = grid.settings;
    const some = (/** @type {number} */ all) =>
      Array.from({ length: SAMPLED }, (_, index) => Math.round((index * (all - 1)) / (SAMPLED - 1)));
    const short = (/** @type {number} */ column, /** @type {number} */ at) => {
      const value = grid.value(column, at);
      if (Number.isNaN(value)) return '–';
      const kind = grid.classOf(grid.outcome(column, at));
      if (quantity === 'caught' || (quantity === 'survival' && kind === 'survives')) return CLASSES[kind].name;
      return quantity === 'survival' ? `${CLASSES[kind].name} at ${number(value, 7)}` : number(value);
    };
    const columns = some(grid.columns);
    const corner = `${this.#symbol(y.parameter)} \\ ${this.#symbol(x.parameter)}`;
    return html`<${Table}
      label="Some cells of the map"
      head=${[corner, ...columns.map((at) => this.#rounded(x, grid.x(at), grid.columns))]}
      children=${some(grid.rows)
        .reverse()
        .map(
          (at) =>
            html`<${Row}
              cells=${[this.#rounded(y, grid.y(at), grid.rows), ...columns.map((column) => short(column, at))]}
            />`,
        )}
    />`;
  }
}
