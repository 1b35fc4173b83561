// Pointer and keys on a map: drag the point of the scene, select a rectangle with Shift, look closer.

/** @typedef {import('./picture.js').MapPicture} MapPicture */
/** @typedef {import('./picture.js').Cell} Cell */
/** @typedef {{x: number, y: number}} Values of the two fields */

/**
 * @typedef {object} PointerActions
 * @property {(cell: Cell | null) => void} point at a cell, without a press
 * @property {(values: Values, turn: 'first' | 'more' | 'last') => void} drag the scene to these values
 * @property {(columns: number, rows: number) => void} step moves the scene by so many cells
 * @property {(from: Values, to: Values) => void} select values at two corners, low ends first
 * @property {() => Cell | null} place of the scene
 */

/** A rectangle thinner than this is none, px. */
const THINNEST = 8;

/**
 * @param {HTMLElement} box
 * @param {MapPicture} picture
 * @param {PointerActions} actions
 */
export function listen(box, picture, actions) {
  /** @type {{x: number, y: number, id: number, selects: boolean, moved: boolean} | null} */
  let pressed = null;

  /** @param {PointerEvent} event */
  const placeOf = (event) => {
    const { left, top } = box.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };
  /** @param {number} value @param {number} low @param {number} high */
  const within = (value, low, high) => Math.min(high, Math.max(low, value));
  /** The values at a place, kept on the map. @param {{x: number, y: number}} place @returns {Values} */
  const valuesAt = ({ x: px, y: py }) => {
    const { left, top, width, height, x, y } = picture.frame;
    return {
      x: x.low + within((px - left) / width, 0, 1) * (x.high - x.low),
      y: y.low + within((top + height - py) / height, 0, 1) * (y.high - y.low),
    };
  };
  const release = () => {
    if (pressed && box.hasPointerCapture(pressed.id)) box.releasePointerCapture(pressed.id);
    pressed = null;
    picture.selection = null;
    picture.point();
  };

  box.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !event.isPrimary) return;
    const at = placeOf(event);
    if (!picture.cellAt(at.x, at.y)) return;
    pressed = { ...at, id: event.pointerId, selects: event.shiftKey, moved: false };
    box.setPointerCapture(event.pointerId);
    actions.point(null);
    if (!pressed.selects) actions.drag(valuesAt(at), 'first');
  });
  box.addEventListener('pointermove', (event) => {
    const at = placeOf(event);
    if (!pressed) return actions.point(picture.cellAt(at.x, at.y));
    pressed.moved = true;
    if (!pressed.selects) return actions.drag(valuesAt(at), 'more');
    const { left, top, width, height } = picture.frame;
    const [x, y] = [within(at.x, left, left + width), within(at.y, top, top + height)];
    picture.selection = {
      left: Math.min(x, pressed.x),
      right: Math.max(x, pressed.x),
      top: Math.min(y, pressed.y),
      bottom: Math.max(y, pressed.y),
    };
    picture.point();
  });
  box.addEventListener('pointerup', (event) => {
    if (!pressed) return;
    const { selects } = pressed;
    const { selection } = picture;
    release();
    if (!selects) return actions.drag(valuesAt(placeOf(event)), 'last');
    if (!selection || selection.right - selection.left < THINNEST || selection.bottom - selection.top < THINNEST)
      return;
    actions.select(
      valuesAt({ x: selection.left, y: selection.bottom }),
      valuesAt({ x: selection.right, y: selection.top }),
    );
  });
  box.addEventListener('pointercancel', release);
  box.addEventListener('pointerleave', () => {
    if (!pressed) actions.point(null);
  });

  box.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const far = event.shiftKey ? 10 : 1;
    const [dx, dy] = {
      ArrowLeft: [-far, 0],
      ArrowRight: [far, 0],
      ArrowUp: [0, far],
      ArrowDown: [0, -far],
    }[event.key] ?? [0, 0];
    if (dx !== 0 || dy !== 0) actions.step(dx, dy);
    else if (event.key === '+' || event.key === '=') closer();
    else if (event.key === 'Escape' && pressed) release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  /** Half the map around the scene. */
  function closer() {
    const { columns, rows } = picture;
    const { x, y } = picture.frame;
    const { column, row } = actions.place() ?? { column: columns >> 1, row: rows >> 1 };
    /** @param {import('../../charts/axes.js').Range} range @param {number} share @returns {[number, number]} */
    const half = ({ low, high }, share) => {
      const from = within(share - 0.25, 0, 0.5);
      return [low + (high - low) * from, low + (high - low) * (from + 0.5)];
    };
    const [across, upwards] = [half(x, (column + 0.5) / columns), half(y, (row + 0.5) / rows)];
    actions.select({ x: across[0], y: upwards[0] }, { x: across[1], y: upwards[1] });
  }
}
