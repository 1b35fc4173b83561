// Pointer and keys on a map: drag the point of the scene, select a rectangle with Shift, look closer.

import { placeIn } from '../../charts/surface.js';

/** @typedef {import('./picture.js').Cell} Cell */
/** @typedef {{x: number, y: number}} Values of the two fields */

/**
 * @typedef {object} PointerActions
 * @property {(cell: Cell | null) => void} point at a cell, without a press
 * @property {(values: Values, first: boolean) => void} drag the scene to these values
 * @property {() => void} rest the drag has ended
 * @property {(columns: number, rows: number) => void} step moves the scene by so many cells
 * @property {(from: Values, to: Values) => void} select values at two corners, low ends first
 * @property {() => void} closer looks at half of the map around the scene
 */

/** A rectangle thinner than this is none, px. */
const THINNEST = 8;

const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * @param {HTMLElement} box
 * @param {import('./picture.js').MapPicture} picture
 * @param {PointerActions} actions
 */
export function listen(box, picture, actions) {
  /** @type {{x: number, y: number, id: number, selects: boolean} | null} */
  let pressed = null;
  const release = () => {
    if (pressed && box.hasPointerCapture(pressed.id)) box.releasePointerCapture(pressed.id);
    pressed = null;
    picture.select(null);
  };

  box.addEventListener('pointerdown', (event) => {
    const at = placeIn(box, event);
    if (event.button !== 0 || !event.isPrimary || !picture.cellAt(at)) return;
    pressed = { ...at, id: event.pointerId, selects: event.shiftKey };
    box.setPointerCapture(event.pointerId);
    actions.point(null);
    if (!pressed.selects) actions.drag(picture.valuesAt(at), true);
  });
  box.addEventListener('pointermove', (event) => {
    const at = placeIn(box, event);
    if (!pressed) actions.point(picture.cellAt(at));
    else if (pressed.selects) picture.select([pressed, at]);
    else actions.drag(picture.valuesAt(at), false);
  });
  box.addEventListener('pointerup', () => {
    if (!pressed) return;
    const { selects } = pressed;
    const { selection } = picture;
    release();
    if (!selects) return actions.rest();
    if (!selection || selection.right - selection.left < THINNEST || selection.bottom - selection.top < THINNEST)
      return;
    const { left, right, top, bottom } = selection;
    actions.select(picture.valuesAt({ x: left, y: bottom }), picture.valuesAt({ x: right, y: top }));
  });
  box.addEventListener('pointercancel', release);
  box.addEventListener('pointerleave', () => {
    if (!pressed) actions.point(null);
  });

  box.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const far = event.shiftKey ? 10 : 1;
    const step = STEPS[/** @type {keyof typeof STEPS} */ (event.key)];
    if (step) actions.step(far * step[0], far * step[1]);
    else if (event.key === '+' || event.key === '=') actions.closer();
    else if (event.key === 'Escape' && pressed) release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}
