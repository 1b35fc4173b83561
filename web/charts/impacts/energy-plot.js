// The energy at the impacts, with its target.

import { ImpactPlot } from './impact-plot.js';
import { fixed, number } from '../../dom/numbers.js';
import { derivedOf } from '../../physics/body.js';

/**
 * @param {import('../../run/impacts.js').Impacts} impacts
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
    x: { column: 'n', name: 'bounce', from: 0, span: 16 },
    y: { column: 'energy', name: 'E / m² s⁻²', span: 0.4 },
    head: ['bounce', 't / s', 'energy / m² s⁻²', 'flight time / s'],
    cells: (all, place) => [
      String(all.at('n', place)),
      fixed(all.at('t', place), 4),
      fixed(all.at('energy', place), 6),
      fixed(all.at('flight_time', place), 6),
    ],
    readout: (all, place) => `n ${all.at('n', place)}   E ${fixed(all.at('energy', place), 4)} m²/s²`,
  });
}
