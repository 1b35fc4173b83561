// Kicks with a direction: one press each.

import { h } from '../dom/elements.js';

/** @type {{sign: string, label: string, name: string, by: 1 | -1}[]} */
const DIRECTIONS = [
  { sign: '←', label: 'Kick to the left', name: 'x_dot', by: -1 },
  { sign: '→', label: 'Kick to the right', name: 'x_dot', by: 1 },
  { sign: '↑', label: 'Kick upwards', name: 'y_dot', by: 1 },
  { sign: '↺', label: 'Kick counter-clockwise', name: 'theta_dot', by: 1 },
  { sign: '↻', label: 'Kick clockwise', name: 'theta_dot', by: -1 },
];

/** @param {(name: string, sign: 1 | -1) => void} kick */
export const directions = (kick) =>
  DIRECTIONS.map(({ sign, label, name, by }) =>
    h('button', { type: 'button', 'aria-label': label, click: () => kick(name, by) }, sign),
  );
