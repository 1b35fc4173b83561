// The switch between two charts that share a place where there is none for both.

import { h } from '../dom/elements.js';

/** @param {HTMLElement} place of the figures */
export function chartSwitch(place) {
  const figures = [...place.querySelectorAll('figure')];
  const buttons = figures.map((figure) =>
    h(
      'button',
      {
        type: 'button',
        'aria-controls': figure.id,
        click: () => show(figure.id),
      },
      figure.querySelector('h3')?.textContent ?? figure.id,
    ),
  );
  const show = (/** @type {string} */ id) => {
    place.dataset.shown = id;
    for (const button of buttons)
      button.setAttribute('aria-pressed', String(button.getAttribute('aria-controls') === id));
  };
  show(/** @type {string} */ (place.dataset.shown));
  place.prepend(h('div', { class: 'switch', role: 'group', 'aria-label': 'Chart in this place' }, ...buttons));
}
