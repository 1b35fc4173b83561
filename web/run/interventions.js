// A run in its query: its interventions, and the range of its speed.

import { parameters } from '../api/scene-query.js';

/** The range of a run's speed, in times real time. */
export const SLOWEST = 0.05;
export const FASTEST = 20;

/** The velocities that a kick changes, with the usual size of one. @type {Record<string, {way: string, sign: string, unit: string, usual: number}>} */
export const VELOCITIES = {
  theta_dot: { way: 'spin', sign: 'θ̇', unit: 'rad/s', usual: 0.5 },
  x_dot: { way: 'sideways', sign: 'ẋ', unit: 'm/s', usual: 0.1 },
  y_dot: { way: 'upwards', sign: 'ẏ', unit: 'm/s', usual: 0.1 },
};

/** @param {URLSearchParams} query @returns {Intervention[]} in their order */
export function interventionsOf(query) {
  /** @type {Map<number, Intervention>} */
  const found = new Map();
  for (const [key, text] of query) {
    const match = /^interventions\.(\d+)\.(impact$|set\.|kick\.|catch\.|throw\.)(.*?)(\.\d+)?$/.exec(key);
    if (!match) continue;
    const index = Number(match[1]);
    const one = found.get(index) ?? { impact: 0, set: {}, kick: {}, guide: {} };
    found.set(index, one);
    const value = Number.isFinite(Number(text)) ? Number(text) : text;
    if (match[2] === 'impact') one.impact = Number(text);
    else if (match[2] === 'catch.' || match[2] === 'throw.') one.guide[match[2] + match[3] + (match[4] ?? '')] = text;
    else if (match[4]) one.set[match[3]] = [.../** @type {number[]} */ (one.set[match[3]] ?? []), Number(text)];
    else if (match[2] === 'set.') one.set[match[3]] = value;
    else one.kick[match[3]] = Number(text);
  }
  return [...found.keys()].sort((a, b) => a - b).map((index) => /** @type {Intervention} */ (found.get(index)));
}

/** Interventions as a query. @param {Intervention[]} interventions */
export const interventionQuery = (interventions) =>
  new URLSearchParams(
    interventions.flatMap(({ impact, set, kick, guide }, index) => [
      [`interventions.${index}.impact`, String(impact)],
      ...Object.entries(set).flatMap(([path, value]) => parameters(`interventions.${index}.set.${path}`, value)),
      ...Object.entries(kick).map(([name, value]) => [`interventions.${index}.kick.${name}`, String(value)]),
      ...Object.entries(guide).map(([name, value]) => [`interventions.${index}.${name}`, value]),
    ]),
  );
