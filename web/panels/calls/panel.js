// The panel of calls to the API that give what the page shows, for a shell, for Python and for JavaScript.

import { copy } from '../../dom/clipboard.js';
import { h } from '../../dom/elements.js';
import { LANGUAGES, call } from './languages.js';

/** @typedef {import('./languages.js').Language} Language */

/** @type {import('../card.js').Module['mount']} */
export function mount(root, { query, played, changed }) {
  /** @type {Language} */
  let language = 'curl';
  const list = h('div');
  const names = /** @type {Language[]} */ (Object.keys(LANGUAGES));
  const choices = names.map((name) =>
    h(
      'label',
      { class: 'choice' },
      h('input', {
        type: 'radio',
        name: 'calls-language',
        value: name,
        checked: name === language,
        change: () => {
          language = name;
          show();
          changed();
        },
      }),
      ` ${LANGUAGES[name].title}`,
    ),
  );
  root.append(h('fieldset', { class: 'choices' }, h('legend', { class: 'unseen' }, 'Language'), ...choices), list);

  const show = () => {
    const [scene, run] = [query(), played()];
    if (!scene || !run) return;
    const calls = [
      { title: 'Verdict and eigenvalues', path: `v1/stability?${scene}` },
      { title: 'Every bounce, as columns', path: `v1/trajectories?${run}&bounces=1000` },
      { title: 'The same as CSV', path: `v1/trajectories?${run}&bounces=1000&format=csv` },
      { title: 'Jacobian at the fixed point', path: `v1/jacobians?${scene}` },
    ];
    list.replaceChildren(
      ...calls.map(({ title, path }) => {
        const code = call(language, path);
        const name = `Copy ${LANGUAGES[language].short}`;
        return h(
          'div',
          { class: 'call' },
          h('h3', {}, title),
          h(
            'pre',
            { tabindex: 0, role: 'region', 'aria-label': `${LANGUAGES[language].title}: ${title}` },
            h('code', {}, code),
          ),
          h(
            'p',
            { class: 'actions' },
            h(
              'button',
              {
                type: 'button',
                'aria-label': `${name}: ${title}`,
                click: (/** @type {Event} */ event) =>
                  void copy(/** @type {HTMLElement} */ (event.currentTarget), code),
              },
              name,
            ),
            h('a', { href: path, 'aria-label': `Open: ${title}` }, 'Open'),
          ),
        );
      }),
    );
  };

  show();
  return {
    sceneChanged: show,
    played: show,
    query: () => new URLSearchParams(language === 'curl' ? [] : [['calls.language', language]]),
    restore: (link) => {
      const wanted = link.get('calls.language') ?? 'curl';
      const known = Object.hasOwn(LANGUAGES, wanted);
      language = known ? /** @type {Language} */ (wanted) : 'curl';
      for (const choice of choices) {
        const input = /** @type {HTMLInputElement} */ (choice.firstElementChild);
        input.checked = input.value === language;
      }
      show();
      return known ? [] : [`the language “${wanted.slice(0, 40)}” of the calls`];
    },
  };
}
