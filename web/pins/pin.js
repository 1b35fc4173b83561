// A pinned run: the query that means it, and what the server computes for it.

import { get } from '../api/client.js';
import { merged } from '../api/scene-query.js';
import { playedAt, same } from '../api/scene-fields.js';
import { readLink } from '../app/link.js';
import { interventionQuery, interventionsOf } from '../run/interventions.js';
import { recordedRun } from '../timeline/recorded-run.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('contract').Trajectory} Trajectory */

/** Impacts of a pinned run. */
const IMPACTS = 1000;

export class Pin {
  /** @type {Trajectory | null} */
  answer = null;
  /** @type {import('../run/run-state.js').RunState | null} */
  run = null;
  /** Largest |θ| at an impact, rad; null for a point mass. @type {number | null} */
  largest = null;
  /** The reason why there is no answer, in words. */
  failure = '';
  /** True while its rod is on the stage of the run. */
  staged = false;
  query;
  scene;
  interventions;

  /**
   * @param {URLSearchParams} query a scene with interventions
   * @param {Scene} scene the same scene, with what was set only
   */
  constructor(query, scene) {
    this.query = query;
    this.scene = scene;
    this.interventions = interventionsOf(query);
  }

  /** @param {AbortSignal} signal */
  async compute(signal) {
    const answer = await get(`v1/trajectories?${this.query}&bounces=${IMPACTS}`, signal);
    this.answer = answer;
    this.run = recordedRun(answer, this.interventions);
    const angles = answer.impacts.theta.filter((/** @type {number | null} */ theta) => theta !== null);
    this.largest = angles.length > 0 ? Math.max(...angles.map(Math.abs)) : null;
  }

  /** The fields in which it differs from a scene. @param {Scene} scene @param {Field[]} fields */
  differences(scene, fields) {
    return fields.filter((field) => !same(playedAt(this.scene, field), playedAt(scene, field)));
  }
}

/**
 * A pin from its part of an address.
 * @param {URLSearchParams} query
 * @param {Field[]} fields
 * @param {Case[]} cases
 * @returns {{pin: Pin | null, dropped: string[]}}
 */
export function readPin(query, fields, cases) {
  const whole = new URLSearchParams(query);
  // Interventions are read with the run that they belong to.
  if ([...query.keys()].some((key) => key.startsWith('interventions.'))) whole.set('epoch_ms', '0');
  const { preset, changes, run, dropped } = readLink(`?${whole}`, fields, cases);
  const one = cases.find(({ name }) => name === preset);
  if (!one && Object.keys(changes).length === 0) return { pin: null, dropped };
  const kept = new URLSearchParams([...query].filter(([key]) => !key.startsWith('interventions.')));
  for (const [key, value] of interventionQuery(interventionsOf(run ?? new URLSearchParams()))) kept.set(key, value);
  return { pin: dropped.length > 0 ? null : new Pin(kept, merged(one?.scene ?? {}, changes)), dropped };
}
