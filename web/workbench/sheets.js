// Parts of the page that are sheets over it on a phone: one open at a time, closed by Escape, the focus led there and back.

import { h } from '../dom/elements.js';

/** @param {HTMLElement} bar of the buttons that open them */
export function sheets(bar) {
  const buttons = [...bar.querySelectorAll('button')];
  /** @type {HTMLElement | null} */
  let open = null;
  const partOf = (/** @type {HTMLElement} */ button) =>
    /** @type {HTMLElement} */ (document.getElementById(button.getAttribute('aria-controls') ?? ''));
  const close = (/** @type {boolean} */ back) => {
    if (!open) return;
    open.classList.remove('open');
    const button = /** @type {HTMLElement} */ (buttons.find((one) => partOf(one) === open));
    button.setAttribute('aria-expanded', 'false');
    open = null;
    if (back) button.focus({ preventScroll: true });
  };
  for (const button of buttons) {
    const part = partOf(button);
    const shut = h(
      'button',
      { type: 'button', class: 'sheet-close', 'aria-label': 'Close', click: () => close(true) },
      '×',
    );
    part.prepend(shut);
    button.disabled = false;
    const show = () => {
      close(false);
      open = part;
      part.classList.add('open');
      button.setAttribute('aria-expanded', 'true');
    };
    button.addEventListener('click', () => {
      if (open === part) return close(false);
      show();
      shut.focus({ preventScroll: true });
    });
    // Something in the part is to be seen, such as a tab that a key has opened.
    document.addEventListener('show-part', (event) => {
      const id = /** @type {CustomEvent<string>} */ (event).detail;
      if (id === part.id && open !== part && button.offsetParent !== null) show();
    });
    part.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || event.defaultPrevented || open !== part) return;
      close(true);
    });
  }
  // A press on a scene below asks for the scene.
  document.addEventListener('pointerdown', ({ target }) => {
    if (target instanceof Element && target.closest('#scene-frame, .bar, .charts')) close(false);
  });
  document.addEventListener('show-scene', () => close(false));
}
