// The errors of a rig in words of things, in units that one reads.

import { number } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';

/** Of each field: the usual size in a lab, in SI units; what is mended; the sentence that the size goes on with, and its rest below and above. @type {Record<string, [number, string, string, string?, string?]>} */
const THINGS = {
  'contact.friction': [0.05, 'the friction', 'friction is', 'less', 'more'],
  gravity: [0.02, 'the incline', 'gravity along the table is', 'less', 'more'],
  'table.assumed_restitution': [
    0.02,
    'the restitution that the table reckons with',
    'table reckons with a restitution',
    'too low',
    'too high',
  ],
  'body.offset': [1e-3, 'the balance of the body', 'centre of gravity is', 'too far left', 'too far right'],
  'table.errors.angle_bias': [1e-3, 'the angle sensor', 'angle sensor reads', 'too little', 'too much'],
  'table.errors.tilt_offset': [1e-3, 'the zero of the table', 'zero of the table is', 'too low', 'too high'],
  'table.errors.tilt_gain': [0.01, 'the tilt of the table', 'table tilts', 'too little', 'too much'],
  'table.errors.speed': [0.01, 'the speed of the table', 'table moves', 'too slowly', 'too fast'],
  'table.pivot.x': [5e-3, 'the place of the pivot', 'pivot of the table is', 'too far left', 'too far right'],
  'table.pivot.depth': [5e-3, 'the depth of the pivot', 'pivot of the table is', 'too high', 'too deep'],
  'table.delay': [2e-3, 'the delay of the table', 'table is late by'],
  'noise.timing_sd': [1e-3, 'the timing of the strikes', 'strikes scatter in time by'],
  'noise.angle_sd': [1e-3, 'the noise of the angle sensor', 'angle readings scatter by'],
  'noise.x_sd': [1e-3, 'the noise of the place', 'readings of the place scatter by'],
  'noise.x_dot_sd': [0.01, 'the noise of ẋ', 'readings of ẋ scatter by'],
  'noise.y_dot_sd': [0.01, 'the noise of ẏ', 'readings of ẏ scatter by'],
  'noise.theta_dot_sd': [0.01, 'the noise of θ̇', 'readings of θ̇ scatter by'],
  'noise.restitution_sd': [0.01, 'the scatter of restitution', 'restitution scatters by'],
};

/** The sentences where no size at all is allowed. @type {Record<string, string>} */
const NONE_ALLOWED = { 'contact.friction': 'friction above 0', 'table.delay': 'any delay of the table' };

/** Fields whose errors a rig may have. */
export const ERRORS = Object.keys(THINGS);

/** The thing that a field is about; for one without words its path. @param {string} field */
export function thingOf(field) {
  const [usual, what, says, ...sides] = THINGS[field] ?? [0.01, field, `${field} is off by`];
  return { usual, what, says, sides, any: NONE_ALLOWED[field] ?? `any error of ${what}` };
}

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
  // Friction is a coefficient, no share.
  if (field === 'contact.friction') return ['', 1];
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
