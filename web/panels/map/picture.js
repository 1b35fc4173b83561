// A map on its canvas: cells, colour bar, linear boundary, the scene’s mark.

import { COLOURS, PIXELS } from '../../charts/cividis.js';
import { QUANTITIES, rowsOf } from './settings.js';
import { SANS, SERIF, onThemeChange, theme } from '../../charts/theme.js';
import { drawAxes, line, ticks, toX, toY } from '../../charts/axes.js';
import { invalidate, surfaces } from '../../charts/surface.js';
import { number } from '../../dom/numbers.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {{column: number, row: number}} Cell */
/** @typedef {{left: number, top: number, right: number, bottom: number}} Box in px */

/** Room around the cells: for the numbers of the axes, and below for the colour bar. */
const ROOM = { left: 52, right: 18, top: 24, bottom: 96 };
const BAR = { below: 62, height: 12 };

export class MapPicture {
  /** @type {Grid | null} */
  #grid = null;
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
   * @param {Settings} settings
   * @param {{x: string, y: string}} names of the axes, with units
   * @param {Grid | null} grid
   */
  show(settings, names, grid) {
    this.#settings = settings;
    this.#names = names;
    this.#grid = grid;
    this.selection = null;
    // A cell of another size is another place.
    if (this.cursor && (this.cursor.column >= this.columns || this.cursor.row >= this.rows)) this.cursor = null;
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
    return this.#settings.columns;
  }

  get rows() {
    return rowsOf(this.#settings.columns);
  }

  /** The frame of the cells. Each lies around its values, so the frame reaches half a cell beyond the ends. @returns {import('../../charts/axes.js').Frame} */
  get frame() {
    const { width, height } = this.#paper;
    const { x, y } = this.#settings;
    const [dx, dy] = [(x.to - x.from) / (this.columns - 1) / 2, (y.to - y.from) / (this.rows - 1) / 2];
    return {
      left: ROOM.left,
      top: ROOM.top,
      width: Math.max(1, width - ROOM.left - ROOM.right),
      height: Math.max(1, height - ROOM.top - ROOM.bottom),
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
    const { left, top, width, height } = this.frame;
    const { columns, rows } = this;
    const column = Math.floor(((px - left) / width) * columns);
    const row = Math.floor(((top + height - py) / height) * rows);
    return column >= 0 && column < columns && row >= 0 && row < rows ? { column, row } : null;
  }

  /** The cell of the scene, if it is on the map. */
  cellOfMark() {
    const { frame } = this;
    return this.#mark && this.cellAt(toX(frame, this.#mark.x), toY(frame, this.#mark.y));
  }

  draw() {
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
      const { low, high } = grid.scale;
      const scale = COLOURS / (high - low);
      const image = new ImageData(grid.columns, grid.rows);
      const pixels = new Uint32Array(image.data.buffer);
      const edge = (/** @type {number} */ row) => frame.top + frame.height * (1 - row / grid.rows);
      context.fillStyle = this.#hatching();
      for (let row = 0; row < grid.rows; row += 1) {
        if (!grid.has(row)) continue;
        context.fillRect(frame.left, edge(row + 1), frame.width, edge(row) - edge(row + 1));
        for (let column = 0; column < grid.columns; column += 1) {
          const value = grid.values[row * grid.columns + column];
          if (Number.isNaN(value)) continue;
          const share = high > low ? (value - low) * scale : COLOURS / 2;
          pixels[(grid.rows - 1 - row) * grid.columns + column] =
            PIXELS[Math.max(0, Math.min(COLOURS - 1, Math.floor(share)))];
        }
      }
      this.#drawPixels(image, frame.left, frame.top, frame.width, frame.height);
      context.strokeStyle = colours.muted;
      context.lineWidth = 1;
      context.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
      this.#drawBoundary(frame, grid);
    }
    this.#drawBar(frame);
  }

  /**
   * Pixels drawn large, with sharp edges.
   * @param {ImageData} image
   * @param {number} left
   * @param {number} top
   * @param {number} width
   * @param {number} height
   */
  #drawPixels(image, left, top, width, height) {
    const { context } = this.#paper;
    this.#cells.width = image.width;
    this.#cells.height = image.height;
    this.#cells.getContext('2d')?.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#cells, left, top, width, height);
  }

  /** The pattern of cells without a value. */
  #hatching() {
    const colours = theme();
    const tile = Object.assign(document.createElement('canvas'), { width: 8, height: 8 });
    const context = /** @type {CanvasRenderingContext2D} */ (tile.getContext('2d'));
    context.fillStyle = colours.faint;
    context.fillRect(0, 0, 8, 8);
    context.lineWidth = 1.5;
    for (const shift of [-8, 0, 8]) line(context, colours.muted, shift, 8, shift + 8, 0);
    return this.#paper.context.createPattern(tile, 'repeat') ?? colours.faint;
  }

  /**
   * Light with a dark edge, so that it reads on every colour: unbroken where R = 1, broken where R = 0.
   * @param {import('../../charts/axes.js').Frame} frame
   * @param {Grid} grid
   */
  #drawBoundary(frame, { boundary }) {
    const { context } = this.#paper;
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.width, frame.height);
    context.clip();
    context.lineCap = 'round';
    for (const [colour, wide] of /** @type {const} */ ([
      ['#101820', 4.5],
      ['#fff', 2],
    ])) {
      context.beginPath();
      boundary.forEach(({ residue, x, y }, index) => {
        // Pieces of an even grid, so leaving out every other one breaks the line evenly.
        if (residue === 0 && index % 2 === 1) return;
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
    context.font = `11px ${SANS}`;
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
    if (this.#mark) this.#drawMark(toX(frame, this.#mark.x), toY(frame, this.#mark.y));
    const { cursor, selection } = this;
    if (cursor && !selection) {
      const [w, h] = [frame.width / this.columns, frame.height / this.rows];
      // Around the cell, and never too small to be found.
      const [wide, high] = [Math.max(w, 8), Math.max(h, 8)];
      const x = frame.left + (cursor.column + 0.5) * w;
      const y = frame.top + frame.height - (cursor.row + 0.5) * h;
      this.#outline(x - wide / 2 - 1, y - high / 2 - 1, wide + 2, high + 2);
    }
    if (selection) {
      const { left, top, right, bottom } = selection;
      context.fillStyle = 'rgb(255 255 255 / 0.25)';
      context.fillRect(left, top, right - left, bottom - top);
      this.#outline(left, top, right - left, bottom - top);
    }
    context.restore();
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

  /** A ring with a cross through it. @param {number} x @param {number} y */
  #drawMark(x, y) {
    const { context } = this.#overlay;
    for (const [colour, wide] of /** @type {const} */ ([
      ['#101820', 5],
      ['#fff', 2.25],
    ])) {
      context.strokeStyle = colour;
      context.lineWidth = wide;
      context.beginPath();
      context.arc(x, y, 7, 0, 2 * Math.PI);
      for (const [dx, dy] of [
        [1, 0],
        [-1, 0],
        [0, 1],
        [0, -1],
      ]) {
        context.moveTo(x + dx * 3, y + dy * 3);
        context.lineTo(x + dx * 12, y + dy * 12);
      }
      context.stroke();
    }
  }
}
