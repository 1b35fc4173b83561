// Shows a panel in a dialog as large as the window: the card itself goes there and comes back.

import { h } from '../dom/elements.js';
import { actions } from './save-actions.js';

/** @typedef {import('./save-actions.js').Saves} Saves */

/**
 * @param {HTMLElement} card
 * @param {string} title
 * @param {Saves | null} saves
 */
function enlarge(card, title, saves) {
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

/**
 * The button that opens a panel large, with the actions that save it.
 * @param {HTMLElement} card
 * @param {string} title
 * @param {() => Saves} [saves] where the card itself has no row of them
 */
export function enlarger(card, title, saves) {
  const button = h(
    'button',
    {
      type: 'button',
      class: 'enlarge',
      'aria-haspopup': 'dialog',
      'aria-label': `${saves ? 'Open large, save or embed' : 'Open large'}: ${title}`,
      title: saves ? 'Large, save, embed' : 'Large',
    },
    '⤢',
  );
  button.addEventListener('click', () => enlarge(card, title, saves?.() ?? null));
  return button;
}
