// The symbols of the methods, as in the server's pictures: shape and colour tell the same. Not for their colours.

/** Corners about the middle, in half widths. @type {Record<string, [number, number][]>} */
const OUTLINES = {
  map: [
    [-0.9, -0.4],
    [-0.4, -0.9],
    [0.4, -0.9],
    [0.9, -0.4],
    [0.9, 0.4],
    [0.4, 0.9],
    [-0.4, 0.9],
    [-0.9, 0.4],
  ],
  map_free: [
    [0, -1.2],
    [1.2, 0],
    [0, 1.2],
    [-1.2, 0],
  ],
  linear: [
    [0, -1.1],
    [1.1, 0.9],
    [-1.1, 0.9],
  ],
  extended: [
    [-1, -0.3],
    [1, -0.3],
    [1, 0.3],
    [-1, 0.3],
  ],
  adaptive: [
    [-0.9, -0.9],
    [0.9, -0.9],
    [0.9, 0.9],
    [-0.9, 0.9],
  ],
  runge_kutta_bisection: [
    [0, 1.1],
    [1.1, -0.9],
    [-1.1, -0.9],
  ],
  runge_kutta_secant: [
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
  ],
  runge_kutta_step_end: [
    [0, -0.4],
    [0.7, -1.1],
    [1.1, -0.7],
    [0.4, 0],
    [1.1, 0.7],
    [0.7, 1.1],
    [0, 0.4],
    [-0.7, 1.1],
    [-1.1, 0.7],
    [-0.4, 0],
    [-1.1, -0.7],
    [-0.7, -1.1],
  ],
  sampling: [
    [-0.35, -1.2],
    [0.35, -1.2],
    [0.35, -0.35],
    [1.2, -0.35],
    [1.2, 0.35],
    [0.35, 0.35],
    [0.35, 1.2],
    [-0.35, 1.2],
    [-0.35, 0.35],
    [-1.2, 0.35],
    [-1.2, -0.35],
    [-0.35, -0.35],
  ],
  time_stepping: [
    [-1.1, 0],
    [0.9, -1.1],
    [0.9, 1.1],
  ],
  penalty: [
    [1.1, 0],
    [-0.9, -1.1],
    [-0.9, 1.1],
  ],
};
const NAMES = Object.keys(OUTLINES);

/** The number of a method's look; one that is new here shares the last one. @param {string} method */
export const symbolOf = (method) => (NAMES.includes(method) ? NAMES.indexOf(method) : NAMES.length - 1);

/** @param {number} look */
export const outline = (look) => OUTLINES[NAMES[look]];
