// The numbers that carry a verdict, with their symbols and meanings.

import { marginOf } from '../../api/answers.js';
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

/** The rows that there are. @param {(Row | false | null | undefined)[]} rows */
const present = (rows) => /** @type {Row[]} */ (rows.filter(Boolean));

/** @param {Stability} answer */
function linearNumbers(answer) {
  const { linear } = answer;
  if (!linear) return [];
  const [gain, energy] = /** @type {const} */ (['table.tilt_gain', 'table.energy_gain']).map((field) =>
    marginOf(answer, field),
  );
  const { residue, rotation, spectral_radius: radius } = linear;
  const { below, above } = gain ?? {};
  const margins = below && above && `${number(below.margin, 3)} · ${number(above.margin, 3)}`;
  const steered = energy && `${quantity(energy.value, 's²/m²')} of ${number(energy.above?.limit)}`;
  return present([
    gain && [symbol('κ'), number(gain.value), 'tilt gain'],
    above && [symbol('κ_c'), number(above.limit, 5), 'critical gain'],
    margins ? ['margin', margins, 'to lower · upper end'] : null,
    residue != null && [symbol('R'), number(residue), `residue: ${linear.kind}`],
    rotation != null && [symbol('σ'), quantity(rotation, 'rad'), 'rotation a bounce'],
    radius != null && ['max |λ|', number(radius, 5), 'spectral radius'],
    energy &&
      energy.value !== 0 && [symbol('κ_E'), steered ?? '', `energy gain: λ ${number(linear.energy_eigenvalue)}`],
  ]);
}

/** @param {Stability} answer */
function cubicNumbers({ boundary, lyapunov }) {
  const { coefficient = null, kind = '', escape_bounces: bounces = null } = lyapunov ?? {};
  const leaves = bounces === null ? '' : `, leaves in about ${number(bounces, 3)} bounces`;
  return present([
    boundary && [symbol('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`],
    lyapunov && [symbol('ℓ'), quantity(coefficient, '/rad²', 3), `swing: ${kind}${leaves}`],
  ]);
}

/** @param {Stability} answer @returns {Row[]} */
function lossNumbers({ loss_of_stability: losses }) {
  const others = (losses ?? []).filter(({ field }) => field !== 'table.tilt_gain');
  return others.map(({ field, value, kind, swing, heights }) => {
    const bounds = heights?.map((height) => quantity(height, 'm', 3)).join(' and ');
    const to = swing !== null ? `±${quantity(swing, 'rad', 3)}` : bounds && `${bounds} in turn`;
    const meaning = `stability is lost there: ${kind}${to ? `, here to ${to}` : ''}`;
    return field === 'table.feedback'
      ? ['gains ×', number(value, 4), meaning]
      : [symbol('κ_E'), quantity(value, 's²/m²', 4), meaning];
  });
}

/** @param {Stability} answer */
function runNumbers({ drift_speed: drift, nonlinear }) {
  const { max_theta: largest, outcome, demand: load } = nonlinear;
  const pair = (
    /** @type {number} */ one,
    /** @type {string} */ unit,
    /** @type {number} */ other,
    /** @type {string} */ otherUnit,
  ) => `${quantity(one, unit, 3)} · ${quantity(other, otherUnit, 3)}`;
  const moves = load && (load.speed > 0 || load.stroke > 0);
  return present([
    drift != null && [symbol('c'), quantity(drift, 'm/s', 3), 'drift of the whole'],
    ['max |θ|', quantity(largest, 'rad'), `${number(outcome.bounces, 6)} bounces: ${outcome.kind}`],
    load && ['tilt', pair(load.tilt, 'rad', load.tilt_rate, 'rad/s'), 'most tilt · tilt rate asked'],
    moves && ['stroke', pair(load.stroke, 'm', load.speed, 'm/s'), 'most stroke · speed asked'],
  ]);
}
