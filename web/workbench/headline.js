// The verdict and the state of the run in a few words, for when the verdict's card is out of sight.

import { h } from '../dom/elements.js';

/** @param {HTMLElement} place hidden from screen readers, which hear the card and the state themselves @param {HTMLElement} card of the verdict */
export function headline(place, card) {
  const verdict = h('b');
  const run = h('span');
  const tell = () => {
    const words = card.querySelector('.verdict-words');
    verdict.className = ['stable', 'beyond', 'unstable'].find((kind) => words?.classList.contains(kind)) ?? '';
    put(verdict, words?.textContent?.trim() ?? '');
    put(run, ` ${document.getElementById('run-state')?.textContent ?? ''}`);
  };
  const state = document.getElementById('run-state');
  const observer = new MutationObserver(tell);
  for (const part of [card, state])
    if (part) observer.observe(part, { childList: true, subtree: true, characterData: true });
  place.append(verdict, run);
  tell();
  // Beside the card the headline would say the same twice.
  new IntersectionObserver(([{ isIntersecting }]) => place.classList.toggle('unneeded', isIntersecting)).observe(card);
}

/** @param {HTMLElement} element @param {string} text */
function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
