// The marks of impacts: their shapes and colours, one by one or by the ten thousand.

import { h } from '../dom/elements.js';
import { partsOf, pixel, presenting } from './theme.js';

/** @typedef {'plain' | 'selected' | 'receded'} Look */

/** The colours of dots. @type {readonly Colour[]} */
const SERIES = ['series-0', 'series-1', 'series-2', 'series-3'];
/** Opacity of a dot that recedes. */
const FAINT = 0.4;
/** Corners of the marks but the first, a circle, for a radius of 1. */
const CORNERS = [[], [-1, -1, 1, -1, 1, 1, -1, 1], [0, -1.4, 1.4, 0, 0, 1.4, -1.4, 0], [0, -1.3, 1.3, 1, -1.3, 1]];

/**
 * A filled mark. Colour and shape of an impact tell which parameters it was played with, so that neither is needed alone.
 * @param {Surface} surface @param {number} series @param {number} x @param {number} y @param {number} r @param {Colour} fill
 */
export function drawMark(surface, series, x, y, r, fill) {
  const corners = CORNERS[series % 4];
  if (corners.length === 0) return surface.disc(x, y, r, { fill });
  const { context } = surface;
  context.beginPath();
  for (let k = 0; k < corners.length; k += 2) context.lineTo(x + corners[k] * r, y + corners[k + 1] * r);
  context.closePath();
  surface.fill(fill);
}

/** @param {Look} look @param {boolean} many a dot among so many that it must be small */
const dotRadius = (look, many) =>
  ({ plain: 1.8, selected: 3, receded: 1.3 })[look] * (many ? 0.6 : 1) * (presenting() ? 1.67 : 1);

/**
 * The dot of an impact: size and ring as well as colour tell that it is selected.
 * @param {Surface} surface @param {number} series @param {number} x @param {number} y @param {Look} look @param {boolean} many
 */
export function drawDot(surface, series, x, y, look, many) {
  surface.faintly(look === 'receded' ? FAINT : 1, () =>
    drawMark(surface, series, x, y, dotRadius(look, many), SERIES[series % 4]),
  );
  // Rings that overlap would hide what they surround.
  if (look === 'selected' && !many) surface.stroke('ink', { width: 1.25 });
}

/**
 * All dots of a plot as squares, set pixel by pixel and put on the canvas at once.
 * @param {Surface} surface
 * @param {Frame} frame
 * @param {Impacts} impacts
 * @param {Lasting[]} columns of the values along x and y
 * @param {import('../run/selection.js').Selection | null} selection
 */
export function drawPixels({ context, canvas, width, height }, frame, impacts, columns, selection) {
  if (canvas.width === 0 || canvas.height === 0) return;
  const ratio = canvas.width / width;
  const image = new ImageData(canvas.width, canvas.height);
  const pixels = new Uint32Array(image.data.buffer);
  const [across, upwards] = columns.map((column) => impacts.column(column));
  const series = impacts.column('series');
  const scaleX = (frame.width / (frame.x.high - frame.x.low)) * ratio;
  const scaleY = (frame.height / (frame.y.high - frame.y.low)) * ratio;
  /** @param {Look} look @param {number} count @param {(index: number) => number} placeAt */
  const put = (look, count, placeAt) => {
    const inks = SERIES.map((colour) => pixel(partsOf(colour), look === 'receded' ? Math.round(255 * FAINT) : 255));
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
      const ink = inks[series[slot] % 4];
      for (let row = y; row < y + side; row += 1)
        for (let at = row * image.width + x, end = at + side; at < end; at += 1) pixels[at] = ink;
    }
  };
  const { begin, end } = impacts;
  const { active = false, places = [] } = selection ?? {};
  put(active ? 'receded' : 'plain', end - begin, (index) => begin + index);
  if (active) put('selected', places.length, (index) => places[index]);
  const sheet = h('canvas', { width: canvas.width, height: canvas.height });
  /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d')).putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(sheet, 0, 0, width, height);
}
