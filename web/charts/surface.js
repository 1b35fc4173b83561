// A canvas that keeps its pixels sharp while the layout moves, and one shared animation frame.

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
 * @property {CanvasRenderingContext2D} context in CSS pixels
 * @property {number} width
 * @property {number} height
 */

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
    return { canvas, context: /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d')), width: 0, height: 0 };
  });
  const fit = () => {
    const { width, height } = box.getBoundingClientRect();
    const ratio = devicePixelRatio || 1;
    for (const surface of made) {
      surface.canvas.width = Math.round(width * ratio);
      surface.canvas.height = Math.round(height * ratio);
      surface.width = width;
      surface.height = height;
      surface.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    resized();
  };
  new ResizeObserver(fit).observe(box);
  return made;
}
