// Shows a panel in a dialog as large as the window: the card itself goes there and comes back.

import { h } from '../dom/elements.js';
import { html, render } from '../vendor/preact/preact.js';
import { SaveActions } from './save-actions.js';

/** @param {HTMLElement} card @param {string} title @param {Saves | null} saves */
function enlarge(card, title, saves) {
  if (card.closest('dialog')) return;
  // A placeholder keeps the card's size, so that nothing jumps.
  const { height } = card.getBoundingClientRect();
  const room = h('div', { class: card.className });
  room.style.height = `${height}px`;
  const actions = h('p', { class: 'actions' });
  if (saves) render(html`<${SaveActions} ...${saves} />`, actions);
  const close = h('button', { class: 'close' }, 'Close');
  const head = h('form', { method: 'dialog', class: 'large-head' }, saves && actions, close);
  // The focus is on none of its buttons, so that the keys of the run act here as well.
  const dialog = h('dialog', { class: 'large', 'aria-label': title, tabindex: -1 }, head);
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
  const label = `${saves ? 'Open large, save or embed' : 'Open large'}: ${title}`;
  return h(
    'button',
    {
      type: 'button',
      class: 'enlarge',
      'aria-haspopup': 'dialog',
      'aria-label': label,
      title: saves ? 'Large, save, embed' : 'Large',
      click: () => enlarge(card, title, saves?.() ?? null),
    },
    '⤢',
  );
}
