// The button that opens a panel large, with the actions that save it. The first press loads their code.

import { h } from '../dom/elements.js';

/** @typedef {import('./save-actions.js').Saves} Saves */

/**
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
  button.addEventListener('click', async () => {
    const { enlarge } = await import('./enlarge.js');
    enlarge(card, title, saves?.() ?? null);
  });
  return button;
}
