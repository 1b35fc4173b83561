// The settings of a stability map: two fields with their ends, quantity, impacts, resolution; as a link and as a request.

import { MOST_IMPACTS } from '../../api/client.js';
import { inUse, readCatch } from '../catch/settings.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {{parameter: string, from: number, to: number}} Side */
/** @typedef {{x: Side, y: Side}} Sides */
/** @typedef {'x' | 'y'} Name */
/** @typedef {Sides & {quantity: string, impacts: number, columns: number, catch: import('../catch/settings.js').CatchSettings}} Settings */

export const NAMES = /** @type {const} */ (['x', 'y']);

/** @type {Settings} */
const DEFAULT = {
  x: { parameter: 'table.tilt_gain', from: 1, to: 1.6 },
  y: { parameter: 'release.theta', from: 0, to: 0.5 },
  quantity: 'survival',
  impacts: 1000,
  columns: 384,
  // Each cell by one strategy: comparing them all in each takes too long.
  catch: { strategy: 'bounce_down' },
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

/** The usual sides of a map around a scene. @param {import('../../api/scene-fields.js').Scene} scene @returns {Sides} */
export const usualSides = (scene) => ({
  x: scene.table?.feedback ? OTHERS.x : reaching(DEFAULT.x, scene.table?.tilt_gain),
  y: scene.body?.point ? OTHERS.y : reaching(DEFAULT.y, scene.release?.theta),
});

/** @param {Sides} one @param {Sides} other */
export const sameSides = (one, other) => JSON.stringify([one.x, one.y]) === JSON.stringify([other.x, other.y]);

/** Those with `runs` run each cell by the law of its scene; those with `catches` catch its body. @type {Record<string, {title: string, unit?: string, runs?: boolean, catches?: boolean}>} */
export const QUANTITIES = {
  survival: { title: 'Bounces survived', runs: true },
  max_theta: { title: 'Largest |θ|', unit: 'rad', runs: true },
  residue: { title: 'Residue R' },
  spectral_radius: { title: 'Spectral radius' },
  caught: { title: 'Caught', catches: true },
  rest_time: { title: 'Time to rest', unit: 's', catches: true },
};

export const COLUMNS = [48, 72, 96, 192, 384];

/** Finest columns of a map of catches unless somebody asks for more: a catch takes about a millisecond, and a server computes some 4000 for a request. */
const CATCH_COLUMNS = 72;
/** A catch in bounces of a run, by their time. */
const CATCH_BOUNCES = 1e5;

/** True for a map with a catch in every cell. @param {string} quantity */
export const isOfCatches = (quantity) => QUANTITIES[quantity].catches === true;

/** The usual finest columns. @param {string} quantity */
const usualColumns = (quantity) => (isOfCatches(quantity) ? CATCH_COLUMNS : DEFAULT.columns);

/** Another quantity, with its usual columns where the others were usual. @param {Settings} settings @param {string} quantity @returns {Settings} */
export function withQuantity(settings, quantity) {
  const usual = settings.columns === usualColumns(settings.quantity);
  return { ...settings, quantity, columns: usual ? usualColumns(quantity) : settings.columns };
}

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

/** True for a value that a field may have. @param {number} value @param {Field | undefined} field */
export const isWithin = (value, field) => kept(value, field) === value;

/** The value of a field next to this one. @param {number} value @param {Field | undefined} field */
export const kept = (value, field) =>
  Math.min(field?.maximum ?? Infinity, Math.max(field?.minimum ?? -Infinity, value));

/**
 * The map of a link; what is wrong with it gives way to the default.
 * @param {URLSearchParams} query
 * @param {Field[]} fields
 * @param {Sides} usual
 * @returns {{settings: Settings, dropped: string[]}}
 */
export function readSettings(query, fields, usual) {
  const caught = readCatch(query, 'map.catch.');
  const settings = { ...DEFAULT, ...usual, catch: { ...DEFAULT.catch, ...caught.settings } };
  const { dropped } = caught;
  const told = (/** @type {string} */ key) => query.get(`map.${key}`) ?? '';
  const numberAt = (/** @type {string} */ key) => (told(key).trim() === '' ? NaN : Number(told(key)));
  /** @param {string} key @param {string} words @param {boolean} right @param {() => void} take */
  const read = (key, words, right, take) => {
    if (right) take();
    else if (query.has(`map.${key}`)) dropped.push(words);
  };
  for (const name of NAMES) {
    const parameter = told(`${name}.parameter`);
    const field = sidesOf(fields).find((one) => one.field === parameter);
    const [from, to] = [numberAt(`${name}.from`), numberAt(`${name}.to`)];
    read(
      `${name}.parameter`,
      field
        ? `the ends of ${field.title.toLowerCase()}`
        : `the field “${parameter.slice(0, 40)}”, which a map cannot vary`,
      field !== undefined && from < to && isWithin(from, field) && isWithin(to, field),
      () => {
        settings[name] = { parameter, from, to };
      },
    );
  }
  if (settings.x.parameter === settings.y.parameter) {
    dropped.push('the second of two equal fields');
    Object.assign(settings, usual);
  }
  const [quantity, impacts, columns] = [told('quantity'), numberAt('impacts'), numberAt('columns')];
  read('quantity', `the quantity “${quantity.slice(0, 40)}”`, Object.hasOwn(QUANTITIES, quantity), () => {
    settings.quantity = quantity;
  });
  read('impacts', 'the bounces', Number.isInteger(impacts) && impacts >= 1 && impacts <= MOST_IMPACTS, () => {
    settings.impacts = impacts;
  });
  settings.columns = usualColumns(settings.quantity);
  read('columns', 'the resolution', COLUMNS.includes(columns), () => {
    settings.columns = columns;
  });
  return { settings, dropped };
}

/** The settings that differ from the usual. @param {Settings} settings @param {Sides} usual */
export function settingsQuery(settings, usual) {
  const query = new URLSearchParams();
  for (const name of NAMES)
    if (JSON.stringify(settings[name]) !== JSON.stringify(usual[name]))
      for (const [key, value] of Object.entries(settings[name])) query.set(`map.${name}.${key}`, String(value));
  const others = { ...DEFAULT, columns: usualColumns(settings.quantity) };
  for (const key of /** @type {const} */ (['quantity', 'impacts', 'columns']))
    if (settings[key] !== others[key]) query.set(`map.${key}`, String(settings[key]));
  if (isOfCatches(settings.quantity))
    for (const [key, value] of Object.entries(inUse(settings.catch))) query.set(`map.catch.${key}`, String(value));
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
  const rows = rowsOf(columns);
  for (const [name, { parameter: field, from, to }, count] of /** @type {const} */ ([
    ['x', x, columns],
    ['y', y, rows],
  ]))
    for (const [key, value] of Object.entries({ field, from, to, count })) query.set(`${name}.${key}`, String(value));
  query.set('quantity', quantity);
  if (!isOfCatches(quantity)) query.set('bounces', String(impacts));
  else for (const [key, value] of Object.entries(inUse(catching))) query.set(`catch.${key}`, String(value));
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
