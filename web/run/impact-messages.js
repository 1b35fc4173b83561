// Impacts of the live stream, alone or in columns, as rows of the page's table.

import { COLUMNS } from './impacts.js';

/** @typedef {import('./impacts.js').Impact} Impact */

/** Modes of contact by their number in the column `mode`, which is NaN where the message names none. */
export const MODES = ['frictionless', 'slide', 'stick', 'reverse_slide', 'slide_through'];

/** @param {unknown} value */
const real = (value) => (typeof value === 'number' ? value : NaN);

/** @param {string | null} name */
function modeOf(name) {
  const mode = MODES.indexOf(name ?? '');
  return mode < 0 ? NaN : mode;
}

/**
 * @param {import('contract').LiveImpact} message
 * @returns {Impact}
 */
export function fromMessage(message) {
  const { before, after, table_velocity: table, alpha } = message;
  return {
    n: message.n,
    t: message.t,
    x: before.x,
    theta: real(before.theta),
    x_dot: before.x_dot,
    y_dot: before.y_dot,
    theta_dot: real(before.theta_dot),
    x_dot_after: real(after?.x_dot),
    y_dot_after: real(after?.y_dot),
    theta_dot_after: real(after?.theta_dot),
    alpha: real(alpha),
    flight_time: real(message.flight_time),
    energy: real(message.energy),
    contact_speed: real(message.contact_speed),
    table_speed: table ? table.y * Math.cos(alpha) - table.x * Math.sin(alpha) : NaN,
    mode: modeOf(message.contact_mode),
    clearance: real(message.clearance),
    series: 0,
  };
}

/**
 * @param {Record<string, (number | null)[]>} columns of a message of type `impacts`
 * @returns {Impact[]}
 */
export function fromColumns(columns) {
  return columns.n.map(
    (_, row) =>
      /** @type {Impact} */ (
        Object.fromEntries(COLUMNS.map((name) => [name, name === 'series' ? 0 : real(columns[name]?.[row])]))
      ),
  );
}
