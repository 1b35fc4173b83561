// Drags by mouse, pen and finger, told from clicks.

import { placeIn } from '../charts/surface.js';

/**
 * @param {HTMLElement} element
 * @param {HTMLElement} box of the places
 * @param {number} slip less than this is a click that slipped, px
 * @param {Drag} acts
 * @returns {() => boolean} ends what is pressed; false if nothing is
 */
export function drags(element, box, slip, { press, drag, release, cancel, hover }) {
  /** @type {Place | null} */
  let pressed = null;
  let dragged = false;
  const end = () => {
    if (pressed === null) return false;
    pressed = null;
    cancel?.(dragged);
    return true;
  };
  element.addEventListener('pointerdown', (event) => {
    const place = placeIn(box, event);
    if (event.button !== 0 || !event.isPrimary || !press(place, event)) return;
    pressed = place;
    dragged = false;
    element.setPointerCapture(event.pointerId);
  });
  element.addEventListener('pointermove', (event) => {
    const place = placeIn(box, event);
    if (pressed === null) return hover?.(place, event);
    if (!dragged && Math.hypot(place.x - pressed.x, place.y - pressed.y) < slip) return;
    drag(place, pressed, !dragged, event);
    dragged = true;
  });
  element.addEventListener('pointerup', (event) => {
    const from = pressed;
    pressed = null;
    if (from) release?.(from, dragged, event);
  });
  element.addEventListener('pointercancel', end);
  // The end of a drag is no click, which would focus the field of a label.
  element.addEventListener('click', (event) => {
    if (dragged) event.preventDefault();
  });
  return end;
}

/** Leaves the focus where it is when an element is pressed: whoever drags goes on with the keys of the page. @param {HTMLElement} element */
export const keepsFocus = (element) => element.addEventListener('mousedown', (event) => event.preventDefault());
