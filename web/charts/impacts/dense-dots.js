// Dots by the ten thousand: squares, set pixel by pixel and put on the canvas at once.

import { dotRadius, seriesColour } from '../marks.js';
import { h } from '../../dom/elements.js';

/** @typedef {import('../marks.js').Look} Look */

const SERIES = 4;
/** Opacity of a dot that recedes, of 255. */
const FAINT = 102;

/** The colours of the series as pixels. @param {Look} look */
function inksOf(look) {
  const context = /** @type {CanvasRenderingContext2D} */ (h('canvas', { width: SERIES, height: 1 }).getContext('2d'));
  for (let series = 0; series < SERIES; series += 1) {
    context.fillStyle = seriesColour(series);
    context.fillRect(series, 0, 1, 1);
  }
  const { data } = context.getImageData(0, 0, SERIES, 1);
  if (look === 'receded') for (let at = 3; at < data.length; at += 4) data[at] = FAINT;
  return new Uint32Array(data.buffer);
}

/**
 * @param {import('../surface.js').Surface} surface
 * @param {import('./companions.js').Plot & {selection: import('../../run/selection.js').Selection | null}} plot
 * @param {import('../../run/impacts.js').Impacts} impacts
 */
export function drawPixels({ context, canvas, width, height }, { frame, meaning, selection }, impacts) {
  if (canvas.width === 0 || canvas.height === 0) return;
  const ratio = canvas.width / width;
  const image = new ImageData(canvas.width, canvas.height);
  const pixels = new Uint32Array(image.data.buffer);
  const [across, upwards, series] = [
    impacts.column(meaning.x.column),
    impacts.column(meaning.y.column),
    impacts.column('series'),
  ];
  const scaleX = (frame.width / (frame.x.high - frame.x.low)) * ratio;
  const scaleY = (frame.height / (frame.y.high - frame.y.low)) * ratio;
  /** @param {Look} look @param {number} count @param {(index: number) => number} placeAt */
  const put = (look, count, placeAt) => {
    const inks = inksOf(look);
    const side = Math.max(1, Math.round(2 * dotRadius(look, true) * ratio));
    const left = frame.left * ratio - side / 2;
    const bottom = (frame.top + frame.height) * ratio - side / 2;
    for (let index = 0; index < count; index += 1) {
      // The length of a column is a power of two.
      const slot = placeAt(index) & (across.length - 1);
      const x = Math.floor(left + (across[slot] - frame.x.low) * scaleX);
      const y = Math.floor(bottom - (upwards[slot] - frame.y.low) * scaleY);
      // A missing value is NaN, for which no comparison holds.
      if (!(x >= 0 && y >= 0 && x + side < canvas.width && y + side < canvas.height)) continue;
      const ink = inks[series[slot] % SERIES];
      for (let row = y; row < y + side; row += 1) {
        const at = row * image.width + x;
        for (let pixel = at; pixel < at + side; pixel += 1) pixels[pixel] = ink;
      }
    }
  };
  const { begin, end } = impacts;
  put(selection?.active ? 'receded' : 'plain', end - begin, (index) => begin + index);
  const places = selection?.places ?? [];
  if (selection?.active) put('selected', places.length, (index) => places[index]);
  const sheet = h('canvas', { width: canvas.width, height: canvas.height });
  /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d')).putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(sheet, 0, 0, width, height);
}
