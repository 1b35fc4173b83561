// The numbers that carry a verdict, with their symbols and meanings.

import { marginOf } from '../../api/margins.js';
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
function linearNumbers(answer) {
  const { linear } = answer;
  /** @type {Row[]} */
  const rows = [];
  if (!linear) return rows;
  const [gain, energy] = /** @type {const} */ (['table.tilt_gain', 'table.energy_gain']).map((field) =>
    marginOf(answer, field),
  );
  const { residue, rotation } = linear;
  if (gain) rows.push([symbol('κ'), number(gain.value), 'tilt gain']);
  if (gain?.above) rows.push([symbol('κ_c'), number(gain.above.limit, 5), 'critical gain']);
  if (gain?.below && gain.above) {
    const margins = `${number(gain.below.margin, 3)} · ${number(gain.above.margin, 3)}`;
    rows.push(['margin', margins, 'to lower · upper end']);
  }
  if (residue != null) rows.push([symbol('R'), number(residue), `residue: ${linear.kind}`]);
  if (rotation != null) {
    rows.push([symbol('σ'), quantity(rotation, 'rad'), 'rotation a bounce']);
  }
  if (linear.spectral_radius != null) rows.push(['max |λ|', number(linear.spectral_radius, 5), 'spectral radius']);
  if (energy && energy.value !== 0) {
    const value = `${quantity(energy.value, 's²/m²')} of ${number(energy.above?.limit)}`;
    rows.push([symbol('κ_E'), value, `energy gain: λ ${number(linear.energy_eigenvalue)}`]);
  }
  return rows;
}

/** @param {Stability} answer */
function cubicNumbers({ boundary, lyapunov }) {
  /** @type {Row[]} */
  const rows = [];
  if (boundary) rows.push([symbol('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`]);
  if (lyapunov) {
    const { coefficient, kind, escape_bounces: bounces } = lyapunov;
    const leaves = bounces === null ? '' : `, leaves in about ${number(bounces, 3)} bounces`;
    rows.push([symbol('ℓ'), quantity(coefficient, '/rad²', 3), `swing: ${kind}${leaves}`]);
  }
  return rows;
}

/** @param {Stability} answer @returns {Row[]} */
function lossNumbers({ loss_of_stability: losses }) {
  const others = (losses ?? []).filter(({ field }) => field !== 'table.tilt_gain');
  return others.map(({ field, value, kind, swing, heights }) => {
    let settles = '';
    if (swing !== null) settles = `, here to ±${quantity(swing, 'rad', 3)}`;
    else if (heights) settles = `, here to ${heights.map((height) => quantity(height, 'm', 3)).join(' and ')} in turn`;
    const meaning = `stability is lost there: ${kind}${settles}`;
    return field === 'table.feedback'
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
  const { max_theta: largest, outcome, demand: load } = nonlinear;
  rows.push(['max |θ|', quantity(largest, 'rad'), `${number(outcome.bounces, 6)} bounces: ${outcome.kind}`]);
  if (!load) return rows;
  const tilt = `${quantity(load.tilt, 'rad', 3)} · ${quantity(load.tilt_rate, 'rad/s', 3)}`;
  rows.push(['tilt', tilt, 'most tilt · tilt rate asked']);
  if (load.speed > 0 || load.stroke > 0) {
    const stroke = `${quantity(load.stroke, 'm', 3)} · ${quantity(load.speed, 'm/s', 3)}`;
    rows.push(['stroke', stroke, 'most stroke · speed asked']);
  }
  return rows;
}
