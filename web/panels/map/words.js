// A map in words: its fields, a cell, the whole of it, its legend, and a table of some of its cells.

import { GRADIENT } from '../../charts/cividis.js';
import { number, quantity as withUnit, unitAfter } from '../../dom/numbers.js';
import { shownFactor, shownUnit, shownValue } from '../../dom/units.js';
import { html } from '../../vendor/preact/preact.js';
import { Row, Table } from '../parts.js';
import { endedAs, reasonOf } from '../verdict/words.js';
import { CLASSES, expected } from './classes.js';
import { QUANTITIES, isOfCatches } from './settings.js';

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

/** The colours of values, with some of their numbers. @param {{grid: Grid}} props */
function Scale({ grid: { scale, settings } }) {
  const { low, high } = scale;
  const { title, unit = '' } = QUANTITIES[settings.quantity];
  const values = high > low ? [0, 0.25, 0.5, 0.75, 1].map((share) => low + share * (high - low)) : [low];
  return html`<span class="map-scale">
    ${unit ? `${title} (${shownUnit(unit)})` : title}
    <span class="map-colours" style=${{ background: GRADIENT }} aria-hidden="true" />
    <span>${values.map((value) => html`<span>${number(shownValue(value, unit), 3)}</span>`)}</span>
  </span>`;
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
  return html`${!grid.classes && html`<${Scale} grid=${grid} />`}
    ${entries.map(([kind, words]) => html`<span><span class=${`swatch ${kind}`} aria-hidden="true" />${words}</span>`)}`;
}

/** @param {Side} side */
const titleOf = ({ field: { title } }) => title.toLowerCase();

/** A symbol that can be printed in one line, else the title. @param {Side} side */
const symbolOf = (side) => {
  const { symbol } = side.field;
  return symbol && !symbol.includes('_') ? symbol : titleOf(side);
};

/** The name of an axis, in SI units. @param {Side} side */
export function axisOf(side) {
  const [title, symbol] = [titleOf(side), symbolOf(side)];
  const { unit } = side.field;
  return (symbol === title ? title : `${title} ${symbol}`) + (unit && unit !== '1' ? ` / ${unit}` : '');
}

/** A value of a field in the digits that a cell of the map is wide. @param {Side} side @param {number} value @param {number} count of cells */
function rounded({ field: { unit }, from, to }, value, count) {
  const factor = shownFactor(unit);
  const decimals = decimalsOf(((to - from) * factor) / (count - 1));
  return number(Number((value * factor).toFixed(decimals)), 15) + unitAfter(unit ?? '');
}

/** The value of a cell. @param {Grid} grid @param {Cell} cell @returns {string[]} */
function resultOf(grid, { column, row: upwards }) {
  const { quantity, bounces } = grid.settings;
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
    ? [endedAs(outcome, outcome === 'completed' ? bounces : value), ...reason]
    : [`largest |θ| ${withUnit(value, 'rad')}`, name, ...reason];
}

/** A cell with its two fields and its value. @param {Grid} grid @param {Cell} cell */
export function cellWords(grid, cell) {
  const { x, y } = grid.settings;
  return [
    `${symbolOf(x)} ${rounded(x, grid.x(cell.column), grid.columns)}`,
    `${symbolOf(y)} ${rounded(y, grid.y(cell.row), grid.rows)}`,
    ...(grid.has(cell.row) ? resultOf(grid, cell) : ['not computed yet']),
  ].join('   ');
}

/** The scene in its cell. Beside the middle of that its run is another one, so that the kind of its end alone is told. @param {Grid} grid @param {Cell} cell @param {{x: number, y: number}} values of the scene */
export function sceneWords(grid, cell, values) {
  const { x, y } = grid.settings;
  const isMiddle = values.x === grid.x(cell.column) && values.y === grid.y(cell.row);
  if (isMiddle || !grid.classes || !grid.has(cell.row)) return cellWords(grid, cell);
  const own = (/** @type {Side} */ side, /** @type {number} */ value) =>
    `${symbolOf(side)} ${withUnit(value, side.field.unit)}`;
  return [
    own(x, values.x),
    own(y, values.y),
    `${CLASSES[grid.classOf(grid.outcome(cell.column, cell.row))].name} here`,
  ].join('   ');
}

/** The whole map in a sentence. @param {Grid} grid */
export function mapWords(grid) {
  const total = number(grid.columns * grid.rows, 7);
  const { quantity, bounces } = grid.settings;
  const [low, high] = [number(grid.scale.low), number(grid.scale.high)];
  if (quantity === 'rest_time')
    return `${total} cells, at rest within ${low} to ${high}${unitAfter('s')} of the release.`;
  if (!QUANTITIES[quantity].runs && quantity !== 'caught') return `${total} cells, from ${low} to ${high}.`;
  const shares = grid.shares().map(([kind, share]) => {
    const deed = kind === 'survives' ? `survives ${number(bounces, 7)} bounces` : CLASSES[kind].name;
    return `${deed} in ${percent(share)}`;
  });
  return `${total} cells: ${shares.join(', ')}.`;
}

/** The name of a map for those who do not see it. @param {Grid} grid */
export function labelOf({ settings: { quantity, x, y } }) {
  const [across, upwards] = [x, y].map((side) => {
    const [from, to] = [side.from, side.to].map((end) => withUnit(end, side.field.unit));
    return `${titleOf(side)} from ${from} to ${to}`;
  });
  return `${isOfCatches(quantity) ? 'Reach' : 'Stability'} map. ${QUANTITIES[quantity].title} over ${across} and ${upwards}.`;
}

/** The value of a cell in a table. @param {Grid} grid @param {number} column @param {number} row */
function short(grid, column, row) {
  const { quantity } = grid.settings;
  const value = grid.value(column, row);
  if (Number.isNaN(value)) return '–';
  const kind = grid.classOf(grid.outcome(column, row));
  if (quantity === 'caught' || (quantity === 'survival' && kind === 'survives')) return CLASSES[kind].name;
  return quantity === 'survival' ? `${CLASSES[kind].name} at ${number(value, 7)}` : number(value);
}

/** Some cells as a table, for those who do not see the map. @param {{grid: Grid}} props */
export function Sample({ grid }) {
  const { x, y } = grid.settings;
  const some = (/** @type {number} */ all) =>
    Array.from({ length: SAMPLED }, (_, index) => Math.round((index * (all - 1)) / (SAMPLED - 1)));
  const columns = some(grid.columns);
  const rows = some(grid.rows).toReversed();
  return html`<${Table} label="Some cells of the map"
    head=${[`${symbolOf(y)} \\ ${symbolOf(x)}`, ...columns.map((at) => rounded(x, grid.x(at), grid.columns))]}
    children=${rows.map((at) => html`<${Row} cells=${[rounded(y, grid.y(at), grid.rows), ...columns.map((column) => short(grid, column, at))]} />`)}
  />`;
}
