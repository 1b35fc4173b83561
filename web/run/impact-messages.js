// Impacts of the live stream, alone or in columns, as rows of the page's table.

import { alongNormal } from '../physics/table.js';

/** @typedef {import('./impacts.js').Impact} Impact */
/** @typedef {import('contract').LiveImpacts['columns']} Columns */
/** @typedef {{[name in keyof Columns]: Columns[name][number]}} FlatImpact one row of the columns */

/** Modes of contact by their number in the column `mode`, which is NaN where the message names none. */
export const MODES = ['frictionless', 'slide', 'stick', 'reverse_slide', 'slide_through'];

/** @param {unknown} value */
const real = (value) => (typeof value === 'number' ? value : NaN);

/** @param {string | null} name */
function modeOf(name) {
  const mode = MODES.indexOf(name ?? '');
  return mode < 0 ? NaN : mode;
}

/** @param {FlatImpact} flat @returns {Impact} */
export function impactOf(flat) {
  const { alpha, table_velocity_x: x, table_velocity_y: y } = flat;
  return {
    n: flat.n,
    t: flat.t,
    x: flat.x,
    theta: real(flat.theta),
    x_dot: flat.x_dot,
    y_dot: flat.y_dot,
    theta_dot: real(flat.theta_dot),
    x_dot_after: real(flat.x_dot_after),
    y_dot_after: real(flat.y_dot_after),
    theta_dot_after: real(flat.theta_dot_after),
    alpha: real(alpha),
    flight_time: real(flat.flight_time),
    energy: real(flat.energy),
    contact_velocity: real(flat.contact_velocity),
    table_speed: x === null || y === null ? NaN : alongNormal({ x, y }, alpha),
    mode: modeOf(flat.contact_mode),
    clearance: real(flat.clearance),
    series: 0,
  };
}

/** @param {Columns} columns of a message of type `impacts` @returns {Impact[]} */
export const fromColumns = (columns) =>
  columns.n.map((_, row) => {
    const flat = Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, values[row]]));
    return impactOf(/** @type {FlatImpact} */ (/** @type {unknown} */ (flat)));
  });
