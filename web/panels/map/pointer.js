// Pointer and keys on a map: point at a cell, take it, select a rectangle, look closer.

/** @typedef {import('./picture.js').MapPicture} MapPicture */
/** @typedef {import('./picture.js').Cell} Cell */

/**
 * @typedef {object} PointerActions
 * @property {(cell: Cell | null, byKey: boolean) => void} point
 * @property {(cell: Cell, byKey: boolean) => void} take
 * @property {(from: {x: number, y: number}, to: {x: number, y: number}) => void} select values at two corners, low ends first
 * @property {() => Cell} begin where keys start from
 */

/** Less than this is a click that slipped, px. */
const SLIP = 5;
/** A rectangle thinner than this is none, px. */
const THINNEST = 8;

/**
 * @param {HTMLElement} box
 * @param {MapPicture} picture
 * @param {PointerActions} actions
 */
export function listen(box, picture, actions) {
  /** @type {{x: number, y: number, id: number} | null} */
  let pressed = null;
  let dragging = false;

  /** @param {PointerEvent} event */
  const place = (event) => {
    const { left, top } = box.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  };
  /** @param {number} value @param {number} low @param {number} high */
  const within = (value, low, high) => Math.min(high, Math.max(low, value));
  const release = () => {
    if (pressed && box.hasPointerCapture(pressed.id)) box.releasePointerCapture(pressed.id);
    pressed = null;
    dragging = false;
    picture.selection = null;
    picture.point();
  };
  /** @param {Cell | null} cell @param {boolean} byKey */
  const point = (cell, byKey) => {
    picture.cursor = cell;
    picture.point();
    actions.point(cell, byKey);
  };

  box.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !event.isPrimary) return;
    const at = place(event);
    if (!picture.cellAt(at.x, at.y)) return;
    pressed = { ...at, id: event.pointerId };
    box.setPointerCapture(event.pointerId);
  });
  box.addEventListener('pointermove', (event) => {
    const at = place(event);
    if (!pressed) return point(picture.cellAt(at.x, at.y), false);
    if (Math.hypot(at.x - pressed.x, at.y - pressed.y) >= SLIP) dragging = true;
    if (!dragging) return;
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
    const { selection } = picture;
    const cell = dragging ? null : picture.cellAt(pressed.x, pressed.y);
    release();
    if (cell) {
      point(cell, false);
      return actions.take(cell, false);
    }
    if (!selection || selection.right - selection.left < THINNEST || selection.bottom - selection.top < THINNEST)
      return;
    const { left, top, width, height, x, y } = picture.frame;
    /** @param {number} px */
    const across = (px) => x.low + ((px - left) / width) * (x.high - x.low);
    /** @param {number} py */
    const upwards = (py) => y.low + ((top + height - py) / height) * (y.high - y.low);
    actions.select(
      { x: across(selection.left), y: upwards(selection.bottom) },
      { x: across(selection.right), y: upwards(selection.top) },
    );
    event.preventDefault();
  });
  box.addEventListener('pointercancel', release);
  box.addEventListener('pointerleave', () => {
    if (!pressed) point(null, false);
  });

  box.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { columns, rows } = picture;
    const cell = picture.cursor ?? actions.begin();
    const far = event.shiftKey ? 10 : 1;
    const [dx, dy] = {
      ArrowLeft: [-far, 0],
      ArrowRight: [far, 0],
      ArrowUp: [0, far],
      ArrowDown: [0, -far],
      Home: [-columns, 0],
      End: [columns, 0],
      PageUp: [0, rows],
      PageDown: [0, -rows],
    }[event.key] ?? [0, 0];
    if (dx !== 0 || dy !== 0) {
      // The first key shows where the cursor is.
      point(
        picture.cursor
          ? { column: within(cell.column + dx, 0, columns - 1), row: within(cell.row + dy, 0, rows - 1) }
          : cell,
        true,
      );
    } else if (event.key === 'Enter' && picture.cursor) actions.take(cell, true);
    else if (event.key === '+' || event.key === '=') closer(cell);
    else if (event.key === 'Escape' && pressed) release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  /** Half the map around a cell. @param {Cell} cell */
  function closer(cell) {
    const { columns, rows } = picture;
    const { x, y } = picture.frame;
    /** @param {import('../../charts/axes.js').Range} range @param {number} share @returns {[number, number]} */
    const half = ({ low, high }, share) => {
      const from = within(share - 0.25, 0, 0.5);
      return [low + (high - low) * from, low + (high - low) * (from + 0.5)];
    };
    const [across, upwards] = [half(x, (cell.column + 0.5) / columns), half(y, (cell.row + 0.5) / rows)];
    actions.select({ x: across[0], y: upwards[0] }, { x: across[1], y: upwards[1] });
  }
}
