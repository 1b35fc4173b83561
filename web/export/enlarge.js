// Shows a panel in a dialog as large as the window: the card itself goes there and comes back.

import { actions } from './save-actions.js';
import { h } from '../dom/elements.js';

/**
 * @param {HTMLElement} card
 * @param {string} title
 * @param {import('./save-actions.js').Saves | null} saves
 */
export function enlarge(card, title, saves) {
  if (card.closest('dialog')) return;
  // A placeholder keeps the card's size, so that nothing jumps.
  const { height } = card.getBoundingClientRect();
  const room = h('div', { class: card.className });
  room.style.height = `${height}px`;
  const dialog = h(
    'dialog',
    // The focus is on none of its buttons, so that the keys of the run act here as well.
    { class: 'large', 'aria-label': title, tabindex: -1 },
    h(
      'form',
      { method: 'dialog', class: 'large-head' },
      ...(saves ? [h('p', { class: 'actions' }, ...actions(saves))] : []),
      h('button', { class: 'close' }, 'Close'),
    ),
  );
  card.before(room);
  dialog.append(card);
  document.body.append(dialog);
  dialog.addEventListener('close', () => {
    room.replaceWith(card);
    dialog.remove();
    /** @type {HTMLElement | null} */ (card.querySelector('button.enlarge'))?.focus();
  });
  dialog.showModal();
  dialog.focus();
}
