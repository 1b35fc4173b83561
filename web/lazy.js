// Parts of the page below the fold, loaded when they come near. Not for what is in them.

import { h } from './dom.js';

/** @param {string} path @returns {Promise<void>} */
function styles(path) {
  return new Promise((resolve, reject) => {
    document.head.append(h('link', { rel: 'stylesheet', href: path, load: () => resolve(), error: () => reject(new Error(path)) }));
  });
}

/**
 * Once the place is near the viewport, its styles and modules are fetched and `begin` is called with them.
 * @template T
 * @param {HTMLElement} place
 * @param {string} style path of its style sheet
 * @param {() => Promise<T>} load
 * @param {(modules: T) => void} begin
 */
export function lazily(place, style, load, begin) {
  const fetchAll = async () => {
    try {
      const [modules] = await Promise.all([load(), styles(style)]);
      place.replaceChildren();
      begin(modules);
    } catch {
      place.replaceChildren(h('p', { class: 'muted' }, 'This part did not load.'), h('button', { type: 'button', click: fetchAll }, 'Try again'));
    }
  };
  new IntersectionObserver((entries, observer) => {
    if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
    observer.disconnect();
    void fetchAll();
  }, { rootMargin: '100px 0px' }).observe(place);
}
