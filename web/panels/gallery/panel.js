// The failure gallery: cards of scenes on which a usual method is wrong, each ready to run.

import { get, wordsOf } from '../../api/client.js';
import { actions } from '../../export/save-actions.js';
import { h, retryButton } from '../../dom/elements.js';
import { marked } from '../../dom/typeset.js';
import { number, quantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Failure} Failure */

/** With a capital, unless it begins with a symbol, whose capital is another one. @param {string} words */
const begun = (words) => (/^(?:[a-z]{2}|a )/.test(words) ? words[0].toUpperCase() + words.slice(1) : words);

/** @param {string} words */
const sentence = (words) => marked(begun(words) + (/[.!?]$/.test(words) ? '' : '.'));

/** From where the page is, behind whatever proxy. @param {string} path */
const here = (path) => path.replace(/^\//, '');

/** So near to 1 that only the distance tells anything. @param {number} value */
const nearOne = (value) => value !== 1 && Math.abs(value - 1) < 1e-6;

/** @param {number} value @param {string | null} unit */
const rested = (value, unit) =>
  nearOne(value) && unit === null
    ? `1 ${value > 1 ? '+' : '\u2212'} ${number(Math.abs(value - 1), 3)}`
    : quantity(value, unit);

/** @param {Failure['says'][number]} says */
function row({ method, verdict, value, unit, right, detail }) {
  return h(
    'li',
    { class: right ? 'right' : 'wrong' },
    h('span', { class: 'sign', 'aria-hidden': 'true' }, right ? '✓' : '✗'),
    h(
      'div',
      {},
      h(
        'p',
        { class: 'claim' },
        h('span', {}, ...marked(begun(method)), ': '),
        h('strong', {}, ...marked(verdict)),
        value === null ? '' : ` (${rested(value, unit)})`,
        ' ',
        h('span', { class: 'chip' }, right ? 'right' : 'wrong'),
      ),
      h('p', { class: 'muted' }, ...sentence(detail)),
    ),
  );
}

/** @param {Failure} failure @param {(failure: Failure) => void} play */
function card(failure, play) {
  const { name, title, method, why, says, truth, ask, picture } = failure;
  const heading = `failure-${name}`;
  return h(
    'article',
    { class: 'failure', 'aria-labelledby': heading },
    h('h3', { id: heading }, ...marked(title)),
    h('p', { class: 'muted' }, 'The usual method: ', ...marked(method), '.'),
    h('ul', { class: 'says', 'aria-label': 'What each method says' }, ...says.map(row)),
    h(
      'p',
      { class: 'truth' },
      h('strong', {}, 'In truth: ', ...marked(truth.verdict), '. '),
      ...sentence(truth.detail),
    ),
    h('p', {}, ...marked(why)),
    h(
      'a',
      { class: 'picture', href: `${here(picture)}`, tabindex: 0 },
      h('img', {
        src: here(picture),
        loading: 'lazy',
        width: 720,
        height: 542,
        alt: `Picture: ${title}. It opens by itself.`,
      }),
    ),
    h(
      'p',
      { class: 'actions' },
      h('button', { type: 'button', 'aria-describedby': heading, click: () => play(failure) }, 'Load and run'),
      h('a', { href: here(ask), 'aria-label': `Ask the server: ${title}` }, 'Ask the server'),
    ),
  );
}

/** @type {import('../card.js').Module['mount']} */
export function mount(root, { play }) {
  void show(root, ({ scene }) => play(scene));
  return {};
}

/** @param {HTMLElement} root @param {(failure: Failure) => void} play */
async function show(root, play) {
  const told = h('p', { class: 'muted', role: 'status' }, 'Every method is being asked…');
  root.replaceChildren(told);
  try {
    const { failures } = await get('v1/failures');
    root.replaceChildren(
      h('div', { class: 'failures' }, ...failures.map((/** @type {Failure} */ failure) => card(failure, play))),
      h(
        'p',
        { class: 'actions' },
        ...actions({ id: 'gallery', title: 'Where usual methods fail', path: 'v1/failures?', formats: ['json'] }),
      ),
    );
  } catch (error) {
    told.textContent = wordsOf(error);
    root.append(retryButton(() => void show(root, play)));
  }
}
