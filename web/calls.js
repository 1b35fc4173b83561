// What the page shows, as calls to the API that give the same. Not for making them.

import { copy, h } from './dom.js';

/** What a shell must not read. @param {string} text */
const quoted = (text) => `'${text.replaceAll("'", "'\\''")}'`;

/** The command that asks the same. @param {string} path from where the page is */
export const curl = (path) => `curl ${quoted(new URL(path, new URL('.', location.href)).href)}`;

/**
 * @param {HTMLElement} root
 * @param {URLSearchParams} scene
 * @param {boolean} changed whether the run was changed under way, which only its live address can repeat
 */
export function showCalls(root, scene, changed) {
  const calls = [
    { title: 'Verdict and eigenvalues', path: `v1/stability?${scene}` },
    { title: 'Every impact, as columns', path: `v1/trajectories?${scene}&impacts=1000` },
    { title: 'The same as CSV', path: `v1/trajectories?${scene}&impacts=1000&format=csv` },
    { title: 'Jacobian at the fixed point', path: `v1/jacobians?${scene}` },
  ];
  root.replaceChildren(...calls.map(({ title, path }) => {
    const line = curl(path);
    return h('div', { class: 'call' }, h('p', {}, title), h('code', { tabindex: 0 }, line),
      h('p', { class: 'actions' }, h('button', { type: 'button', 'aria-label': `Copy curl: ${title}`, click: (/** @type {Event} */ event) => void copy(/** @type {HTMLElement} */ (event.currentTarget), line) }, 'Copy curl'),
        h('a', { href: path, 'aria-label': `Open: ${title}` }, 'Open')));
  }), h('p', { class: 'muted' }, changed ? 'These run the scene from its release; what was changed on the way is in the link of the page only.' : ''));
}
