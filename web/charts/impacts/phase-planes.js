// The two phase planes: the states they pair, and their names.

import { ImpactPlot } from './impact-plot.js';
import { fixed, fixedIn, fixedQuantity } from '../../dom/numbers.js';

/** @typedef {import('../../run/impacts.js').Impacts} Impacts */

const HINT = 'Every bounce becomes a dot here';

/** @param {Impacts} impacts */
export function anglePlane(impacts) {
  return new ImpactPlot(impacts, {
    id: 'plane-angle',
    start: 'angle',
    title: 'Angle ⟨θ, θ̇⟩',
    about: 'Tilt and spin just before each bounce. A closed loop is balance.',
    hint: HINT,
    lacking: 'A point mass has no spin',
    spoken: 'Phase plane of angle θ and angular velocity θ̇',
    x: { column: 'theta', name: 'θ / rad', symmetric: true, span: 0.04 },
    y: { column: 'theta_dot', name: 'θ̇ / rad s⁻¹', symmetric: true, span: 0.1 },
    head: ['bounce', 't / s', 'θ / rad', 'θ̇ / rad s⁻¹', 'α / rad'],
    cells: (all, place) => [
      String(all.at('n', place)),
      fixed(all.at('t', place), 4),
      fixedIn(all.at('theta', place), 'rad', 6),
      fixedIn(all.at('theta_dot', place), 'rad/s', 6),
      fixedIn(all.at('alpha', place), 'rad', 6),
    ],
    readout: (all, place) =>
      `n ${all.at('n', place)}   θ ${fixedQuantity(all.at('theta', place), 'rad', 4)}   θ̇ ${fixedQuantity(all.at('theta_dot', place), 'rad/s', 3)}`,
  });
}

/** @param {Impacts} impacts */
export function velocityPlane(impacts) {
  return new ImpactPlot(impacts, {
    id: 'plane-velocity',
    start: 'velocity',
    title: 'Velocity ⟨ẋ, ẏ⟩',
    about: 'Velocity of the centre of gravity just before each bounce.',
    hint: HINT,
    spoken: 'Phase plane of the velocities ẋ and ẏ of the centre of gravity',
    x: { column: 'x_dot', name: 'ẋ / m s⁻¹', symmetric: true, span: 0.04 },
    y: { column: 'y_dot', name: 'ẏ / m s⁻¹', span: 0.02 },
    head: ['bounce', 't / s', 'ẋ / m s⁻¹', 'ẏ / m s⁻¹', 'contact velocity / m s⁻¹'],
    cells: (all, place) => [
      String(all.at('n', place)),
      fixed(all.at('t', place), 4),
      fixed(all.at('x_dot', place), 6),
      fixed(all.at('y_dot', place), 6),
      fixed(all.at('contact_velocity', place), 6),
    ],
    readout: (all, place) =>
      `n ${all.at('n', place)}   ẋ ${fixed(all.at('x_dot', place), 4)} m/s   ẏ ${fixed(all.at('y_dot', place), 4)} m/s`,
  });
}
