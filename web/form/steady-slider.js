// Keeps a slider where it was when a finger only scrolls past it.

/**
 * A finger that only scrolls past a slider has moved it before the browser knows: then what was there is put back.
 * @param {HTMLInputElement} slider before anything else listens to it
 * @param {() => () => void} hold keeps what the slider stands for, and gives what puts it back
 */
export function steady(slider, hold) {
  /** @type {(() => void) | null} */
  let putBack = null;
  let scrolled = false;
  slider.addEventListener('pointerdown', () => {
    scrolled = false;
    putBack = hold();
  });
  slider.addEventListener('pointercancel', () => {
    scrolled = true;
    putBack?.();
  });
  slider.addEventListener('keydown', () => {
    scrolled = false;
  });
  // The browser tells the cancelled move all the same.
  for (const event of ['input', 'change'])
    slider.addEventListener(event, (told) => {
      if (!scrolled) return;
      told.stopImmediatePropagation();
      putBack?.();
      if (event === 'change') scrolled = false;
    });
}
