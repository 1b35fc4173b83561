// Views on canvases that keep their pixels sharp while the layout moves, and one shared animation frame.

import { onThemeChange } from './theme.js';

/** @typedef {{draw: (now_ms: number) => boolean}} View draws itself; true when it wants the next frame too */

/** @type {Set<View>} */
let waiting = new Set();
let scheduled = false;

/**
 * Draws this view in the next frame. A hidden tab gets no frames, so nothing is drawn there and all of it at once on return.
 * @param {View} view
 */
export function invalidate(view) {
  waiting.add(view);
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(frame);
}

/** @param {number} now_ms */
function frame(now_ms) {
  scheduled = false;
  const due = waiting;
  waiting = new Set();
  for (const view of due) if (view.draw(now_ms)) invalidate(view);
}

/**
 * @typedef {object} Surface
 * @property {HTMLCanvasElement} canvas
 * @property {CanvasRenderingContext2D} context in px of the drawing: those of CSS, or larger ones where the style says so by `--zoom`
 * @property {number} width
 * @property {number} height
 * @property {number} zoom CSS px in one of the drawing
 */

/** The zoom of each box. @type {WeakMap<Element, number>} */
const zooms = new WeakMap();

/** The place of a pointer in a box, px of its drawing. @param {HTMLElement} box @param {{clientX: number, clientY: number}} event */
export function placeIn(box, { clientX, clientY }) {
  const { left, top } = box.getBoundingClientRect();
  const zoom = zooms.get(box) ?? 1;
  return { x: (clientX - left) / zoom, y: (clientY - top) / zoom };
}

/**
 * Stacked canvases that fill their box.
 * @param {HTMLElement} box
 * @param {number} layers
 * @param {() => void} resized
 * @returns {Surface[]}
 */
export function surfaces(box, layers, resized) {
  const made = Array.from({ length: layers }, () => {
    const canvas = document.createElement('canvas');
    box.append(canvas);
    return {
      canvas,
      context: /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d')),
      width: 0,
      height: 0,
      zoom: 1,
    };
  });
  const fit = () => {
    const { width, height } = box.getBoundingClientRect();
    const zoom = Number(getComputedStyle(box).getPropertyValue('--zoom')) || 1;
    zooms.set(box, zoom);
    const ratio = devicePixelRatio || 1;
    for (const surface of made) {
      surface.canvas.width = Math.round(width * ratio);
      surface.canvas.height = Math.round(height * ratio);
      surface.width = width / zoom;
      surface.height = height / zoom;
      surface.zoom = zoom;
      surface.context.setTransform(ratio * zoom, 0, 0, ratio * zoom, 0, 0);
    }
    resized();
  };
  new ResizeObserver(fit).observe(box);
  return made;
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
    this.layers = surfaces(box, layers, () => this.redraw());
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

  /** @param {number} _now_ms @returns {boolean} true when it wants the next frame too */
  draw(_now_ms) {
    return false;
  }
}
