// A map on its canvas: cells, their classes or a colour bar, linear boundary, the marks of the scene and of a chosen cell.

import { COLOURS, PIXELS } from '../../charts/cividis.js';
import { blank, hatchingOf, pixelOf, tintsOf } from './classes.js';
import { QUANTITIES, rowsOf } from './settings.js';
import { SANS, SERIF, onThemeChange, theme } from '../../charts/theme.js';
import { drawAxes, line, ticks, toX, toY } from '../../charts/axes.js';
import { invalidate, surfaces } from '../../charts/surface.js';
import { number } from '../../dom/numbers.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {{column: number, row: number}} Cell */
/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in px */

/** Room around the cells for the axes. */
const ROOM = { left: 52, right: 14, top: 26, bottom: 40 };
/** Below them, where the values have a scale. */
const BAR = { below: 66, height: 12, room: 56 };

export class MapPicture {
  /** @type {Grid | null} */
  #grid = null;
  /** The coarser grid where that has no rows yet. @type {Grid | null} */
  #under = null;
  /** @type {Settings} */
  #settings;
  #names;
  /** The scene of the page. @type {{x: number, y: number} | null} */
  #mark = null;
  /** @type {Cell | null} */
  cursor = null;
  /** @type {Box | null} */
  selection = null;
  #stale = true;
  #cells = document.createElement('canvas');
  #sheet = document.createElement('canvas');
  #paper;
  #overlay;

  /**
   * @param {HTMLElement} box
   * @param {Settings} settings
   * @param {{x: string, y: string}} names
   */
  constructor(box, settings, names) {
    this.#settings = settings;
    this.#names = names;
    [this.#paper, this.#overlay] = surfaces(box, 2, () => this.redraw());
    onThemeChange(() => this.redraw());
  }

  /**
   * @param {Settings} settings whose columns are the finest wanted
   * @param {{x: string, y: string}} names of the axes, with units
   * @param {Grid | null} grid
   * @param {Grid | null} under
   */
  show(settings, names, grid, under) {
    const { cursor } = this;
    const before = this.#grid;
    this.#settings = settings;
    this.#names = names;
    this.#grid = grid;
    this.#under = under;
    this.selection = null;
    // In finer cells the cursor stays where it was.
    if (cursor && before && grid) this.cursor = grid.cellAround(before.x(cursor.column), before.y(cursor.row));
    this.redraw();
  }

  /** @param {{x: number, y: number} | null} mark */
  mark(mark) {
    this.#mark = mark;
    invalidate(this);
  }

  redraw() {
    this.#stale = true;
    invalidate(this);
  }

  /** Cursor or selection moved. */
  point() {
    invalidate(this);
  }

  get columns() {
    return this.#grid?.columns ?? this.#settings.columns;
  }

  get rows() {
    return rowsOf(this.columns);
  }

  /** Half of a finest cell lies beyond the ends, so that the frame is the same for all passes. @returns {import('../../charts/axes.js').Frame} */
  get frame() {
    const { width, height } = this.#paper;
    const { x, y, columns } = this.#settings;
    const [dx, dy] = [(x.to - x.from) / (columns - 1) / 2, (y.to - y.from) / (rowsOf(columns) - 1) / 2];
    return {
      left: ROOM.left,
      top: ROOM.top,
      width: Math.max(1, width - ROOM.left - ROOM.right),
      height: Math.max(1, height - ROOM.top - ROOM.bottom - (this.#grid?.classes === false ? BAR.room : 0)),
      x: { low: x.from - dx, high: x.to + dx },
      y: { low: y.from - dy, high: y.to + dy },
    };
  }

  /**
   * The cell at a place of the canvas.
   * @param {number} px
   * @param {number} py
   * @returns {Cell | null}
   */
  cellAt(px, py) {
    const { left, top, width, height, x, y } = this.frame;
    const [across, upwards] = [(px - left) / width, (top + height - py) / height];
    if (!(across >= 0 && across < 1 && upwards >= 0 && upwards < 1) || !this.#grid) return null;
    return this.#grid.cellAround(x.low + across * (x.high - x.low), y.low + upwards * (y.high - y.low));
  }

  /** The rectangle of some cells, px: from a first column and row up to a last. @param {Grid} grid @param {Cell} first @param {Cell} last @returns {Box} */
  #boxOf(grid, first, last) {
    const { frame } = this;
    const { x, y } = grid.settings;
    const [dx, dy] = [(x.to - x.from) / (grid.columns - 1) / 2, (y.to - y.from) / (grid.rows - 1) / 2];
    return {
      left: toX(frame, grid.x(first.column) - dx),
      right: toX(frame, grid.x(last.column) + dx),
      top: toY(frame, grid.y(last.row) + dy),
      bottom: toY(frame, grid.y(first.row) - dy),
    };
  }

  /** The cell of the scene, if it is on the map. */
  cellOfMark() {
    const { frame } = this;
    return this.#mark && this.cellAt(toX(frame, this.#mark.x), toY(frame, this.#mark.y));
  }

  draw() {
    // One that is hidden has no size.
    if (this.#paper.width === 0) return false;
    if (this.#stale) this.#drawPaper();
    this.#stale = false;
    this.#drawOverlay();
    return false;
  }

  #drawPaper() {
    const { context, width, height } = this.#paper;
    const { frame } = this;
    const grid = this.#grid;
    const colours = theme();
    context.clearRect(0, 0, width, height);
    drawAxes(context, frame, this.#names.x, this.#names.y);
    if (grid) {
      context.save();
      context.beginPath();
      context.rect(frame.left, frame.top, frame.width, frame.height);
      context.clip();
      context.fillStyle = blank(context, colours);
      for (const layer of [this.#under, grid]) if (layer) this.#drawCells(context, layer, this.#pixelOf(layer));
      if (grid.classes) this.#hatch(grid);
      context.restore();
      context.strokeStyle = colours.muted;
      context.lineWidth = 1;
      context.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
      this.#drawLimitCurves(frame, grid);
    }
    if (grid && !grid.classes) this.#drawBar(frame);
  }

  /** The colour of each cell; 0 where it has none. @param {Grid} layer @returns {(column: number, row: number) => number} */
  #pixelOf(layer) {
    if (layer.classes) {
      const kinds = layer.names.map((name) => layer.classOf(name));
      const pixels = kinds.map((kind) => pixelOf(kind));
      const tints = tintsOf('falls', 'survives');
      const { impacts, quantity } = layer.settings;
      return (column, row) => {
        const value = layer.value(column, row);
        if (Number.isNaN(value)) return 0;
        const outcome = layer.outcomes[row * layer.columns + column];
        // A run that lasts for a while before it falls is told from one that falls at once.
        return quantity === 'survival' && kinds[outcome] === 'falls'
          ? tints[Math.min(tints.length - 1, Math.floor((value / impacts) * tints.length))]
          : pixels[outcome];
      };
    }
    const { low, high } = layer.scale;
    const scale = COLOURS / (high - low);
    return (column, row) => {
      const value = layer.value(column, row);
      if (Number.isNaN(value)) return 0;
      const share = high > low ? (value - low) * scale : COLOURS / 2;
      return PIXELS[Math.max(0, Math.min(COLOURS - 1, Math.floor(share)))];
    };
  }

  /**
   * The rows of a grid that have arrived, over what is there: its fill, and over that the colours of its cells.
   * @param {CanvasRenderingContext2D} context
   * @param {Grid} layer
   * @param {(column: number, row: number) => number} pixelOf
   */
  #drawCells(context, layer, pixelOf) {
    const image = new ImageData(layer.columns, layer.rows);
    const pixels = new Uint32Array(image.data.buffer);
    const last = { column: layer.columns - 1, row: layer.rows - 1 };
    for (let row = 0; row < layer.rows; row += 1) {
      if (!layer.has(row)) continue;
      const { left, right, top, bottom } = this.#boxOf(layer, { column: 0, row }, { column: last.column, row });
      context.clearRect(left, top, right - left, bottom - top);
      context.fillRect(left, top, right - left, bottom - top);
      for (let column = 0; column < layer.columns; column += 1)
        pixels[(last.row - row) * layer.columns + column] = pixelOf(column, row);
    }
    const { left, right, top, bottom } = this.#boxOf(layer, { column: 0, row: 0 }, last);
    this.#drawPixels(context, image, left, top, right - left, bottom - top);
  }

  /** Hatches the cells of each class that has lines. @param {Grid} grid */
  #hatch(grid) {
    const { context, canvas } = this.#paper;
    const { frame } = this;
    const ratio = canvas.width / Math.max(1, this.#paper.width);
    this.#sheet.width = canvas.width;
    this.#sheet.height = canvas.height;
    const sheet = /** @type {CanvasRenderingContext2D} */ (this.#sheet.getContext('2d'));
    sheet.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const kind of /** @type {const} */ (['escapes', 'settles', 'lies'])) {
      if (!grid.holds(kind) && !this.#under?.holds(kind)) continue;
      sheet.globalCompositeOperation = 'source-over';
      sheet.clearRect(0, 0, this.#paper.width, this.#paper.height);
      sheet.fillStyle = 'transparent';
      for (const layer of [this.#under, grid]) {
        if (!layer) continue;
        const marked = layer.names.map((name) => (layer.classOf(name) === kind ? 0xff000000 : 0));
        this.#drawCells(sheet, layer, (column, row) => marked[layer.outcomes[row * layer.columns + column]]);
      }
      sheet.globalCompositeOperation = 'source-in';
      sheet.fillStyle = hatchingOf(sheet, kind) ?? 'transparent';
      sheet.fillRect(frame.left, frame.top, frame.width, frame.height);
      context.drawImage(this.#sheet, 0, 0, this.#paper.width, this.#paper.height);
    }
  }

  /**
   * Pixels drawn large, with sharp edges.
   * @param {CanvasRenderingContext2D} context
   * @param {ImageData} image
   * @param {number} left
   * @param {number} top
   * @param {number} width
   * @param {number} height
   */
  #drawPixels(context, image, left, top, width, height) {
    this.#cells.width = image.width;
    this.#cells.height = image.height;
    this.#cells.getContext('2d')?.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#cells, left, top, width, height);
  }

  /**
   * The limit for small deviations, over a lighter or darker edge so that it reads on every colour: broken, and where R = 0 dotted.
   * @param {import('../../charts/axes.js').Frame} frame
   * @param {Grid} grid
   */
  #drawLimitCurves(frame, { limitCurves }) {
    const { context } = this.#paper;
    const colours = theme();
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.width, frame.height);
    context.clip();
    for (const [colour, wide] of /** @type {const} */ ([
      [colours.surface, 4],
      [colours.caution, 2],
    ])) {
      context.beginPath();
      limitCurves.forEach(({ residue, x, y }, index) => {
        // Pieces of an even grid, so leaving some out breaks the line evenly.
        if (residue === 0 ? index % 2 === 1 : index % 4 === 3) return;
        context.moveTo(toX(frame, x[0]), toY(frame, y[0]));
        context.lineTo(toX(frame, x[1]), toY(frame, y[1]));
      });
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.stroke();
    }
    context.restore();
  }

  /** @param {import('../../charts/axes.js').Frame} frame */
  #drawBar({ left, top, width, height }) {
    const { context } = this.#paper;
    const colours = theme();
    const { title, unit } = QUANTITIES[this.#settings.quantity];
    const grid = this.#grid;
    const from = top + height + BAR.below;
    context.font = `italic 13px ${SERIF}`;
    context.fillStyle = colours.ink;
    context.textAlign = 'left';
    context.textBaseline = 'bottom';
    context.fillText(unit ? `${title} (${unit})` : title, left, from - 5);
    this.#drawPixels(
      context,
      new ImageData(new Uint8ClampedArray(PIXELS.slice().buffer), COLOURS, 1),
      left,
      from,
      width,
      BAR.height,
    );
    context.strokeStyle = colours.muted;
    context.lineWidth = 1;
    context.strokeRect(left + 0.5, from + 0.5, width - 1, BAR.height - 1);
    if (!grid && this.#settings.quantity !== 'survival') return;
    const { low, high } = grid?.scale ?? { low: 0, high: this.#settings.impacts };
    context.font = `13px ${SANS}`;
    context.fillStyle = colours.muted;
    context.textBaseline = 'top';
    context.textAlign = 'center';
    if (!(high > low)) return context.fillText(number(low, 6), left + width / 2, from + BAR.height + 6);
    for (const value of ticks({ low, high }, Math.max(2, width / 90))) {
      const x = left + ((value - low) / (high - low)) * width;
      line(context, colours.muted, x, from + BAR.height, x, from + BAR.height + 4);
      context.fillText(number(value), x, from + BAR.height + 6);
    }
  }

  #drawOverlay() {
    const { context, width, height } = this.#overlay;
    const { frame } = this;
    context.clearRect(0, 0, width, height);
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.width, frame.height);
    context.clip();
    const { cursor, selection } = this;
    if (cursor && !selection && this.#grid) this.#outlineCell(this.#grid, cursor, 8);
    if (selection) {
      const { left, top, right, bottom } = selection;
      context.fillStyle = 'rgb(255 255 255 / 0.25)';
      context.fillRect(left, top, right - left, bottom - top);
      this.#outline(left, top, right - left, bottom - top);
    }
    context.restore();
    if (this.#mark) this.#drawMark(toX(frame, this.#mark.x), toY(frame, this.#mark.y));
  }

  /** Around a cell, and never too small to be found. @param {Grid} grid @param {Cell} cell @param {number} least px */
  #outlineCell(grid, cell, least) {
    const { left, right, top, bottom } = this.#boxOf(grid, cell, cell);
    const [wide, high] = [Math.max(right - left, least) + 2, Math.max(bottom - top, least) + 2];
    this.#outline((left + right - wide) / 2, (top + bottom - high) / 2, wide, high);
  }

  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  #outline(x, y, width, height) {
    const { context } = this.#overlay;
    for (const [colour, wide] of /** @type {const} */ ([
      ['#101820', 3.5],
      ['#fff', 1.5],
    ])) {
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.strokeRect(x, y, width, height);
    }
  }

  /** The point of the scene: the handle of the map. @param {number} x @param {number} y */
  #drawMark(x, y) {
    const { context } = this.#overlay;
    for (const [colour, radius] of /** @type {const} */ ([
      [theme().accent, 11],
      ['#fff', 9],
      [theme().accent, 6],
    ])) {
      context.fillStyle = colour;
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
    }
  }
}
