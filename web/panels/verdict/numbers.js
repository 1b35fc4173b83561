// The numbers that carry a verdict, with their symbols and meanings.

import { marginOf } from '../../api/answers.js';
import { number, quantity } from '../../dom/numbers.js';
import { sign } from '../parts.js';

/** @typedef {import('contract').Stability} Stability */

/** Names, values and meanings, for a list of numbers. @param {Stability} answer */
export const numbersOf = (answer) =>
  [...linearNumbers(answer), ...cubicNumbers(answer), ...lossNumbers(answer), ...runNumbers(answer)].filter(
    (row) => row !== null,
  );

/** @param {Stability} answer */
function linearNumbers(answer) {
  const { linear } = answer;
  if (!linear) return [];
  const gain = marginOf(answer, 'table.tilt_gain');
  const energy = marginOf(answer, 'table.energy_gain');
  const { residue, rotation, spectral_radius: radius } = linear;
  const { below, above } = gain ?? {};
  const steered = energy ? `${quantity(energy.value, 's²/m²')} of ${number(energy.above?.limit)}` : '';
  return [
    gain ? [sign('κ'), number(gain.value), 'tilt gain'] : null,
    above ? [sign('κ_c'), number(above.limit, 5), 'critical gain'] : null,
    below && above
      ? ['margin', `${number(below.margin, 3)} · ${number(above.margin, 3)}`, 'to lower · upper end']
      : null,
    residue != null ? [sign('R'), number(residue), `residue: ${linear.kind}`] : null,
    rotation != null ? [sign('σ'), quantity(rotation, 'rad'), 'rotation a bounce'] : null,
    radius != null ? ['max |λ|', number(radius, 5), 'spectral radius'] : null,
    energy?.value ? [sign('κ_E'), steered, `energy gain: λ ${number(linear.energy_eigenvalue)}`] : null,
  ];
}

/** @param {Stability} answer */
function cubicNumbers({ boundary, lyapunov }) {
  const { coefficient = null, kind = '', escape_bounces: bounces = null } = lyapunov ?? {};
  const leaves = bounces === null ? '' : `, leaves in about ${number(bounces, 3)} bounces`;
  return [
    boundary ? [sign('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`] : null,
    lyapunov ? [sign('ℓ'), quantity(coefficient, '/rad²', 3), `swing: ${kind}${leaves}`] : null,
  ];
}

/** @param {Stability} answer */
function lossNumbers({ loss_of_stability: losses }) {
  const others = (losses ?? []).filter(({ field }) => field !== 'table.tilt_gain');
  return others.map(({ field, value, kind, swing, heights }) => {
    const bounds = heights?.map((height) => quantity(height, 'm', 3)).join(' and ');
    const to = swing !== null ? `±${quantity(swing, 'rad', 3)}` : bounds && `${bounds} in turn`;
    const meaning = `stability is lost there: ${kind}${to ? `, here to ${to}` : ''}`;
    return field === 'table.feedback'
      ? ['gains ×', number(value, 4), meaning]
      : [sign('κ_E'), quantity(value, 's²/m²', 4), meaning];
  });
}

/** @param {Stability} answer */
function runNumbers({ drift_speed: drift, nonlinear: { max_theta: largest, outcome, demand: load } }) {
  const tilt = load && `${quantity(load.tilt, 'rad', 3)} · ${quantity(load.tilt_rate, 'rad/s', 3)}`;
  const stroke = load && `${quantity(load.stroke, 'm', 3)} · ${quantity(load.speed, 'm/s', 3)}`;
  const moves = load && (load.speed > 0 || load.stroke > 0);
  return [
    drift != null ? [sign('c'), quantity(drift, 'm/s', 3), 'drift of the whole'] : null,
    ['max |θ|', quantity(largest, 'rad'), `${number(outcome.bounces, 6)} bounces: ${outcome.kind}`],
    tilt ? ['tilt', tilt, 'most tilt · tilt rate asked'] : null,
    moves ? ['stroke', stroke, 'most stroke · speed asked'] : null,
  ];
}
