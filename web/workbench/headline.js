// The verdict and the run in a few words, for when the verdict's card is out of sight.

import { h } from '../dom/elements.js';

/** @param {HTMLElement} place hidden from screen readers, which hear the card itself @param {HTMLElement} card of the verdict */
export function headline(place, card) {
  const verdict = h('b');
  const run = h('span');
  const tell = () => {
    const words = card.querySelector('.verdict-words');
    verdict.className = ['stable', 'beyond', 'unstable'].find((kind) => words?.classList.contains(kind)) ?? '';
    put(verdict, words?.querySelector('.headline')?.textContent ?? '');
    place.setAttribute('aria-busy', String(card.querySelector('#verdict[aria-busy=true]') !== null));
    const told = card.querySelector('#this-run .headline')?.textContent ?? '';
    put(run, told && ` · ${told}`);
    run.className = ['fell', 'kept'].find((fate) => card.querySelector(`#this-run.${fate}`)) ?? '';
  };
  new MutationObserver(tell).observe(card, {
    childList: true,
    subtree: true,
    characterData: true,
    attributeFilter: ['aria-busy', 'class'],
  });
  place.append(verdict, run);
  tell();
  // Beside the card the headline would say the same twice.
  new IntersectionObserver(([{ isIntersecting }]) => place.classList.toggle('unneeded', isIntersecting)).observe(card);
}

/** @param {HTMLElement} element @param {string} text */
function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
