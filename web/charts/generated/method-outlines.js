// Written by `node tests/browser/shared-tables.js` from server/charts/figures/speed_accuracy.rs and openapi.yaml; not to be edited.

/** The corners of each method's symbol about its middle, x and y in half widths. */
export const OUTLINES = {
  map: '-0.9 -0.4, -0.4 -0.9, 0.4 -0.9, 0.9 -0.4, 0.9 0.4, 0.4 0.9, -0.4 0.9, -0.9 0.4',
  map_free: '0 -1.2, 1.2 0, 0 1.2, -1.2 0',
  linear: '0 -1.1, 1.1 0.9, -1.1 0.9',
  extended: '-1 -0.3, 1 -0.3, 1 0.3, -1 0.3',
  adaptive: '-0.9 -0.9, 0.9 -0.9, 0.9 0.9, -0.9 0.9',
  runge_kutta_bisection: '0 1.1, 1.1 -0.9, -1.1 -0.9',
  runge_kutta_secant: '-1 -1, 1 -1, -1 1, 1 1',
  runge_kutta_step_end: '0 -0.4, 0.7 -1.1, 1.1 -0.7, 0.4 0, 1.1 0.7, 0.7 1.1, 0 0.4, -0.7 1.1, -1.1 0.7, -0.4 0, -1.1 -0.7, -0.7 -1.1',
  sampling: '-0.35 -1.2, 0.35 -1.2, 0.35 -0.35, 1.2 -0.35, 1.2 0.35, 0.35 0.35, 0.35 1.2, -0.35 1.2, -0.35 0.35, -1.2 0.35, -1.2 -0.35, -0.35 -0.35',
  time_stepping: '-1.1 0, 0.9 -1.1, 0.9 1.1',
  penalty: '1.1 0, -0.9 -1.1, -0.9 1.1',
};
