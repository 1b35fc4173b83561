// What opens and closes around the scene: menus, the time line, the way to the reasons.

import { byId } from '../dom/elements.js';
import { remember, remembered } from './remembered.js';

/** Opens and closes a menu by its button; a press elsewhere, Escape, and an entry that opens something else close it. @param {HTMLElement} button @param {HTMLElement} menu */
function offerMenu(button, menu) {
  const set = (/** @type {boolean} */ open) => {
    button.setAttribute('aria-expanded', String(open));
    menu.hidden = !open;
  };
  button.addEventListener('click', () => set(menu.hidden !== false));
  document.addEventListener('pointerdown', ({ target }) => {
    if (!menu.hidden && target instanceof Node && !menu.contains(target) && !button.contains(target)) set(false);
  });
  for (const element of [menu, button])
    element.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || menu.hidden) return;
      event.stopPropagation();
      set(false);
      button.focus();
    });
  menu.addEventListener(
    'click',
    ({ target }) => {
      if (!(target instanceof Element) || !target.closest('#time-open, [aria-haspopup]')) return;
      set(false);
      // Before the dialog, which gives the focus back.
      button.focus();
    },
    { capture: true },
  );
}

const STORED = 'equipoise.time';

/** Shows or hides the time line and the exact kicks, in later visits as well. @param {boolean} open */
function showTime(open) {
  byId('time').hidden = !open;
  byId('time-open').setAttribute('aria-pressed', String(open));
  remember(STORED, open);
}

/** @param {() => void} why opens the reasons */
export function bringShell(why) {
  offerMenu(byId('tools-open'), byId('tools'));
  offerMenu(byId('share-open'), byId('share-menu'));
  byId('time-open').addEventListener('click', () => showTime(byId('time').hidden !== false));
  showTime(remembered(STORED, false));
  byId('why').addEventListener('click', why);
}
