// Canvases that keep their pixels sharp while the layout moves, the shapes and words on them, and one shared animation frame.

import { SANS, SERIF, colourOf, onThemeChange } from './theme.js';

/** Width and dashes in px. @typedef {{width?: number, dashes?: number[], cap?: CanvasLineCap}} LineLook */
/** Size in px; italic as the name of a quantity. @typedef {{size?: number, italic?: boolean}} Font */
/** @typedef {Font & {colour: Colour, align?: CanvasTextAlign, baseline?: CanvasTextBaseline, widest?: number}} TextLook */
/** @typedef {{draw: (now_ms: number) => boolean}} View draws itself; true when it wants the next frame too */

/** @type {Set<View>} */
let waiting = new Set();

/** Draws this view in the next frame. A hidden tab gets no frames, so nothing is drawn there and all of it at once on return. @param {View} view */
export function invalidate(view) {
  if (waiting.size === 0) requestAnimationFrame(frame);
  waiting.add(view);
}

/** @param {number} now_ms */
function frame(now_ms) {
  const due = waiting;
  waiting = new Set();
  for (const view of due) if (view.draw(now_ms)) invalidate(view);
}

/** CSS px in one of the drawing: more than 1 where the style says so by `--zoom`. @param {Element} box */
const zoomOf = (box) => Number(getComputedStyle(box).getPropertyValue('--zoom')) || 1;

/** The place of a pointer in a box, px of its drawing. @param {HTMLElement} box @param {{clientX: number, clientY: number}} event */
export function placeIn(box, { clientX, clientY }) {
  const { left, top } = box.getBoundingClientRect();
  const zoom = zoomOf(box);
  return { x: (clientX - left) / zoom, y: (clientY - top) / zoom };
}

/** @param {Font} font */
const fontOf = ({ size = 13, italic }) => (italic ? `italic ${size}px ${SERIF}` : `${size}px ${SANS}`);

/** A canvas that fills a box; lengths are px of its drawing. */
export class Surface {
  canvas = document.createElement('canvas');
  context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext('2d'));
  width = 0;
  height = 0;
  /** CSS px in one of the drawing. */
  zoom = 1;

  /** @param {HTMLElement} box */
  fit(box) {
    const { width, height } = box.getBoundingClientRect();
    const ratio = devicePixelRatio || 1;
    this.zoom = zoomOf(box);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.width = width / this.zoom;
    this.height = height / this.zoom;
    this.context.setTransform(ratio * this.zoom, 0, 0, ratio * this.zoom, 0, 0);
  }

  clear() {
    this.context.clearRect(0, 0, this.width, this.height);
  }

  /** Fills the path. @param {Colour} colour */
  fill(colour) {
    this.context.fillStyle = colourOf(colour);
    this.context.fill();
  }

  /** Draws the path. @param {Colour} colour @param {LineLook} [look] */
  stroke(colour, { width = 1, dashes, cap = 'butt' } = {}) {
    const { context } = this;
    context.strokeStyle = colourOf(colour);
    context.lineWidth = width;
    context.lineCap = cap;
    if (dashes) context.setLineDash(dashes);
    context.stroke();
    if (dashes) context.setLineDash([]);
  }

  /** @param {Colour} colour @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {LineLook} [look] */
  line(colour, x0, y0, x1, y1, look) {
    this.context.beginPath();
    this.context.moveTo(x0, y0);
    this.context.lineTo(x1, y1);
    this.stroke(colour, look);
  }

  /** @param {number} x @param {number} y @param {number} r @param {LineLook & {fill?: Colour, stroke?: Colour}} look */
  disc(x, y, r, { fill, stroke, ...look }) {
    this.context.beginPath();
    this.context.arc(x, y, r, 0, 2 * Math.PI);
    if (fill) this.fill(fill);
    if (stroke) this.stroke(stroke, look);
  }

  /** @param {string} words @param {number} x @param {number} y @param {TextLook} look */
  text(words, x, y, { colour, align = 'left', baseline = 'top', widest, ...font }) {
    const { context } = this;
    context.font = fontOf(font);
    context.fillStyle = colourOf(colour);
    context.textAlign = align;
    context.textBaseline = baseline;
    context.fillText(words, x, y, widest);
  }

  /** Width of words, px. @param {string} words @param {Font} [font] */
  widthOf(words, font = {}) {
    this.context.font = fontOf(font);
    return this.context.measureText(words).width;
  }

  /** Draws with an opacity. @param {number} opacity @param {() => void} draw */
  faintly(opacity, draw) {
    const { context } = this;
    const before = context.globalAlpha;
    context.globalAlpha = before * opacity;
    draw();
    context.globalAlpha = before;
  }

  /** Draws within a rectangle only. @param {{left: number, top: number, width: number, height: number}} rectangle @param {() => void} draw */
  within({ left, top, width, height }, draw) {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    draw();
    context.restore();
  }
}

/** A view on canvases that fill a box. It is drawn anew when the box, the colours or the unit of angles change. */
export class CanvasView {
  /** The canvases, the lowest first. */
  layers;
  /** True when all of it is to be drawn anew. */
  stale = true;
  /** Scrolled out of sight, it costs nothing. */
  seen = true;

  /** @param {HTMLElement} box @param {number} layers */
  constructor(box, layers) {
    this.layers = Array.from({ length: layers }, () => new Surface());
    box.append(...this.layers.map(({ canvas }) => canvas));
    new ResizeObserver(() => {
      for (const layer of this.layers) layer.fit(box);
      this.redraw();
    }).observe(box);
    onThemeChange(() => this.redraw());
    new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      this.redraw();
    }).observe(box);
  }

  redraw() {
    this.stale = true;
    invalidate(this);
  }

  /** True once where all of it is to be drawn anew. */
  takeStale() {
    const { stale } = this;
    this.stale = false;
    return stale;
  }

  /** @param {number} _now_ms @returns {boolean} true when it wants the next frame too */
  draw(_now_ms) {
    return false;
  }
}
