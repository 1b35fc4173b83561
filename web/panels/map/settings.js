// The settings of a stability map: two fields with their ends, quantity, impacts, resolution; as a link and as a request.

import { MOST_IMPACTS } from '../../api/client.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {{parameter: string, from: number, to: number}} Side */
/** @typedef {{x: Side, y: Side, quantity: string, impacts: number, columns: number}} Settings */

/** @type {Settings} */
export const DEFAULT = {
  x: { parameter: 'table.tilt_gain', from: 1, to: 1.6 },
  y: { parameter: 'release.theta', from: 0, to: 0.5 },
  quantity: 'survival',
  impacts: 1000,
  columns: 384,
};

/** @type {Record<string, {title: string, unit: string, runs: boolean}>} */
export const QUANTITIES = {
  survival: { title: 'Bounces survived', unit: '', runs: true },
  max_theta: { title: 'Largest |θ|', unit: 'rad', runs: true },
  residue: { title: 'Residue R', unit: '', runs: false },
  spectral_radius: { title: 'Spectral radius', unit: '', runs: false },
};

export const COLUMNS = [48, 96, 192, 384];

/** Columns that a map goes through until it is as fine as wanted. */
const PASSES = [24, 96, 384];

/** The columns of its passes, from coarse to fine. @param {number} finest */
export const passesOf = (finest) => [...PASSES.filter((columns) => columns < finest), finest];

/** Bounces of its runs. @param {Settings} settings */
export const bouncesOf = ({ columns, impacts, quantity }) =>
  QUANTITIES[quantity].runs ? columns * rowsOf(columns) * impacts : 0;

/** @param {number} columns */
export const rowsOf = (columns) => (columns * 2) / 3;

/** Fields whose values are numbers, which a map can vary. @param {Field[]} fields */
export const sidesOf = (fields) => fields.filter(({ kind }) => kind === 'number');

/**
 * The map of a link; what is wrong with it gives way to the default.
 * @param {URLSearchParams} query
 * @param {Field[]} fields
 * @returns {{settings: Settings, dropped: string[]}}
 */
export function readSettings(query, fields) {
  const settings = structuredClone(DEFAULT);
  /** @type {string[]} */
  const dropped = [];
  /** @param {string} key */
  const numberAt = (key) => {
    const text = query.get(`map.${key}`);
    return text === null || text.trim() === '' ? NaN : Number(text);
  };
  for (const name of /** @type {const} */ (['x', 'y'])) {
    if (!query.has(`map.${name}.parameter`)) continue;
    const parameter = query.get(`map.${name}.parameter`) ?? '';
    const field = sidesOf(fields).find(({ path }) => path === parameter);
    const [from, to] = [numberAt(`${name}.from`), numberAt(`${name}.to`)];
    if (!field) dropped.push(`the field “${parameter.slice(0, 40)}”, which a map cannot vary`);
    else if (!(from < to) || from < (field.minimum ?? -Infinity) || to > (field.maximum ?? Infinity))
      dropped.push(`the ends of ${field.title.toLowerCase()}`);
    else settings[name] = { parameter, from, to };
  }
  if (settings.x.parameter === settings.y.parameter) {
    dropped.push('the second of two equal fields');
    [settings.x, settings.y] = [structuredClone(DEFAULT.x), structuredClone(DEFAULT.y)];
  }
  const quantity = query.get('map.quantity');
  if (quantity !== null && quantity in QUANTITIES) settings.quantity = quantity;
  else if (quantity !== null) dropped.push(`the quantity “${quantity.slice(0, 40)}”`);
  const impacts = numberAt('impacts');
  if (Number.isInteger(impacts) && impacts >= 1 && impacts <= MOST_IMPACTS) settings.impacts = impacts;
  else if (query.has('map.impacts')) dropped.push('the impacts');
  const columns = numberAt('columns');
  if (COLUMNS.includes(columns)) settings.columns = columns;
  else if (query.has('map.columns')) dropped.push('the resolution');
  return { settings, dropped };
}

/**
 * The settings that differ from the default.
 * @param {Settings} settings
 */
export function settingsQuery(settings) {
  const query = new URLSearchParams();
  for (const name of /** @type {const} */ (['x', 'y'])) {
    const side = settings[name];
    const own = Object.entries(side);
    if (own.every(([key, value]) => DEFAULT[name][/** @type {keyof Side} */ (key)] === value)) continue;
    for (const [key, value] of own) query.set(`map.${name}.${key}`, String(value));
  }
  for (const key of /** @type {const} */ (['quantity', 'impacts', 'columns']))
    if (settings[key] !== DEFAULT[key]) query.set(`map.${key}`, String(settings[key]));
  return query;
}

/**
 * A request for `/v1/regions`. The scene's own values of the two fields do not matter and are left out.
 * @param {Settings} settings
 * @param {URLSearchParams} scene
 */
export function requestQuery({ x, y, quantity, impacts, columns }, scene) {
  const query = new URLSearchParams(scene);
  for (const { parameter } of [x, y]) query.delete(`scene.${parameter}`);
  for (const [name, side, count] of /** @type {const} */ ([
    ['x', x, columns],
    ['y', y, rowsOf(columns)],
  ])) {
    query.set(`${name}.parameter`, side.parameter);
    query.set(`${name}.from`, String(side.from));
    query.set(`${name}.to`, String(side.to));
    query.set(`${name}.count`, String(count));
  }
  query.set('quantity', quantity);
  query.set('impacts', String(impacts));
  return query;
}

/** Nodes along a side, as many as the server looks at for the linear boundary. */
const NODES = 49;

/**
 * The cheapest request that has the linear boundary of the same map, and the names of outcomes: NDJSON has neither.
 * @param {URLSearchParams} request
 */
export function outlineQuery(request) {
  const query = new URLSearchParams(request);
  for (const [key, value] of Object.entries({
    'x.count': NODES,
    'y.count': NODES,
    quantity: 'residue',
    impacts: 1,
    'tile.index': 0,
    'tile.of': NODES,
  }))
    query.set(key, String(value));
  return query;
}
