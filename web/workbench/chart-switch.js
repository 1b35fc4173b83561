// One of several charts where there is no place for all: a switch for two, and tabs over those that one swipes through.

import { h } from '../dom/elements.js';

/** @param {Element} figure */
const nameOf = (figure) => figure.querySelector('h3')?.textContent ?? figure.id;

/** Two charts that share a place. @param {HTMLElement} place of the figures */
export function chartSwitch(place) {
  const buttons = [...place.querySelectorAll('figure')].map((figure) =>
    h('button', { type: 'button', 'aria-controls': figure.id, click: () => show(figure.id) }, nameOf(figure)),
  );
  const show = (/** @type {string} */ id) => {
    place.dataset.shown = id;
    for (const button of buttons)
      button.setAttribute('aria-pressed', String(button.getAttribute('aria-controls') === id));
  };
  show(/** @type {string} */ (place.dataset.shown));
  place.prepend(h('div', { class: 'switch', role: 'group', 'aria-label': 'Chart in this place' }, ...buttons));
}

/** Charts beside each other, one of which fills the width. @param {HTMLElement} list @param {HTMLElement} charts that scroll */
export function chartTabs(list, charts) {
  const buttons = new Map(
    [...charts.querySelectorAll('figure')].map((figure) => [
      figure,
      h(
        'button',
        {
          type: 'button',
          click: () => charts.scrollTo({ left: figure.offsetLeft - charts.offsetLeft, behavior: 'smooth' }),
        },
        nameOf(figure).replace(/ .*/, ''),
      ),
    ]),
  );
  list.replaceChildren(...buttons.values());
  const seen = new IntersectionObserver(
    (entries) => {
      for (const { target, isIntersecting } of entries)
        buttons.get(/** @type {HTMLElement} */ (target))?.setAttribute('aria-current', String(isIntersecting));
    },
    { root: charts, threshold: 0.6 },
  );
  for (const figure of buttons.keys()) seen.observe(figure);
}
