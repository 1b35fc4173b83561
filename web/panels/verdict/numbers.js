// The numbers that carry a verdict, with their symbols and meanings.

import { number, quantity } from '../../dom/numbers.js';
import { symbol } from '../../dom/typeset.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {[string | Node, string | Node, string]} Row */

/** @param {Stability} answer @returns {Row[]} */
export const numbersOf = (answer) => [
  ...linearNumbers(answer),
  ...cubicNumbers(answer),
  ...lossNumbers(answer),
  ...runNumbers(answer),
];

/** @param {Stability} answer */
function linearNumbers({ linear }) {
  /** @type {Row[]} */
  const rows = [];
  if (!linear) return rows;
  const { tilt_gain: gain, energy_gain: energy, residue, rotation } = linear;
  if (gain) rows.push([symbol('κ'), number(gain.value), 'tilt gain']);
  if (gain?.critical != null) rows.push([symbol('κ_c'), number(gain.critical, 5), 'critical gain']);
  if (gain?.margin_above != null) {
    const margins = `${number(gain.margin_below, 3)} · ${number(gain.margin_above, 3)}`;
    rows.push(['margin', margins, 'to lower · upper end']);
  }
  if (residue != null) rows.push([symbol('R'), number(residue), `residue: ${linear.class}`]);
  if (rotation != null) {
    rows.push([symbol('σ'), quantity(rotation, 'rad'), 'rotation a bounce']);
  }
  if (linear.spectral_radius != null) rows.push(['max |λ|', number(linear.spectral_radius, 5), 'spectral radius']);
  if (energy && energy.value !== 0) {
    const value = `${quantity(energy.value, 's²/m²')} of ${number(energy.upper)}`;
    rows.push([symbol('κ_E'), value, `energy gain: λ ${number(energy.eigenvalue)}`]);
  }
  return rows;
}

/** @param {Stability} answer */
function cubicNumbers({ boundary, lyapunov }) {
  /** @type {Row[]} */
  const rows = [];
  if (boundary) rows.push([symbol('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`]);
  if (lyapunov) {
    const { coefficient, kind, escape_impacts: impacts } = lyapunov;
    const leaves = impacts === null ? '' : `, leaves in about ${number(impacts, 3)} impacts`;
    rows.push([symbol('ℓ'), quantity(coefficient, '/rad²', 3), `swing: ${kind}${leaves}`]);
  }
  return rows;
}

/** @param {Stability} answer @returns {Row[]} */
function lossNumbers({ loss_of_stability: losses }) {
  const others = (losses ?? []).filter(({ parameter }) => parameter !== 'table.tilt_gain');
  return others.map(({ parameter, value, kind, swing, heights }) => {
    let settles = '';
    if (swing !== null) settles = `, here to ±${quantity(swing, 'rad', 3)}`;
    else if (heights) settles = `, here to ${heights.map((height) => quantity(height, 'm', 3)).join(' and ')} in turn`;
    const meaning = `stability is lost there: ${kind}${settles}`;
    return parameter === 'table.feedback'
      ? ['gains ×', number(value, 4), meaning]
      : [symbol('κ_E'), quantity(value, 's²/m²', 4), meaning];
  });
}

/** @param {Stability} answer */
function runNumbers({ drift_speed: drift, nonlinear }) {
  /** @type {Row[]} */
  const rows = [];
  if (drift != null) rows.push([symbol('c'), quantity(drift, 'm/s', 3), 'drift of the whole']);
  if (!nonlinear) return rows;
  const { max_theta: largest, impacts, outcome, demand: load } = nonlinear;
  rows.push(['max |θ|', quantity(largest, 'rad'), `${number(impacts, 6)} impacts: ${outcome}`]);
  if (!load) return rows;
  const tilt = `${quantity(load.tilt, 'rad', 3)} · ${quantity(load.tilt_rate, 'rad/s', 3)}`;
  rows.push(['tilt', tilt, 'most tilt · tilt rate asked']);
  if (load.speed > 0 || load.stroke > 0) {
    const stroke = `${quantity(load.stroke, 'm', 3)} · ${quantity(load.speed, 'm/s', 3)}`;
    rows.push(['stroke', stroke, 'most stroke · speed asked']);
  }
  return rows;
}
