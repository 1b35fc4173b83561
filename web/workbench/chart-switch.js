// One of several charts where there is no place for all: a switch for two, and tabs over those that one swipes through.

import { h } from '../dom/elements.js';

/** @param {Element} figure */
const nameOf = (figure) => figure.querySelector('h3')?.textContent ?? figure.id;

/**
 * Two charts that share a place; the shown one is in the address, unless it is the first.
 * @param {HTMLElement} place of the figures
 * @param {() => void} changed
 */
export function chartSwitch(place, changed) {
  const figures = [...place.querySelectorAll('figure')];
  const [first] = figures.map(({ id }) => id);
  const choose = (/** @type {string} */ id) => {
    show(id);
    changed();
  };
  const buttons = figures.map((figure) =>
    h('button', { type: 'button', 'aria-controls': figure.id, click: () => choose(figure.id) }, nameOf(figure)),
  );
  const show = (/** @type {string} */ id) => {
    place.dataset.shown = id;
    for (const button of buttons)
      button.setAttribute('aria-pressed', String(button.getAttribute('aria-controls') === id));
  };
  show(first);
  place.prepend(h('div', { class: 'switch', role: 'group', 'aria-label': 'Chart in this place' }, ...buttons));
  return {
    query: () => new URLSearchParams(place.dataset.shown === first ? [] : [['chart', place.dataset.shown ?? first]]),
    restore: (/** @type {URLSearchParams} */ link) => {
      const wanted = link.get('chart') ?? first;
      const known = figures.some(({ id }) => id === wanted);
      show(known ? wanted : first);
      return known ? [] : [`the chart “${wanted.slice(0, 40)}”, which is not known here`];
    },
  };
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
