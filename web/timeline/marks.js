// The moments of a run that its time line marks: kicks, changes, the end.

import { line } from '../charts/axes.js';
import { drawMark } from '../charts/marks.js';
import { theme } from '../charts/theme.js';
import { quantity } from '../dom/numbers.js';
import { VELOCITIES } from '../run/interventions.js';

/** @typedef {{n: number, t: number, kind: 'kick' | 'set' | 'fell' | 'kept' | 'over', words: string}} Mark */

/** Shape and colour of a moment. */
const MOMENTS = /** @type {const} */ ({
  kick: [3, 'strike'],
  set: [1, 'series-1'],
  kept: [0, 'good'],
  over: [0, 'muted'],
});

/** A kick is a triangle, a change a square, a fall a cross, another end a dot. @param {CanvasRenderingContext2D} context @param {Mark['kind']} kind @param {number} x @param {number} y */
export function drawMoment(context, kind, x, y) {
  const colours = theme();
  if (kind === 'fell') {
    context.lineWidth = 2.5;
    line(context, colours.strike, x - 4, y + 4, x + 4, y + 12);
    line(context, colours.strike, x - 4, y + 12, x + 4, y + 4);
    return;
  }
  const [mark, colour] = MOMENTS[kind];
  drawMark(context, mark, x, y, 3, colours[colour]);
}

/** @param {number} value @param {string} unit */
const signed = (value, unit) => (value > 0 ? '+' : '') + quantity(value, unit);

/**
 * In the order of the run; those of impacts that are not kept are left out.
 * @param {import('../run/run-state.js').RunState} run
 * @param {import('../api/scene-fields.js').Field[]} fields
 * @returns {Mark[]}
 */
export function marksOf(run, fields) {
  const { impacts, interventions, outcome, fate } = run;
  /** @type {Mark[]} */
  const marks = [];
  for (const { impact: n, set, kick, guide } of interventions) {
    const place = impacts.lastUpTo('n', n);
    if (place < impacts.begin || impacts.at('n', place) !== n) continue;
    const t = impacts.at('t', place);
    const kicks = Object.entries(kick).map(
      ([name, by]) => `${signed(by, VELOCITIES[name].unit)} ${VELOCITIES[name].sign}`,
    );
    const sets = Object.entries(set).map(([path, value]) => {
      const field = fields.find((one) => one.field === path);
      const shown = typeof value === 'number' ? quantity(value, field?.unit ?? null) : value;
      return `${field?.title.toLowerCase() ?? path} ${shown}`;
    });
    if (kicks.length > 0) marks.push({ n, t, kind: 'kick', words: `kick ${kicks.join(', ')}` });
    const guides = new Set(Object.keys(guide).map((name) => name.split('.')[0]));
    for (const words of guides) marks.push({ n, t, kind: 'set', words });
    if (sets.length > 0) marks.push({ n, t, kind: 'set', words: sets.join(', ') });
  }
  if (outcome && fate) marks.push({ n: outcome.bounces, t: outcome.t, kind: fate, words: 'the end of the run' });
  return marks;
}
