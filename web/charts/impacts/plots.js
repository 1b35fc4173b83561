// The plots of a run's impacts: two phase planes and the energy.

import { ImpactPlot } from './impact-plot.js';
import { number } from '../../dom/numbers.js';
import { derivedOf } from '../../physics/body.js';

/** @typedef {import('../../run/impacts.js').Impacts} Impacts */

const HINT = 'Every bounce becomes a dot here';

/** @param {Impacts} impacts */
export const anglePlane = (impacts) =>
  new ImpactPlot(impacts, {
    id: 'plane-angle',
    start: 'angle',
    title: 'Angle ⟨θ, θ̇⟩',
    about: 'Tilt and spin just before each bounce. A closed loop is balance.',
    hint: HINT,
    lacking: 'A point mass has no spin',
    spoken: 'Phase plane of angle θ and angular velocity θ̇',
    x: { column: 'theta', symmetric: true, span: 0.04 },
    y: { column: 'theta_dot', symmetric: true, span: 0.1 },
    listed: ['theta', 'theta_dot', 'alpha'],
  });

/** @param {Impacts} impacts */
export const velocityPlane = (impacts) =>
  new ImpactPlot(impacts, {
    id: 'plane-velocity',
    start: 'velocity',
    title: 'Velocity ⟨ẋ, ẏ⟩',
    about: 'Velocity of the centre of gravity just before each bounce.',
    hint: HINT,
    spoken: 'Phase plane of the velocities ẋ and ẏ of the centre of gravity',
    x: { column: 'x_dot', symmetric: true, span: 0.04 },
    y: { column: 'y_dot', span: 0.02 },
    listed: ['x_dot', 'y_dot', 'contact_velocity'],
  });

/**
 * The energy at the impacts, with its target.
 * @param {Impacts} impacts
 * @param {() => import('../../api/scene-fields.js').Scene | null} scene with what follows from it
 */
export function energyPlot(impacts, scene) {
  /** The wanted energy G·y* with energy feedback; the first energy where a bounce keeps it. */
  const levels = () => {
    const now = scene();
    if (!now) return [];
    const { target } = derivedOf(now);
    if (target) return [{ value: target.energy, name: `target G y* = ${number(target.energy)} m²/s²` }];
    const first = impacts.end > 0 ? impacts.at('energy', impacts.begin) : NaN;
    return Number.isFinite(first) && now.table?.strike !== 'still'
      ? [{ value: first, name: `released with ${number(first)} m²/s²` }]
      : [];
  };
  return new ImpactPlot(impacts, {
    id: 'energy',
    title: 'Energy',
    about: 'Per unit mass just before each bounce, with its target.',
    hint: 'One dot per bounce, with its target',
    spoken: 'Energy per unit mass at each impact',
    levels,
    x: { column: 'n', from: 0, span: 16 },
    y: { column: 'energy', span: 0.4 },
    listed: ['energy', 'flight_time'],
  });
}
