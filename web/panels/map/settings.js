// The settings of a stability map: two fields with their ends, quantity, impacts, resolution; as a link and as a request.

import { MOST_IMPACTS } from '../../api/client.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {{parameter: string, from: number, to: number}} Side */
/** The settings of a catch as a request has them. @typedef {Record<string, string>} CatchOf */
/** @typedef {{x: Side, y: Side, quantity: string, impacts: number, columns: number, catch: CatchOf}} Settings */

/** @type {Settings} */
export const DEFAULT = {
  x: { parameter: 'table.tilt_gain', from: 1, to: 1.6 },
  y: { parameter: 'release.theta', from: 0, to: 0.5 },
  quantity: 'survival',
  impacts: 1000,
  columns: 384,
  catch: {},
};

/** Sides of a scene whose usual fields mean nothing: feedback has no tilt gain, a point no angle. */
const OTHERS = {
  x: { parameter: 'release.theta_dot', from: -2, to: 2 },
  y: { parameter: 'release.x_dot', from: 0, to: 0.5 },
};

/** A side that reaches a value, in steps of a fifth of it. @param {Side} side @param {unknown} value @returns {Side} */
function reaching({ parameter, from, to }, value) {
  if (typeof value !== 'number') return { parameter, from, to };
  const step = (to - from) / 5;
  const beyond = (/** @type {number} */ end) => Number((step * end).toPrecision(6));
  return {
    parameter,
    from: value < from ? beyond(Math.floor(value / step)) : from,
    to: value > to ? beyond(Math.ceil(value / step)) : to,
  };
}

/** The usual sides of a map around a scene. @param {import('../../api/scene-fields.js').Scene} scene @returns {Pick<Settings, 'x' | 'y'>} */
export function usualSides(scene) {
  const x = scene.table?.feedback ? OTHERS.x : reaching(DEFAULT.x, scene.table?.tilt_gain);
  const y = scene.body?.point ? OTHERS.y : reaching(DEFAULT.y, scene.release?.theta);
  return { x: { ...x }, y: { ...y } };
}

/** Those with `runs` run each cell by the law of its scene; those with `catches` catch its body. @type {Record<string, {title: string, unit: string, runs: boolean, catches?: boolean}>} */
export const QUANTITIES = {
  survival: { title: 'Bounces survived', unit: '', runs: true },
  max_theta: { title: 'Largest |θ|', unit: 'rad', runs: true },
  residue: { title: 'Residue R', unit: '', runs: false },
  spectral_radius: { title: 'Spectral radius', unit: '', runs: false },
  caught: { title: 'Caught', unit: '', runs: false, catches: true },
  rest_time: { title: 'Time to rest', unit: 's', runs: false, catches: true },
};

export const COLUMNS = [48, 96, 192, 384];

/** Finest columns of a map of catches unless somebody asks for more: a catch takes about a millisecond. */
const CATCH_COLUMNS = 96;
/** A catch in bounces of a run, by their time. */
const CATCH_BOUNCES = 1e5;
const STRATEGIES = ['bounce_down', 'plan', 'brake'];

/** True for a map with a catch in every cell. @param {string} quantity */
export const isOfCatches = (quantity) => QUANTITIES[quantity].catches === true;

/** The usual finest columns. @param {string} quantity */
export const usualColumns = (quantity) => (isOfCatches(quantity) ? CATCH_COLUMNS : DEFAULT.columns);

/** Columns that a map goes through until it is as fine as wanted. */
const PASSES = [24, 96, 384];

/** The columns of its passes, from coarse to fine. @param {number} finest */
export const passesOf = (finest) => [...PASSES.filter((columns) => columns < finest), finest];

/** Bounces of its runs, or as many as take the time of its catches. @param {Settings} settings */
export function bouncesOf({ columns, impacts, quantity }) {
  const { runs, catches } = QUANTITIES[quantity];
  return columns * rowsOf(columns) * (runs ? impacts : catches ? CATCH_BOUNCES : 0);
}

/** @param {number} columns */
export const rowsOf = (columns) => (columns * 2) / 3;

/** Fields whose values are numbers, which a map can vary. @param {Field[]} fields */
export const sidesOf = (fields) => fields.filter(({ kind }) => kind === 'number');

/**
 * The map of a link; what is wrong with it gives way to the default.
 * @param {URLSearchParams} query
 * @param {Field[]} fields
 * @param {Pick<Settings, 'x' | 'y'>} usual
 * @returns {{settings: Settings, dropped: string[]}}
 */
export function readSettings(query, fields, usual) {
  const settings = structuredClone({ ...DEFAULT, ...usual });
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
    const field = sidesOf(fields).find((one) => one.field === parameter);
    const [from, to] = [numberAt(`${name}.from`), numberAt(`${name}.to`)];
    if (!field) dropped.push(`the field “${parameter.slice(0, 40)}”, which a map cannot vary`);
    else if (!(from < to) || from < (field.minimum ?? -Infinity) || to > (field.maximum ?? Infinity))
      dropped.push(`the ends of ${field.title.toLowerCase()}`);
    else settings[name] = { parameter, from, to };
  }
  if (settings.x.parameter === settings.y.parameter) {
    dropped.push('the second of two equal fields');
    Object.assign(settings, structuredClone(usual));
  }
  const quantity = query.get('map.quantity');
  if (quantity !== null && quantity in QUANTITIES) settings.quantity = quantity;
  else if (quantity !== null) dropped.push(`the quantity “${quantity.slice(0, 40)}”`);
  const impacts = numberAt('impacts');
  if (Number.isInteger(impacts) && impacts >= 1 && impacts <= MOST_IMPACTS) settings.impacts = impacts;
  else if (query.has('map.impacts')) dropped.push('the bounces');
  const columns = numberAt('columns');
  settings.columns = usualColumns(settings.quantity);
  if (COLUMNS.includes(columns)) settings.columns = columns;
  else if (query.has('map.columns')) dropped.push('the resolution');
  for (const [key, text] of query) {
    if (!key.startsWith('map.catch.')) continue;
    const name = key.slice('map.catch.'.length);
    const right = name === 'strategy' ? STRATEGIES.includes(text) : text.trim() !== '' && Number.isFinite(Number(text));
    if (right) settings.catch[name] = text;
    else dropped.push(`${name} of the catch “${text.slice(0, 40)}”`);
  }
  return { settings, dropped };
}

/**
 * The settings that differ from the usual.
 * @param {Settings} settings
 * @param {Pick<Settings, 'x' | 'y'>} usual
 */
export function settingsQuery(settings, usual) {
  const query = new URLSearchParams();
  for (const name of /** @type {const} */ (['x', 'y'])) {
    const side = settings[name];
    const own = Object.entries(side);
    if (own.every(([key, value]) => usual[name][/** @type {keyof Side} */ (key)] === value)) continue;
    for (const [key, value] of own) query.set(`map.${name}.${key}`, String(value));
  }
  const others = { ...DEFAULT, columns: usualColumns(settings.quantity) };
  for (const key of /** @type {const} */ (['quantity', 'impacts', 'columns']))
    if (settings[key] !== others[key]) query.set(`map.${key}`, String(settings[key]));
  if (isOfCatches(settings.quantity))
    for (const [key, value] of Object.entries(settings.catch)) query.set(`map.catch.${key}`, value);
  return query;
}

/**
 * A request for `/v1/regions`. The scene's own values of the two fields do not matter and are left out.
 * @param {Settings} settings
 * @param {URLSearchParams} scene
 */
export function requestQuery({ x, y, quantity, impacts, columns, catch: catching }, scene) {
  const query = new URLSearchParams(scene);
  for (const { parameter } of [x, y]) query.delete(`scene.${parameter}`);
  for (const [name, side, count] of /** @type {const} */ ([
    ['x', x, columns],
    ['y', y, rowsOf(columns)],
  ])) {
    query.set(`${name}.field`, side.parameter);
    query.set(`${name}.from`, String(side.from));
    query.set(`${name}.to`, String(side.to));
    query.set(`${name}.count`, String(count));
  }
  query.set('quantity', quantity);
  if (!isOfCatches(quantity)) query.set('bounces', String(impacts));
  // Each cell by one strategy: comparing them all in each takes too long.
  else
    for (const [key, value] of Object.entries({ strategy: STRATEGIES[0], ...catching }))
      query.set(`catch.${key}`, value);
  return query;
}

/** Nodes along a side, as many as the server looks at for the linear boundary. */
const NODES = 49;

/**
 * The cheapest request that has the linear boundary of the same map, and the names of outcomes: NDJSON has neither. A map of catches
 * has no boundary.
 * @param {URLSearchParams} request
 */
export function outlineQuery(request) {
  const query = new URLSearchParams(request);
  const cheapest = isOfCatches(request.get('quantity') ?? '')
    ? { 'x.count': 1, 'y.count': 1 }
    : { 'x.count': NODES, 'y.count': NODES, quantity: 'residue', bounces: 1, 'tile.index': 0, 'tile.of': NODES };
  for (const [key, value] of Object.entries(cheapest)) query.set(key, String(value));
  return query;
}
