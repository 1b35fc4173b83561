// The classes of outcomes: what a cell's run or catch comes to, with a colour and a hatching for each.

import { theme } from '../../charts/theme.js';
import { isOfCatches } from './settings.js';

/** @typedef {'survives' | 'caught' | 'settles' | 'lies' | 'falls' | 'escapes' | 'none'} Class */

/**
 * Colours are those of the style sheet. Where two might be taken for each other without colours, a hatching tells them apart: its lines,
 * with their slope.
 * @type {Record<Class, {name: string, colour: 'survives' | 'falls' | 'rests' | null, slopes: number[]}>}
 */
export const CLASSES = {
  survives: { name: 'survives', colour: 'survives', slopes: [] },
  settles: { name: 'comes to rest', colour: 'rests', slopes: [1, -1] },
  caught: { name: 'caught', colour: 'survives', slopes: [] },
  lies: { name: 'lies on an edge', colour: 'rests', slopes: [1, -1] },
  falls: { name: 'falls', colour: 'falls', slopes: [] },
  escapes: { name: 'not caught', colour: 'falls', slopes: [-1] },
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

/** Red, green and blue of a colour as `#rrggbb`. @param {string} colour */
const parts = (colour) => [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));

/** A pixel as the canvas has it in memory. @param {number[]} parts */
const pixel = ([red, green, blue]) => ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;

/** The pixel of a class; transparent where it has no colour. @param {Class} kind */
export function pixelOf(kind) {
  const { colour } = CLASSES[kind];
  return colour === null ? 0 : pixel(parts(theme()[colour]));
}

/** Tints of one class towards another, as far as half of the way. @param {'falls'} kind @param {'survives'} other */
export function tintsOf(kind, other) {
  const [from, to] = [parts(theme()[kind]), parts(theme()[other])];
  return Array.from({ length: TINTS }, (_, index) => {
    const share = (0.5 * Math.sqrt(index)) / Math.sqrt(TINTS - 1);
    return pixel(from.map((value, place) => Math.round(value + (to[place] - value) * share)));
  });
}

/** Tints of runs that last for a while. */
const TINTS = 16;

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
