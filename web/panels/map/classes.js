// The classes of outcomes: what a cell's run comes to, with a colour and a hatching for each.

import { COLOURS, PIXELS } from '../../charts/cividis.js';

/** @typedef {'survives' | 'settles' | 'falls' | 'none'} Class */

/**
 * Colours are places in cividis. A hatching tells the classes apart without colours: its lines, with their slope.
 * @type {Record<Class, {name: string, colour: number | null, slopes: number[]}>}
 */
export const CLASSES = {
  survives: { name: 'survives', colour: COLOURS - 1, slopes: [] },
  settles: { name: 'comes to rest', colour: COLOURS / 2, slopes: [1, -1] },
  falls: { name: 'falls', colour: 0, slopes: [1] },
  none: { name: 'no run', colour: null, slopes: [] },
};

/** @param {string} outcome its name in answers @returns {Class} */
export function classOf(outcome) {
  if (outcome === 'completed') return 'survives';
  if (outcome === 'settled') return 'settles';
  return outcome === 'none' ? 'none' : 'falls';
}

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
