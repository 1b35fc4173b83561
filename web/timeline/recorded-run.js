// A run that the server has computed to its end, drawn by the same closed forms as a live one.

import { effectiveGravity } from '../physics/flight.js';
import { fromColumns } from '../run/impact-messages.js';
import { RunState } from '../run/run-state.js';

/** @typedef {import('contract').Trajectory} Trajectory */

const nobody = () => {};
const UNWATCHED = { changed: nobody, struck: nobody, cleared: nobody, lost: nobody, refused: nobody, problem: nobody };

/**
 * The run of an answer of `/v1/trajectories`. In flight ẋ and θ̇ stay and ẏ falls by Gτ, so the states after the strikes follow from
 * those before the next ones.
 * @param {Trajectory} answer
 * @param {import('../run/interventions.js').Intervention[]} interventions
 */
export function recordedRun(answer, interventions) {
  const run = new RunState(UNWATCHED);
  const { outcome } = answer;
  const impacts = /** @type {Record<string, (number | null)[]>} */ (/** @type {unknown} */ (answer.impacts));
  const { release } = answer.scene;
  run.released = { ...answer.scene, derived: answer.derived };
  run.interventions = interventions;
  run.outcome = outcome;
  run.phase = 'ended';
  run.fall = {
    t: 0,
    x: release.x,
    y: release.height,
    theta: release.theta ?? 0,
    x_dot: release.x_dot,
    y_dot: release.y_dot,
    theta_dot: release.theta_dot ?? 0,
    duration: impacts.t[0] ?? 0,
  };
  const gravity = effectiveGravity(run.released);
  const next = (/** @type {(number | null)[]} */ column) => [...column.slice(1), null];
  const columns = {
    ...impacts,
    x_dot_after: next(impacts.x_dot),
    y_dot_after: next(impacts.y_dot).map((y_dot, row) =>
      y_dot === null ? null : y_dot + gravity * (impacts.flight_time[row] ?? 0),
    ),
    theta_dot_after: next(impacts.theta_dot ?? []),
  };
  for (const impact of fromColumns(/** @type {any} */ (columns))) run.impacts.append(impact);
  run.rebuild();
  return run;
}
