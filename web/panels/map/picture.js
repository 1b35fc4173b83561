// A map on its canvas: axes, cells, and the limit for small deviations.

import { drawAxes, toX, toY } from '../../charts/axes.js';
import { PIXELS } from '../../charts/cividis.js';
import { CanvasView } from '../../charts/surface.js';
import { colourOf } from '../../charts/theme.js';
import { CLASSES, fallTints, hatching, pixelOf } from './classes.js';
import { halfCell, rangesOf } from './settings.js';
import { axisOf } from './words.js';

/** Room around the cells for the axes, px; the style sheet has it too, for `.map-frame`. */
const ROOM = { left: 52, right: 14, top: 26, bottom: 40 };
/** Lines of a hatching. */
const LIGHT = 'rgb(255 255 255 / 0.42)';

/** A canvas for pixels. @param {HTMLCanvasElement} canvas */
const contextOf = (canvas) => /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));

export class MapPicture extends CanvasView {
  /** @type {Grid | null} */
  #grid = null;
  #settings;
  #cells = document.createElement('canvas');
  #sheet = document.createElement('canvas');

  /** @param {HTMLElement} box @param {MapSettings} settings */
  constructor(box, settings) {
    super(box, 1);
    this.#settings = settings;
  }

  /** @param {MapSettings} settings whose columns are the finest wanted @param {Grid} grid */
  show(settings, grid) {
    this.#settings = settings;
    this.#grid = grid;
    this.redraw();
  }

  /** @returns {Frame} */
  get #frame() {
    const { width, height } = this.layers[0];
    return {
      left: ROOM.left,
      top: ROOM.top,
      width: Math.max(1, width - ROOM.left - ROOM.right),
      height: Math.max(1, height - ROOM.top - ROOM.bottom),
      ...rangesOf(this.#settings),
    };
  }

  draw() {
    // One that is hidden has no size.
    if (this.layers[0].width > 0 && this.stale) this.#draw();
    return false;
  }

  #draw() {
    const [surface] = this.layers;
    const { context } = surface;
    this.stale = false;
    const grid = this.#grid;
    const frame = this.#frame;
    surface.clear();
    const { x, y } = grid?.settings ?? this.#settings;
    drawAxes(surface, frame, axisOf(x), axisOf(y));
    if (!grid) return;
    surface.within(frame, () => {
      if (grid.lacks) {
        context.fillStyle = hatching(context, [1], colourOf('muted'), colourOf('faint'));
        context.fillRect(frame.left, frame.top, frame.width, frame.height);
      }
      this.#drawCells(context, grid, pixelsOf(grid));
      if (grid.classes) this.#hatch(grid);
      this.#drawLimitCurves(grid);
    });
    context.strokeStyle = colourOf('muted');
    context.lineWidth = 1;
    context.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
  }

  /** Draws a pixel for each cell, large and with sharp edges. @param {CanvasRenderingContext2D} context @param {Grid} grid @param {(place: number) => number} pixelOf a cell, by its place in the rows from the lowest on */
  #drawCells(context, grid, pixelOf) {
    const { columns, rows, settings } = grid;
    const image = new ImageData(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    for (let row = 0; row < rows; row += 1)
      for (let column = 0; column < columns; column += 1)
        pixels[(rows - 1 - row) * columns + column] = pixelOf(row * columns + column);
    Object.assign(this.#cells, { width: columns, height: rows });
    contextOf(this.#cells).putImageData(image, 0, 0);
    const frame = this.#frame;
    const { x, y } = settings;
    const [dx, dy] = [halfCell(x, columns), halfCell(y, rows)];
    const [left, top] = [toX(frame, x.from - dx), toY(frame, y.to + dy)];
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#cells, left, top, toX(frame, x.to + dx) - left, toY(frame, y.from - dy) - top);
  }

  /** Hatches the cells of each class that has lines. @param {Grid} grid */
  #hatch(grid) {
    const { context, canvas, width, height } = this.layers[0];
    const ratio = canvas.width / Math.max(1, width);
    Object.assign(this.#sheet, { width: canvas.width, height: canvas.height });
    const sheet = contextOf(this.#sheet);
    sheet.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const [kind, { slopes }] of Object.entries(CLASSES)) {
      const marked = grid.names.map((name) => (grid.classOf(name) === kind ? 0xff000000 : 0));
      if (!slopes || !grid.outcomes.some((outcome) => marked[outcome])) continue;
      sheet.globalCompositeOperation = 'source-over';
      sheet.clearRect(0, 0, width, height);
      this.#drawCells(sheet, grid, (place) => marked[grid.outcomes[place]]);
      sheet.globalCompositeOperation = 'source-in';
      sheet.fillStyle = hatching(sheet, slopes, LIGHT);
      sheet.fillRect(0, 0, width, height);
      context.drawImage(this.#sheet, 0, 0, width, height);
    }
  }

  /** The limit for small deviations, over a lighter or darker edge so that it reads on every colour: broken, and where R = 0 dotted. @param {Grid} grid */
  #drawLimitCurves({ limitCurves }) {
    const [surface] = this.layers;
    const { context } = surface;
    const frame = this.#frame;
    context.beginPath();
    limitCurves.forEach(({ residue, x, y }, index) => {
      // Pieces of an even grid, so leaving some out breaks the line evenly.
      if (residue === 0 ? index % 2 === 1 : index % 4 === 3) return;
      context.moveTo(toX(frame, x[0]), toY(frame, y[0]));
      context.lineTo(toX(frame, x[1]), toY(frame, y[1]));
    });
    surface.stroke('surface', { width: 4 });
    surface.stroke('caution', { width: 2 });
  }
}

/** The pixel of each cell; 0 where it has no value. @param {Grid} grid @returns {(place: number) => number} */
function pixelsOf(grid) {
  const { values, outcomes } = grid;
  const { bounces, quantity } = grid.settings;
  const { low, high } = grid.scale;
  const kinds = grid.names.map((name) => grid.classOf(name));
  const classes = kinds.map(pixelOf);
  const tints = fallTints();
  /** One of many colours. @param {ArrayLike<number>} colours @param {number} share of the way along them */
  const one = (colours, share) =>
    colours[Math.min(colours.length - 1, Math.max(0, Math.floor(share * colours.length)))];
  return (place) => {
    const value = values[place];
    const outcome = outcomes[place];
    if (Number.isNaN(value)) return 0;
    if (!grid.classes) return one(PIXELS, high > low ? (value - low) / (high - low) : 0.5);
    // A run that lasts for a while before it falls is told from one that falls at once.
    const lasts = quantity === 'survival' && kinds[outcome] === 'falls';
    return lasts ? one(tints, value / bounces) : classes[outcome];
  };
}
