// The classes of outcomes: what a cell's run or catch comes to, with a colour and a hatching for each.

import { partsOf, pixel } from '../../charts/theme.js';
import { isOfCatches } from './settings.js';

/** @typedef {'survives' | 'caught' | 'settles' | 'lies' | 'falls' | 'escapes' | 'none'} Class */

/**
 * Colours are those of the style sheet. Where two might be taken for each other without colours, a hatching tells them apart: its lines,
 * with their slope.
 * @type {Record<Class, {name: string, colour: 'survives' | 'falls' | 'rests' | null, slopes?: number[]}>}
 */
export const CLASSES = {
  survives: { name: 'survives', colour: 'survives' },
  settles: { name: 'comes to rest', colour: 'rests', slopes: [1, -1] },
  caught: { name: 'caught', colour: 'survives' },
  lies: { name: 'lies on an edge', colour: 'rests', slopes: [1, -1] },
  falls: { name: 'falls', colour: 'falls' },
  escapes: { name: 'not caught', colour: 'falls', slopes: [-1] },
  none: { name: 'no run', colour: null },
};

/** The classes of outcomes of runs, and of catches; all others of each fall, or are not caught. @type {Record<string, Class>} */
const OF_RUNS = { completed: 'survives', settled: 'settles', none: 'none' };
/** @type {Record<string, Class>} */
const OF_CATCHES = { held: 'caught', rests_on_edge: 'lies', fell: 'falls', none: 'none' };

/** @param {string} outcome its name in answers @param {string} quantity of the map @returns {Class} */
export const classOf = (outcome, quantity) =>
  isOfCatches(quantity) ? (OF_CATCHES[outcome] ?? 'escapes') : (OF_RUNS[outcome] ?? 'falls');

/** The classes that a legend always has. @param {string} quantity @returns {Class[]} */
export const expected = (quantity) => [isOfCatches(quantity) ? 'caught' : 'survives', 'falls'];

/** The pixel of a class; transparent where it has no colour. @param {Class} kind */
export function pixelOf(kind) {
  const { colour } = CLASSES[kind];
  return colour === null ? 0 : pixel(partsOf(colour));
}

/** Tints of runs that last for a while before they fall. */
const TINTS = 16;

/** Tints from runs that fall towards those that survive, as far as half of the way. */
export function fallTints() {
  const [from, to] = [partsOf('falls'), partsOf('survives')];
  return Array.from({ length: TINTS }, (_, index) => {
    const share = 0.5 * Math.sqrt(index / (TINTS - 1));
    return pixel(from.map((value, place) => Math.round(value + (to[place] - value) * share)));
  });
}

/** Side of a tile of a hatching, px. */
const TILE = 7;

/** Lines of some slopes as a pattern. @param {CanvasRenderingContext2D} context @param {number[]} slopes @param {string} ink @param {string} ground */
export function hatching(context, slopes, ink, ground = 'transparent') {
  const tile = Object.assign(document.createElement('canvas'), { width: TILE, height: TILE });
  const drawn = /** @type {CanvasRenderingContext2D} */ (tile.getContext('2d'));
  drawn.fillStyle = ground;
  drawn.fillRect(0, 0, TILE, TILE);
  drawn.strokeStyle = ink;
  drawn.lineWidth = 1.2;
  drawn.beginPath();
  for (const slope of slopes)
    for (const shift of [-TILE, 0, TILE]) {
      drawn.moveTo(shift, slope > 0 ? TILE : 0);
      drawn.lineTo(shift + TILE, slope > 0 ? 0 : TILE);
    }
  drawn.stroke();
  return /** @type {CanvasPattern} */ (context.createPattern(tile, 'repeat'));
}
