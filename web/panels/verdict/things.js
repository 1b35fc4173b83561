// The errors of a rig in words of things, in units that one reads.

import { number } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';

/** @typedef {import('contract').BudgetError} BudgetError */

/**
 * @typedef {object} Thing
 * @property {string} what is mended, as in “mend the angle sensor”
 * @property {string} says begins the sentence that the size goes on with
 * @property {[string, string]} [sides] the rest of it, below and above
 * @property {string} [any] the sentence where no size at all is allowed
 * @property {string} [unit] in which its size is typed, where not that of its SI unit
 * @property {number} usual size in a lab, in SI units
 */

/** @type {Record<string, Thing>} */
const THINGS = {
  'contact.friction': {
    what: 'the friction',
    says: 'friction is',
    sides: ['less', 'more'],
    any: 'friction above 0',
    usual: 0.05,
    unit: '1',
  },
  gravity: { what: 'the incline', says: 'gravity along the table is', sides: ['less', 'more'], usual: 0.02 },
  'table.assumed_restitution': {
    what: 'the restitution that the table reckons with',
    says: 'table reckons with a restitution',
    sides: ['too low', 'too high'],
    usual: 0.02,
  },
  'body.offset': {
    what: 'the balance of the body',
    says: 'centre of gravity is',
    sides: ['too far left', 'too far right'],
    usual: 1e-3,
  },
  'table.errors.angle_bias': {
    what: 'the angle sensor',
    says: 'angle sensor reads',
    sides: ['too little', 'too much'],
    usual: 1e-3,
  },
  'table.errors.tilt_offset': {
    what: 'the zero of the table',
    says: 'zero of the table is',
    sides: ['too low', 'too high'],
    usual: 1e-3,
  },
  'table.errors.tilt_gain': {
    what: 'the tilt of the table',
    says: 'table tilts',
    sides: ['too little', 'too much'],
    usual: 0.01,
  },
  'table.errors.speed': {
    what: 'the speed of the table',
    says: 'table moves',
    sides: ['too slowly', 'too fast'],
    usual: 0.01,
  },
  'table.pivot.x': {
    what: 'the place of the pivot',
    says: 'pivot of the table is',
    sides: ['too far left', 'too far right'],
    usual: 5e-3,
  },
  'table.pivot.depth': {
    what: 'the depth of the pivot',
    says: 'pivot of the table is',
    sides: ['too high', 'too deep'],
    usual: 5e-3,
  },
  'table.delay': {
    what: 'the delay of the table',
    says: 'table is late by',
    any: 'any delay of the table',
    usual: 2e-3,
  },
  'noise.timing_sd': { what: 'the timing of the strikes', says: 'strikes scatter in time by', usual: 1e-3 },
  'noise.angle_sd': { what: 'the noise of the angle sensor', says: 'angle readings scatter by', usual: 1e-3 },
  'noise.x_sd': { what: 'the noise of the place', says: 'readings of the place scatter by', usual: 1e-3 },
  'noise.x_dot_sd': { what: 'the noise of ẋ', says: 'readings of ẋ scatter by', usual: 0.01 },
  'noise.y_dot_sd': { what: 'the noise of ẏ', says: 'readings of ẏ scatter by', usual: 0.01 },
  'noise.theta_dot_sd': { what: 'the noise of θ̇', says: 'readings of θ̇ scatter by', usual: 0.01 },
  'noise.restitution_sd': { what: 'the scatter of restitution', says: 'restitution scatters by', usual: 0.01 },
};

/** The thing that a field is about; for one without words its path. @param {string} field @returns {Thing} */
export const thingOf = (field) => THINGS[field] ?? { what: field, says: `${field} is off by`, usual: 0.01 };

/** Units in which sizes are typed, with their values in SI. @type {Record<string, [string, number]>} */
const TYPED = {
  m: ['mm', 1e-3],
  s: ['ms', 1e-3],
  rad: ['mrad', 1e-3],
  'm/s': ['mm/s', 1e-3],
  'rad/s': ['mrad/s', 1e-3],
  1: ['%', 0.01],
};
const DEGREE = Math.PI / 180;

/** The unit in which the size of an error is typed, and its value in SI. @param {string} field @param {string} unit in SI @returns {[string, number]} */
export function typedUnit(field, unit) {
  if (THINGS[field]?.unit === unit) return ['', 1];
  if (angles() === 'deg' && /^rad/.test(unit)) return [unit.replace('rad', '°'), DEGREE];
  return TYPED[unit] ?? [unit, 1];
}

/** A size in the unit that gives it no leading zeros. @param {string} field @param {number} size in SI units @param {string} unit */
export function sizeWords(field, size, unit) {
  const [typed, value] = typedUnit(field, unit);
  const shown = size / value;
  if (/^m[a-z]/.test(typed) && shown !== 0 && shown < 0.1)
    return `${number(shown * 1e3, 3)}\u202f${typed.replace('m', 'µ')}`;
  if (/^m[a-z]/.test(typed) && shown >= 1000) return `${number(shown / 1e3, 3)}\u202f${typed.slice(1)}`;
  return `${number(shown, 3)}${typed === '' ? '' : /^°/.test(typed) ? typed : `\u202f${typed}`}`;
}
