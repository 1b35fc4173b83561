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

/**
 * A case in one line, which unfolds.
 * @param {Failure} failure
 * @param {(failure: Failure) => void} play
 * @param {(details: HTMLDetailsElement) => void} toggled
 */
function card(failure, play, toggled) {
  const { name, title, method, why, says, truth, ask, picture } = failure;
  const heading = `failure-${name}`;
  const wrong = says.filter(({ right }) => !right).length;
  return h(
    'article',
    { class: 'failure', 'aria-labelledby': heading },
    h(
      'details',
      {
        'data-case': name,
        toggle: (/** @type {Event} */ event) => toggled(/** @type {HTMLDetailsElement} */ (event.currentTarget)),
      },
      h(
        'summary',
        {},
        h('h3', { id: heading }, ...marked(title)),
        h('span', { class: 'muted' }, ...marked(begun(method))),
        h('span', { class: 'chip wrong' }, `${wrong} of ${says.length} wrong`),
      ),
      h(
        'div',
        { class: 'failure-body' },
        h(
          'div',
          {},
          h(
            'p',
            { class: 'truth' },
            h('strong', {}, 'In truth: ', ...marked(truth.verdict), '. '),
            ...sentence(truth.detail),
          ),
          h('ul', { class: 'says', 'aria-label': 'What each method says' }, ...says.map(row)),
          h('p', {}, ...marked(why)),
          h(
            'p',
            { class: 'actions' },
            h('button', { type: 'button', 'aria-describedby': heading, click: () => play(failure) }, 'Load and run'),
            h('a', { href: here(ask), 'aria-label': `Ask the server: ${title}` }, 'Ask the server'),
          ),
        ),
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
      ),
    ),
  );
}

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new Gallery(root, page);

class Gallery {
  #root;
  #page;
  /** The case that is unfolded, and in the address. */
  #open = '';
  #listed = false;

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#root = root;
    this.#page = page;
    void this.#show();
  }

  /** The panel's part of the address. */
  query() {
    return new URLSearchParams(this.#open ? [['gallery.case', this.#open]] : []);
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    this.#open = link.get('gallery.case') ?? '';
    return this.#listed ? this.#unfold() : [];
  }

  /** Opens the case of the address alone; the words about one that is not there. */
  #unfold() {
    const wanted = this.#open;
    const all = /** @type {NodeListOf<HTMLDetailsElement>} */ (this.#root.querySelectorAll('details[data-case]'));
    for (const details of all) details.open = details.dataset.case === wanted;
    const found = [...all].find(({ open }) => open);
    found?.scrollIntoView({ block: 'nearest' });
    if (found || !wanted) return [];
    this.#open = '';
    return [`the case “${wanted.slice(0, 40)}”, which is not among those here`];
  }

  async #show() {
    const told = h('p', { class: 'muted', role: 'status' }, 'Every method is being asked…');
    this.#root.replaceChildren(told);
    try {
      const { failures } = await get('v1/failures');
      const play = (/** @type {Failure} */ { scene }) => this.#page.play(scene);
      this.#root.replaceChildren(
        h(
          'div',
          { class: 'failures' },
          ...failures.map((/** @type {Failure} */ failure) => card(failure, play, (details) => this.#toggled(details))),
        ),
        h(
          'p',
          { class: 'actions' },
          ...actions({ id: 'gallery', title: 'Where usual methods fail', path: 'v1/failures?', formats: ['json'] }),
        ),
      );
      this.#listed = true;
      const [gone] = this.#unfold();
      if (gone) this.#root.prepend(h('p', { class: 'muted', role: 'status' }, `Dropped of the link: ${gone}.`));
    } catch (error) {
      told.textContent = wordsOf(error);
      this.#root.append(retryButton(() => void this.#show()));
    }
  }

  /** @param {HTMLDetailsElement} details */
  #toggled({ open, dataset }) {
    const name = dataset.case ?? '';
    const before = this.#open;
    if (open) this.#open = name;
    else if (this.#open === name) this.#open = '';
    if (this.#open !== before) this.#page.changed();
  }
}
