// Quantities of a measured bounce.

import { shownFactor, shownUnit } from '../../dom/units.js';

/** @typedef {'n' | 't' | 'theta' | 'x_dot' | 'y_dot' | 'theta_dot' | 'x'} Quantity */
/** Those that a fit takes. @typedef {Exclude<Quantity, 'n'>} Column */
/** Those that are compared with a run. @typedef {Exclude<Column, 'x'>} Compared */

/** Symbol, unit, name, and heads of columns that mean it, in small letters without anything between them. @type {Record<Quantity, [symbol: string, unit: string, name: string, heads: string[]]>} */
export const QUANTITIES = {
  n: ['n', '1', 'number of the bounce', ['n', 'no', 'impact', 'contact', 'bounce', 'number', 'impactnumber']],
  t: ['t', 's', 'time', ['t', 'time']],
  theta: ['θ', 'rad', 'angle', ['theta', 'angle']],
  x_dot: ['ẋ', 'm/s', 'velocity across', ['xdot', 'vx']],
  y_dot: ['ẏ', 'm/s', 'velocity upwards', ['ydot', 'vy']],
  theta_dot: ['θ̇', 'rad/s', 'angular velocity', ['thetadot', 'omega', 'angularvelocity', 'spin']],
  x: ['x', 'm', 'place across', ['x', 'place', 'position']],
};
/** Units to choose from, by that of SI. @type {Record<string, string[]>} */
export const UNITS = {
  1: [],
  s: ['s', 'ms', 'µs'],
  rad: ['rad', 'mrad', 'deg'],
  m: ['m', 'cm', 'mm'],
  'm/s': ['m/s', 'cm/s', 'mm/s'],
  'rad/s': ['rad/s', 'mrad/s', 'deg/s', 'rpm'],
};

export const ALL = /** @type {Quantity[]} */ (Object.keys(QUANTITIES));
export const COLUMNS = /** @type {Column[]} */ (ALL.filter((quantity) => quantity !== 'n'));
export const COMPARED = /** @type {Compared[]} */ (COLUMNS.filter((quantity) => quantity !== 'x'));

/** Name and shown unit of a quantity. @param {Quantity} quantity */
export const nameOf = (quantity) => `${QUANTITIES[quantity][0]} / ${shownUnit(QUANTITIES[quantity][1])}`;

/** The shown value of a quantity, without its unit. @param {Quantity} quantity @param {number} value in SI units */
export const shownOf = (quantity, value) => value * shownFactor(QUANTITIES[quantity][1]);
