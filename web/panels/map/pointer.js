// Pointer and keys on a map: drag the point of the scene, select a rectangle with Shift, look closer.

import { placeIn } from '../../charts/surface.js';
import { useRef } from '../../vendor/preact/preact.js';

/** @typedef {{x: number, y: number}} Values of the two fields */

/**
 * @typedef {object} PointerActions
 * @property {(cell: import('./words.js').Cell | null) => void} point at a cell, without a press
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
 * Listeners for the box of a map.
 * @param {() => import('./picture.js').MapPicture} pictureOf
 * @param {PointerActions} actions
 */
export function usePointer(pictureOf, actions) {
  const pressed = useRef(/** @type {{x: number, y: number, id: number, selects: boolean} | null} */ (null));
  const release = (/** @type {{currentTarget: HTMLElement}} */ { currentTarget: box }) => {
    const { id = -1 } = pressed.current ?? {};
    if (box.hasPointerCapture(id)) box.releasePointerCapture(id);
    pressed.current = null;
    pictureOf().select(null);
  };
  /** @typedef {PointerEvent & {currentTarget: HTMLElement}} Pointed */
  return {
    onPointerDown: (/** @type {Pointed} */ event) => {
      const { currentTarget: box, button, isPrimary, pointerId: id, shiftKey: selects } = event;
      const at = placeIn(box, event);
      if (button !== 0 || !isPrimary || !pictureOf().cellAt(at)) return;
      pressed.current = { ...at, id, selects };
      box.setPointerCapture(id);
      actions.point(null);
      if (!selects) actions.drag(pictureOf().valuesAt(at), true);
    },
    onPointerMove: (/** @type {Pointed} */ event) => {
      const at = placeIn(event.currentTarget, event);
      if (!pressed.current) actions.point(pictureOf().cellAt(at));
      else if (pressed.current.selects) pictureOf().select([pressed.current, at]);
      else actions.drag(pictureOf().valuesAt(at), false);
    },
    onPointerUp: (/** @type {Pointed} */ event) => {
      if (!pressed.current) return;
      const { selects } = pressed.current;
      const { selection } = pictureOf();
      release(event);
      if (!selects) return actions.rest();
      const { left, right, top, bottom } = selection ?? { left: 0, right: 0, top: 0, bottom: 0 };
      if (right - left < THINNEST || bottom - top < THINNEST) return;
      actions.select(pictureOf().valuesAt({ x: left, y: bottom }), pictureOf().valuesAt({ x: right, y: top }));
    },
    onPointerCancel: release,
    onPointerLeave: () => {
      if (!pressed.current) actions.point(null);
    },
    onKeyDown: (/** @type {KeyboardEvent & {currentTarget: HTMLElement}} */ event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const far = event.shiftKey ? 10 : 1;
      const step = STEPS[/** @type {keyof typeof STEPS} */ (event.key)];
      if (step) actions.step(far * step[0], far * step[1]);
      else if (event.key === '+' || event.key === '=') actions.closer();
      else if (event.key === 'Escape' && pressed.current) release(event);
      else return;
      event.preventDefault();
      event.stopPropagation();
    },
  };
}
