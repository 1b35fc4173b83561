// The types of a plot of impacts: its axes and words. No program loads this file.

/**
 * @typedef {object} Axis
 * @property {import('../../run/impacts.js').Lasting} column
 * @property {string} name with its unit, for the axis
 * @property {boolean} [symmetric] about zero
 * @property {number} [span] least span, so that rounding does not look like motion
 * @property {number} [from] a low end that stays
 */

/**
 * @typedef {object} Meaning
 * @property {string} id
 * @property {string} title
 * @property {string | Node} about
 * @property {Axis} x
 * @property {Axis} y
 * @property {string[]} head of the table of numbers
 * @property {(impacts: import('../../run/impacts.js').Impacts, place: number) => string[]} cells
 * @property {(impacts: import('../../run/impacts.js').Impacts, place: number) => string} readout
 * @property {string} hint while there is nothing
 * @property {string} [lacking] when impacts have no such values
 * @property {string} spoken what it shows, for those who do not see it
 * @property {() => {value: number, name: string}[]} [levels] horizontal lines worth comparing with
 * @property {'angle' | 'velocity'} [start] which part of a first impact a place in it is
 */

export {};
