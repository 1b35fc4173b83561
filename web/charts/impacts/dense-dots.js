// Dots by the ten thousand, set pixel by pixel and put on the canvas at once.

import { drawDot } from '../marks.js';
import { h } from '../../dom/elements.js';
import { theme } from '../theme.js';

/** @typedef {import('../marks.js').Look} Look */
/** @typedef {{reach: number, steps: Int32Array, inks: Uint32Array}} Stamp the pixels of a dot: how far on they are from its middle, and their inks */

/** Farther than this no dot reaches from its middle, CSS px. */
const REACH = 4;
const SERIES = 4;

/**
 * A dot as it is drawn elsewhere, read back.
 * @param {number} series
 * @param {Look} look
 * @param {number} ratio device pixels in one of CSS
 * @param {number} width of the canvas it is for, device pixels
 * @returns {Stamp}
 */
function stampOf(series, look, ratio, width) {
  const reach = Math.ceil(REACH * ratio);
  const side = 2 * reach + 1;
  const context = /** @type {CanvasRenderingContext2D} */ (
    h('canvas', { width: side, height: side }).getContext('2d', { willReadFrequently: true })
  );
  context.setTransform(ratio, 0, 0, ratio, reach + 0.5, reach + 0.5);
  drawDot(context, series, 0, 0, look, true);
  const { data } = context.getImageData(0, 0, side, side);
  const alphas = Array.from({ length: side * side }, (_, index) => data[4 * index + 3]);
  const strongest = Math.max(...alphas);
  // Pixels are set here, not mixed: without its faint rim, no dot washes out the one beneath.
  const set = [...alphas.keys()].filter((index) => alphas[index] > strongest / 2);
  for (const index of set) data[4 * index + 3] = strongest;
  const inks = new Uint32Array(data.buffer);
  return {
    reach,
    steps: Int32Array.from(set, (index) => (Math.floor(index / side) - reach) * width + (index % side) - reach),
    inks: Uint32Array.from(set, (index) => inks[index]),
  };
}

/** Stamps last as long as the colours of a scheme do. @type {WeakMap<object, Map<string, Stamp[]>>} */
const made = new WeakMap();

/** @param {Look} look @param {number} ratio @param {number} width */
function stampsOf(look, ratio, width) {
  const ofScheme = made.get(theme()) ?? new Map();
  made.set(theme(), ofScheme);
  const key = `${look} ${ratio} ${width}`;
  const stamps = ofScheme.get(key) ?? Array.from({ length: SERIES }, (_, index) => stampOf(index, look, ratio, width));
  ofScheme.set(key, stamps);
  return stamps;
}

/**
 * @param {import('../surface.js').Surface} surface
 * @param {{frame: import('../axes.js').Frame, meaning: Record<'x' | 'y', {column: import('../../run/impacts.js').Lasting}>}} plot
 * @param {import('../../run/impacts.js').Impacts} impacts
 * @param {import('../../run/selection.js').Selection | null} selection
 */
export function drawPixels({ context, canvas, width, height }, { frame, meaning }, impacts, selection) {
  if (canvas.width === 0 || canvas.height === 0) return;
  const ratio = canvas.width / width;
  const image = new ImageData(canvas.width, canvas.height);
  const pixels = new Uint32Array(image.data.buffer);
  const [across, upwards, series] = [
    impacts.column(meaning.x.column),
    impacts.column(meaning.y.column),
    impacts.column('series'),
  ];
  // A power of two.
  const kept = across.length;
  const scaleX = (frame.width / (frame.x.high - frame.x.low)) * ratio;
  const scaleY = (frame.height / (frame.y.high - frame.y.low)) * ratio;
  const left = frame.left * ratio;
  const bottom = (frame.top + frame.height) * ratio;
  const [across_px, up_px] = [canvas.width, canvas.height];
  /** @param {Stamp[]} looks @param {number} count @param {(index: number) => number} placeAt */
  const put = (looks, count, placeAt) => {
    const { reach } = looks[0];
    for (let index = 0; index < count; index += 1) {
      const slot = placeAt(index) & (kept - 1);
      const x = Math.floor(left + (across[slot] - frame.x.low) * scaleX);
      const y = Math.floor(bottom - (upwards[slot] - frame.y.low) * scaleY);
      // A missing value is NaN, for which no comparison holds.
      if (!(x >= reach && y >= reach && x < across_px - reach && y < up_px - reach)) continue;
      const { steps, inks } = looks[series[slot] % SERIES];
      const middle = y * across_px + x;
      for (let k = 0; k < steps.length; k += 1) pixels[middle + steps[k]] = inks[k];
    }
  };
  const { begin, end } = impacts;
  put(stampsOf(selection?.active ? 'receded' : 'plain', ratio, across_px), end - begin, (index) => begin + index);
  const places = selection?.places ?? [];
  if (selection?.active) put(stampsOf('selected', ratio, across_px), places.length, (index) => places[index]);
  const sheet = h('canvas', { width: canvas.width, height: canvas.height });
  /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d')).putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(sheet, 0, 0, width, height);
}
