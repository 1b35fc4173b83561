// Runs beside the live one: computed by the server to their end, drawn by the same closed forms and on the same clock.

import { get } from '../api/client.js';
import { arcFrom, decay, effectiveGravity, windPush } from '../physics/flight.js';
import { fromColumns } from '../run/impacts.js';
import { interventionsOf } from '../run/interventions.js';
import { RunState } from '../run/run-state.js';

/**
 * The run that the server computes for a query, for so many bounces at most. In flight ẋ and θ̇ stay or decay and ẏ falls, so the states
 * after the strikes follow from those before the next ones.
 * @param {URLSearchParams} query
 * @param {number} bounces
 * @param {AbortSignal} signal
 */
export async function computedRun(query, bounces, signal) {
  /** @type {Trajectory} */
  const answer = await get(`v1/trajectories?${query}&bounces=${bounces}`, signal);
  const run = new RunState(answer.impacts.n.length);
  const impacts = /** @type {Record<string, (number | null)[]>} */ (/** @type {unknown} */ (answer.impacts));
  const { air } = answer.scene;
  run.released = { ...answer.scene, derived: answer.derived };
  run.interventions = interventionsOf(query);
  run.outcome = answer.outcome;
  run.phase = 'ended';
  run.fall = arcFrom(answer.scene, impacts.t[0] ?? 0);
  /** @param {(number | null)[]} column @param {number | undefined} rate @param {number} pull */
  const after = (column, rate, pull = 0) =>
    [...column.slice(1), null].map((speed, row) => {
      const { left, way } = decay(rate, impacts.flight_time[row] ?? 0);
      return speed === null ? null : (speed + pull * way) / left;
    });
  const columns = {
    ...impacts,
    x_dot_after: after(impacts.x_dot, air?.drag, -windPush(air)),
    y_dot_after: after(impacts.y_dot, air?.drag, effectiveGravity(run.released)),
    theta_dot_after: after(impacts.theta_dot ?? [], air?.rotation_drag),
  };
  for (const impact of fromColumns(/** @type {any} */ (columns))) run.impacts.append(impact);
  run.rebuild();
  return run;
}

/** The dots of the other runs in the planes, and their rods on the stage of the live one. @param {Page} page @returns {Page['others']} */
export function bringOthers({ plots, view }) {
  /** @type {Map<string, Other>} */
  const others = new Map();
  return (id, other) => {
    if (!other && !others.has(id)) return;
    if (other) others.set(id, other);
    else others.delete(id);
    const all = [...others.values()];
    for (const plot of plots) plot.references(all);
    view.others = all.filter(({ staged }) => staged);
    view.redraw();
  };
}
