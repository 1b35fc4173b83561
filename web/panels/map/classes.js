// The classes of outcomes: what a cell's run or catch comes to, with a colour and a hatching for each.

import { COLOURS, PIXELS } from '../../charts/cividis.js';
import { isOfCatches } from './settings.js';

/** @typedef {'survives' | 'caught' | 'settles' | 'lies' | 'falls' | 'escapes' | 'none'} Class */

/**
 * Colours are places in cividis. A hatching tells the classes apart without colours: its lines, with their slope.
 * @type {Record<Class, {name: string, colour: number | null, slopes: number[]}>}
 */
export const CLASSES = {
  survives: { name: 'survives', colour: COLOURS - 1, slopes: [] },
  settles: { name: 'comes to rest', colour: COLOURS / 2, slopes: [1, -1] },
  caught: { name: 'caught', colour: COLOURS - 1, slopes: [] },
  lies: { name: 'lies on an edge', colour: COLOURS / 2, slopes: [1, -1] },
  falls: { name: 'falls', colour: 0, slopes: [1] },
  escapes: { name: 'not caught', colour: COLOURS / 4, slopes: [-1] },
  none: { name: 'no run', colour: null, slopes: [] },
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
export const pixelOf = (kind) => PIXELS[CLASSES[kind].colour ?? -1] ?? 0;

/** Side of a tile of a hatching, px. */
const TILE = 7;

/** @param {string | null} ground @param {string} ink @param {number[]} slopes */
function tileOf(ground, ink, slopes) {
  const tile = Object.assign(document.createElement('canvas'), { width: TILE, height: TILE });
  const context = /** @type {CanvasRenderingContext2D} */ (tile.getContext('2d'));
  if (ground) {
    context.fillStyle = ground;
    context.fillRect(0, 0, TILE, TILE);
  }
  context.strokeStyle = ink;
  context.lineWidth = 1.2;
  context.beginPath();
  for (const slope of slopes)
    for (const shift of [-TILE, 0, TILE]) {
      context.moveTo(shift, slope > 0 ? TILE : 0);
      context.lineTo(shift + TILE, slope > 0 ? 0 : TILE);
    }
  context.stroke();
  return tile;
}

/** The hatching over the colour of a class; null for none. @param {CanvasRenderingContext2D} context @param {Class} kind */
export function hatchingOf(context, kind) {
  const { slopes } = CLASSES[kind];
  return slopes.length === 0 ? null : context.createPattern(tileOf(null, 'rgb(255 255 255 / 0.42)', slopes), 'repeat');
}

/** The pattern of cells without a value. @param {CanvasRenderingContext2D} context @param {import('../../charts/theme.js').Colours} colours */
export const blank = (context, colours) =>
  context.createPattern(tileOf(colours.faint, colours.muted, [1]), 'repeat') ?? colours.faint;
