// The first flights of the typed scene, as a faint path before it is released.

import { theme } from '../charts/theme.js';

/** Flights that are drawn, and points along each. */
const FLIGHTS = 6;
const POINTS = 20;

/**
 * The path of the centre of gravity, flight after flight, in metres. A flight is a parabola that is known from its end.
 * @param {import('contract').Trajectory} answer
 * @returns {[number, number][][]}
 */
export function firstFlights({ impacts, derived }) {
  const { gravity_in_plane: gravity, contact_distance: l } = derived;
  const count = Math.min(FLIGHTS, impacts.n.length);
  return Array.from({ length: count }, (_, end) => {
    const [t, x, theta, x_dot, y_dot, clearance] = [
      impacts.t,
      impacts.x,
      impacts.theta,
      impacts.x_dot,
      impacts.y_dot,
      impacts.clearance,
    ].map((column) => Number(column[end]));
    const y = (l && l * Math.cos(theta)) + clearance;
    const length = t - (end > 0 ? Number(impacts.t[end - 1]) : 0);
    return Array.from({ length: POINTS + 1 }, (_, point) => {
      // Before the impact.
      const s = length * (1 - point / POINTS);
      return /** @type {[number, number]} */ ([x - x_dot * s, y - y_dot * s - (gravity * s * s) / 2]);
    });
  }).filter((flight) => flight.flat().every(Number.isFinite));
}

/**
 * Later flights are fainter; a dot marks each impact.
 * @param {CanvasRenderingContext2D} context
 * @param {import('./camera.js').Scale} scale
 * @param {[number, number][][]} flights
 */
export function drawPreview(context, scale, flights) {
  context.save();
  context.strokeStyle = context.fillStyle = theme().accent;
  context.lineWidth = 1.5;
  flights.forEach((flight, index) => {
    context.globalAlpha = 0.5 * (1 - index / (FLIGHTS + 1));
    context.beginPath();
    for (const [x, y] of flight) context.lineTo(scale.x(x), scale.y(y));
    context.stroke();
    const [x, y] = /** @type {[number, number]} */ (flight.at(-1));
    context.beginPath();
    context.arc(scale.x(x), scale.y(y), 2.5, 0, 2 * Math.PI);
    context.fill();
  });
  context.restore();
}
