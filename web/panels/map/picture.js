// A map on its canvas: cells, linear boundary, the marks of the scene and of a chosen cell.

import { disc, drawAxes, toX, toY } from '../../charts/axes.js';
import { COLOURS, PIXELS } from '../../charts/cividis.js';
import { CanvasView, invalidate } from '../../charts/surface.js';
import { theme } from '../../charts/theme.js';
import { blank, hatchingOf, pixelOf, tintsOf } from './classes.js';
import { rowsOf } from './settings.js';
import { axisOf } from './words.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {import('../../charts/axes.js').Frame} Frame */
/** @typedef {import('./words.js').Cell} Cell */
/** @typedef {{x: number, y: number}} Place in px, or values of the two fields */
/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in px */

/** Room around the cells for the axes. */
const ROOM = { left: 52, right: 14, top: 26, bottom: 40 };

/** @param {number} value @param {number} low @param {number} high */
const within = (value, low, high) => Math.min(high, Math.max(low, value));

/** Half of the width of a cell. @param {Side} side @param {number} count of cells */
const halfOf = ({ from, to }, count) => (to - from) / (count - 1) / 2;

export class MapPicture extends CanvasView {
  /** @type {Grid | null} */
  #grid = null;
  /** @type {Settings} */
  #settings;
  /** The scene of the page. @type {Place | null} */
  #mark = null;
  /** @type {Cell | null} */
  cursor = null;
  /** @type {Box | null} */
  selection = null;
  #cells = document.createElement('canvas');
  #sheet = document.createElement('canvas');

  /** @param {HTMLElement} box @param {Settings} settings */
  constructor(box, settings) {
    super(box, 2);
    this.#settings = settings;
  }

  get #paper() {
    return this.layers[0];
  }

  /** @param {Settings} settings whose columns are the finest wanted @param {Grid} grid */
  show(settings, grid) {
    const [before, { cursor }] = [this.#grid, this];
    this.#settings = settings;
    this.#grid = grid;
    this.selection = null;
    // In finer cells the cursor stays where it was.
    if (cursor && before) this.cursor = grid.cellAround(before.x(cursor.column), before.y(cursor.row));
    this.redraw();
  }

  /** @param {Place | null} mark values of the scene */
  mark(mark) {
    this.#mark = mark;
    invalidate(this);
  }

  /** @param {Cell | null} cell */
  point(cell) {
    this.cursor = cell;
    invalidate(this);
  }

  /** Selects the rectangle between two places. @param {[Place, Place] | null} corners */
  select(corners) {
    const { left, top, width, height } = this.frame;
    const xs = corners?.map(({ x }) => within(x, left, left + width)) ?? [];
    const ys = corners?.map(({ y }) => within(y, top, top + height)) ?? [];
    this.selection = corners && {
      left: Math.min(...xs),
      right: Math.max(...xs),
      top: Math.min(...ys),
      bottom: Math.max(...ys),
    };
    invalidate(this);
  }

  /** Half of a finest cell lies beyond the ends, so that the frame is the same for all passes. @returns {Frame} */
  get frame() {
    const { width, height } = this.#paper;
    const { x, y, columns } = this.#settings;
    const [dx, dy] = [halfOf(x, columns), halfOf(y, rowsOf(columns))];
    return {
      left: ROOM.left,
      top: ROOM.top,
      width: Math.max(1, width - ROOM.left - ROOM.right),
      height: Math.max(1, height - ROOM.top - ROOM.bottom),
      x: { low: x.from - dx, high: x.to + dx },
      y: { low: y.from - dy, high: y.to + dy },
    };
  }

  /** The values at a place, kept on the map. @param {Place} place @returns {Place} */
  valuesAt({ x: px, y: py }) {
    const { left, top, width, height, x, y } = this.frame;
    return {
      x: x.low + within((px - left) / width, 0, 1) * (x.high - x.low),
      y: y.low + within((top + height - py) / height, 0, 1) * (y.high - y.low),
    };
  }

  /** @param {Place} place @returns {Cell | null} */
  cellAt(place) {
    const { left, top, width, height } = this.frame;
    const [across, upwards] = [(place.x - left) / width, (top + height - place.y) / height];
    if (!(across >= 0 && across < 1 && upwards >= 0 && upwards < 1) || !this.#grid) return null;
    const { x, y } = this.valuesAt(place);
    return this.#grid.cellAround(x, y);
  }

  /** The cell of two values, if they are on the map. @param {Place} values @returns {Cell | null} */
  cellOf({ x, y }) {
    const { frame } = this;
    return this.cellAt({ x: toX(frame, x), y: toY(frame, y) });
  }

  /** The rectangle of a cell. @param {Grid} grid @param {Cell} cell @returns {Box} */
  #boxOf(grid, { column, row }) {
    const { frame } = this;
    const { x, y } = grid.settings;
    const [dx, dy] = [halfOf(x, grid.columns), halfOf(y, grid.rows)];
    return {
      left: toX(frame, grid.x(column) - dx),
      right: toX(frame, grid.x(column) + dx),
      top: toY(frame, grid.y(row) + dy),
      bottom: toY(frame, grid.y(row) - dy),
    };
  }

  draw() {
    // One that is hidden has no size.
    if (this.#paper.width === 0) return false;
    if (this.stale) this.#drawPaper();
    this.#drawOverlay();
    return false;
  }

  /** Draws within the frame alone. @param {CanvasRenderingContext2D} context @param {() => void} draw */
  #clipped(context, draw) {
    const { left, top, width, height } = this.frame;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    draw();
    context.restore();
  }

  #drawPaper() {
    const { context, width, height } = this.#paper;
    const { frame } = this;
    const grid = this.#grid;
    const colours = theme();
    this.stale = false;
    context.clearRect(0, 0, width, height);
    const { x, y } = grid?.settings ?? this.#settings;
    drawAxes(context, frame, axisOf(x), axisOf(y));
    if (!grid) return;
    this.#clipped(context, () => {
      context.fillStyle = blank(context, colours);
      if (grid.lacks) context.fillRect(frame.left, frame.top, frame.width, frame.height);
      this.#drawCells(context, grid, this.#pixelOf(grid));
      if (grid.classes) this.#hatch(grid);
    });
    context.strokeStyle = colours.muted;
    context.lineWidth = 1;
    context.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
    this.#clipped(context, () => this.#drawLimitCurves(grid));
  }

  /** The colour of each cell; 0 where it has none. @param {Grid} grid @returns {(column: number, row: number) => number} */
  #pixelOf(grid) {
    if (grid.classes) {
      const kinds = grid.names.map((name) => grid.classOf(name));
      const pixels = kinds.map((kind) => pixelOf(kind));
      const tints = tintsOf('falls', 'survives');
      const { bounces, quantity } = grid.settings;
      return (column, row) => {
        const value = grid.value(column, row);
        if (Number.isNaN(value)) return 0;
        const outcome = grid.outcomes[row * grid.columns + column];
        // A run that lasts for a while before it falls is told from one that falls at once.
        return quantity === 'survival' && kinds[outcome] === 'falls'
          ? tints[Math.min(tints.length - 1, Math.floor((value / bounces) * tints.length))]
          : pixels[outcome];
      };
    }
    const { low, high } = grid.scale;
    return (column, row) => {
      const value = grid.value(column, row);
      if (Number.isNaN(value)) return 0;
      const share = high > low ? (value - low) / (high - low) : 0.5;
      return PIXELS[within(Math.floor(share * COLOURS), 0, COLOURS - 1)];
    };
  }

  /** Draws a pixel for each cell, large and with sharp edges. @param {CanvasRenderingContext2D} context @param {Grid} grid @param {(column: number, row: number) => number} pixelOf */
  #drawCells(context, grid, pixelOf) {
    const { columns, rows } = grid;
    const image = new ImageData(columns, rows);
    const pixels = new Uint32Array(image.data.buffer);
    for (let row = 0; row < rows; row += 1)
      for (let column = 0; column < columns; column += 1)
        pixels[(rows - 1 - row) * columns + column] = pixelOf(column, row);
    this.#cells.width = columns;
    this.#cells.height = rows;
    this.#cells.getContext('2d')?.putImageData(image, 0, 0);
    const { left, bottom } = this.#boxOf(grid, { column: 0, row: 0 });
    const { right, top } = this.#boxOf(grid, { column: columns - 1, row: rows - 1 });
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#cells, left, top, right - left, bottom - top);
  }

  /** Hatches the cells of each class that has lines. @param {Grid} grid */
  #hatch(grid) {
    const { context, canvas } = this.#paper;
    const ratio = canvas.width / Math.max(1, this.#paper.width);
    this.#sheet.width = canvas.width;
    this.#sheet.height = canvas.height;
    const sheet = /** @type {CanvasRenderingContext2D} */ (this.#sheet.getContext('2d'));
    sheet.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const kind of /** @type {const} */ (['escapes', 'settles', 'lies'])) {
      if (!grid.holds(kind)) continue;
      sheet.globalCompositeOperation = 'source-over';
      sheet.clearRect(0, 0, this.#paper.width, this.#paper.height);
      const marked = grid.names.map((name) => (grid.classOf(name) === kind ? 0xff000000 : 0));
      this.#drawCells(sheet, grid, (column, row) => marked[grid.outcomes[row * grid.columns + column]]);
      sheet.globalCompositeOperation = 'source-in';
      sheet.fillStyle = hatchingOf(sheet, kind) ?? 'transparent';
      sheet.fillRect(0, 0, this.#paper.width, this.#paper.height);
      context.drawImage(this.#sheet, 0, 0, this.#paper.width, this.#paper.height);
    }
  }

  /** The limit for small deviations, over a lighter or darker edge so that it reads on every colour: broken, and where R = 0 dotted. @param {Grid} grid */
  #drawLimitCurves({ limitCurves }) {
    const { context } = this.#paper;
    const { frame } = this;
    const { surface, caution } = theme();
    context.beginPath();
    limitCurves.forEach(({ residue, x, y }, index) => {
      // Pieces of an even grid, so leaving some out breaks the line evenly.
      if (residue === 0 ? index % 2 === 1 : index % 4 === 3) return;
      context.moveTo(toX(frame, x[0]), toY(frame, y[0]));
      context.lineTo(toX(frame, x[1]), toY(frame, y[1]));
    });
    stroked(context, [surface, 4], [caution, 2], () => context.stroke());
  }

  #drawOverlay() {
    const { context, width, height } = this.layers[1];
    const { frame, cursor, selection } = this;
    const grid = this.#grid;
    context.clearRect(0, 0, width, height);
    this.#clipped(context, () => {
      if (selection) {
        const { left, top, right, bottom } = selection;
        context.fillStyle = 'rgb(255 255 255 / 0.25)';
        context.fillRect(left, top, right - left, bottom - top);
        this.#outline(selection);
      } else if (cursor && grid) {
        const { left, right, top, bottom } = this.#boxOf(grid, cursor);
        // Never too small to be found.
        const [dx, dy] = [right - left, bottom - top].map((size) => Math.max(0, LEAST - size) / 2 + 1);
        this.#outline({ left: left - dx, right: right + dx, top: top - dy, bottom: bottom + dy });
      }
    });
    if (!this.#mark) return;
    // The handle of the map.
    const [x, y] = [toX(frame, this.#mark.x), toY(frame, this.#mark.y)];
    const { accent } = theme();
    disc(context, x, y, 11, { fill: accent });
    disc(context, x, y, 9, { fill: '#fff' });
    disc(context, x, y, 6, { fill: accent });
  }

  /** @param {Box} box */
  #outline({ left, top, right, bottom }) {
    const { context } = this.layers[1];
    stroked(context, ['#101820', 3.5], ['#fff', 1.5], () => context.strokeRect(left, top, right - left, bottom - top));
  }
}

/** The least side of the outline of a cell, px. */
const LEAST = 8;

/** Strokes over an edge of another colour. @param {CanvasRenderingContext2D} context @param {[string, number]} edge colour and width @param {[string, number]} core @param {() => void} stroke */
function stroked(context, edge, core, stroke) {
  for (const [colour, width] of [edge, core]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    stroke();
  }
}
