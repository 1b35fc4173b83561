// Dragging a label left and right to change its number.

/** Movement before a press is a drag, px. */
const LEAST_PX = 4;
/** Movement for a step, px. */
const STEP_PX = 3;

/**
 * @param {HTMLElement} label
 * @param {() => ((steps: number, final: boolean) => void) | null} begin gives what moves the value by steps from where it is now, if it can be moved
 */
export function dragLabel(label, begin) {
  /** @type {{x: number, move: (steps: number, final: boolean) => void, dragged: boolean, steps: number} | null} */
  let held = null;
  let dragged = false;
  label.addEventListener('pointerdown', (event) => {
    const move = event.button === 0 ? begin() : null;
    dragged = false;
    held = move && { x: event.clientX, move, dragged: false, steps: 0 };
  });
  label.addEventListener('pointermove', (event) => {
    if (!held) return;
    const way = event.clientX - held.x;
    if (!held.dragged) {
      if (Math.abs(way) < LEAST_PX) return;
      held.dragged = true;
      dragged = true;
      label.setPointerCapture(event.pointerId);
    }
    held.steps = Math.round(way / STEP_PX) * (event.shiftKey ? 10 : 1);
    held.move(held.steps, false);
  });
  // A finger that scrolls the column away takes the value back with it.
  label.addEventListener('pointercancel', () => {
    if (held?.dragged) held.move(0, true);
    held = null;
  });
  label.addEventListener('pointerup', () => {
    if (held?.dragged) held.move(held.steps, true);
    held = null;
  });
  // The end of a drag is no click, which would focus the field.
  label.addEventListener('click', (event) => {
    if (dragged) event.preventDefault();
  });
}
