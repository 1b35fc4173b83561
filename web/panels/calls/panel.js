// The panel of calls to the API that give what the page shows.

import { copy } from '../../dom/clipboard.js';
import { h } from '../../dom/elements.js';
import { curl } from '../../export/save-actions.js';

/** @type {import('../card.js').Module['mount']} */
export function mount(root, { query, played }) {
  const show = () => {
    const [scene, run] = [query(), played()];
    if (!scene || !run) return;
    const calls = [
      { title: 'Verdict and eigenvalues', path: `v1/stability?${scene}` },
      { title: 'Every impact, as columns', path: `v1/trajectories?${run}&impacts=1000` },
      { title: 'The same as CSV', path: `v1/trajectories?${run}&impacts=1000&format=csv` },
      { title: 'Jacobian at the fixed point', path: `v1/jacobians?${scene}` },
    ];
    root.replaceChildren(
      ...calls.map(({ title, path }) => {
        const line = curl(path);
        return h(
          'div',
          { class: 'call' },
          h('p', {}, title),
          h('code', { tabindex: 0 }, line),
          h(
            'p',
            { class: 'actions' },
            h(
              'button',
              {
                type: 'button',
                'aria-label': `Copy curl: ${title}`,
                click: (/** @type {Event} */ event) =>
                  void copy(/** @type {HTMLElement} */ (event.currentTarget), line),
              },
              'Copy curl',
            ),
            h('a', { href: path, 'aria-label': `Open: ${title}` }, 'Open'),
          ),
        );
      }),
    );
  };
  show();
  return { sceneChanged: show, played: show };
}
