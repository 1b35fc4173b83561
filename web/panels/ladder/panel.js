// The panel of the model that the page's scene needs: a row for each level, with what it changes.

import { table } from '../../dom/tables.js';
import { LatestRequest } from '../../api/latest-request.js';
import { MOST_IMPACTS, get, wordsOf } from '../../api/client.js';
import { h, retryButton } from '../../dom/elements.js';
import { inWords, marked, prose } from '../../dom/typeset.js';
import { debounce } from '../../dom/debounce.js';
import { actions } from '../../export/save-actions.js';
import { numberInput, wholeNumber } from '../../dom/number-input.js';
import { number, quantity } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';

/** @typedef {import('contract').Ladder['rungs'][number]} Rung */

const CHANGES = /** @type {const} */ ([
  ['t', 's'],
  ['x', 'm'],
  ['theta', 'rad'],
  ['x_dot', 'm/s'],
  ['y_dot', 'm/s'],
  ['theta_dot', 'rad/s'],
]);
const SYMBOLS = { t: 't', x: 'x', theta: 'θ', x_dot: 'ẋ', y_dot: 'ẏ', theta_dot: 'θ̇' };
/** m/s */
const MOST_DIFFERENCE = 10;

/** @param {string} name */
const words = (name) => name.replaceAll('_', ' ');

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new Ladder(root, page);

/** The values at first. */
const USUAL = { impacts: '100', tolerance: '0.001' };

class Ladder {
  #page;
  #error = h('p', { class: 'error', id: 'ladder-error' });
  #impacts = numberInput(
    { id: 'ladder-impacts', inputmode: 'numeric', value: USUAL.impacts, change: () => this.#changed() },
    this.#error,
    { unit: null, fault: wholeNumber(1, MOST_IMPACTS, 'Bounces') },
  );
  #tolerance = numberInput(
    { id: 'ladder-tolerance', value: USUAL.tolerance, change: () => this.#changed() },
    this.#error,
    {
      unit: 'm/s',
      fault: (value) =>
        value > 0 && value <= MOST_DIFFERENCE
          ? null
          : `The difference must be a number above 0 and up to ${MOST_DIFFERENCE} m/s.`,
    },
  );
  #told = h('p', { id: 'ladder-told', role: 'status' });
  #body = h('tbody');
  #links = h('p', { class: 'actions', id: 'ladder-links' });
  #sheet;
  #near = false;
  #shown = '';
  #latest = new LatestRequest();

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    const head = [
      'Model',
      'asked for by',
      'ns/bounce',
      'it ends',
      'against the one below',
      'most in the state',
      'needed',
    ];
    this.#sheet = h(
      'div',
      { class: 'ladder-sheet', hidden: true },
      table('Models, from the simplest up', head, this.#body, 'rungs'),
      this.#links,
    );
    root.append(
      this.#told,
      h(
        'form',
        {
          class: 'ladder-form',
          novalidate: true,
          submit: (/** @type {Event} */ event) => {
            event.preventDefault();
            void this.#refresh();
          },
        },
        h('p', {}, h('label', { for: 'ladder-impacts' }, 'Bounces'), this.#impacts),
        h(
          'p',
          {},
          h('label', { for: 'ladder-tolerance' }, 'Difference that matters'),
          this.#tolerance,
          h('span', { class: 'unit' }, 'm/s'),
        ),
        this.#error,
      ),
      this.#sheet,
    );
    new IntersectionObserver(
      (entries) => {
        this.#near = entries.some(({ isIntersecting }) => isIntersecting);
        if (this.#near) void this.#refresh();
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  #changed() {
    this.#page.changed();
    void this.#refresh();
  }

  /** The panel's part of the address. */
  query() {
    const typed = { impacts: this.#impacts.value.trim(), tolerance: this.#tolerance.value.trim() };
    return new URLSearchParams(
      /** @type {const} */ (['impacts', 'tolerance'])
        .filter((name) => typed[name] !== USUAL[name])
        .map((name) => [`ladder.${name}`, typed[name]]),
    );
  }

  /** Marks what is wrong beside it. @param {URLSearchParams} link */
  restore(link) {
    this.#impacts.value = link.get('ladder.impacts') ?? USUAL.impacts;
    this.#tolerance.value = link.get('ladder.tolerance') ?? USUAL.tolerance;
    if (this.#near) void this.#refresh();
    else this.#request();
    return [];
  }

  /** The scene of the page is another one. */
  sceneChanged = debounce(300, () => {
    if (this.#near) void this.#refresh();
  });

  /** The request; null where something typed is wrong, which is marked. */
  #request() {
    const impacts = parse(this.#impacts.value, '1');
    const tolerance = parse(this.#tolerance.value, 'm/s');
    const [counted, measured] = [
      impacts !== null && Number.isInteger(impacts) && impacts >= 1 && impacts <= MOST_IMPACTS,
      tolerance !== null && tolerance > 0 && tolerance <= MOST_DIFFERENCE,
    ];
    this.#error.textContent = !counted
      ? `Bounces must be a whole number from 1 to ${number(MOST_IMPACTS, 6)}.`
      : !measured
        ? `The difference must be a number above 0 and up to ${MOST_DIFFERENCE} m/s.`
        : '';
    this.#impacts.setAttribute('aria-invalid', String(!counted));
    this.#tolerance.setAttribute('aria-invalid', String(!measured));
    if (!counted || !measured) return null;
    const request = this.#page.query();
    request?.set('bounces', String(impacts));
    request?.set('tolerance', String(tolerance));
    return request;
  }

  retell() {
    if (this.#shown === '') return;
    this.#shown = '';
    void this.#refresh();
  }

  async #refresh() {
    const request = this.#request();
    if (!request) return;
    const path = `v1/ladder?${request}`;
    if (path === this.#shown) return;
    this.#shown = path;
    const signal = this.#latest.next();
    try {
      this.#show(await get(path, signal), path);
    } catch (error) {
      if (signal.aborted) return;
      this.#sheet.hidden = true;
      this.#told.replaceChildren(
        ...marked(wordsOf(error)),
        ' ',
        retryButton(() => {
          this.#shown = '';
          void this.#refresh();
        }),
      );
    }
  }

  /** @param {import('contract').Ladder} answer @param {string} path */
  #show({ rungs, enough, reason }, path) {
    this.#sheet.hidden = false;
    this.#told.replaceChildren(
      h('strong', {}, `Enough for this scene: ${words(enough)}. `),
      ...prose(reason[0].toUpperCase() + reason.slice(1)),
      '.',
    );
    this.#body.replaceChildren(
      ...rungs.map((rung) => {
        const { name, forced, outcome, change, needed, cost_ns_per_bounce: cost } = rung;
        const state = change?.state;
        return h(
          'tr',
          { class: name === enough ? 'enough' : '' },
          h(
            'th',
            { scope: 'row' },
            words(name),
            name === enough && ' ',
            name === enough && h('span', { class: 'chip' }, 'enough'),
          ),
          h(
            'td',
            {},
            ...(forced
              ? [this.#title(forced.field), h('span', { class: 'muted' }, ...prose(forced.detail.replace(/\s+/g, ' ')))]
              : ['–']),
          ),
          h('td', {}, number(cost)),
          h('td', {}, outcome ? `${words(outcome.kind)}, ${number(outcome.bounces)}` : '–'),
          h(
            'td',
            {},
            ...(change
              ? this.#change(change)
              : [rung.reason ? h('span', { class: 'muted' }, ...prose(rung.reason)) : '–']),
          ),
          h(
            'td',
            {},
            state?.difference == null
              ? '–'
              : `${quantity(state.difference, 'm/s', 3)}${state.impact === null ? '' : ` at ${number(state.impact)}`}`,
          ),
          h('td', {}, needed === null ? '–' : needed ? 'needed' : 'not needed'),
        );
      }),
    );
    this.#links.replaceChildren(
      ...actions({ id: 'ladder', title: 'Which model does it need', path, formats: ['csv', 'arrow', 'json'] }),
    );
  }

  /** The title of a field, in place of its path. @param {string} path */
  #title(path) {
    return this.#page.fields.find((field) => field.field === path)?.title ?? inWords(path);
  }

  /** @param {NonNullable<Rung['change']>} change */
  #change(change) {
    const most = CHANGES.map(([name, unit]) => ({ name, unit, value: change[name].difference })).filter(
      ({ value }) => value !== null && value > 0,
    );
    const ends = change.same_outcome ? '' : 'ends otherwise';
    if (most.length === 0) return [ends || 'the same in every number'];
    return [
      ends,
      h(
        'span',
        { class: 'muted' },
        most.map(({ name, unit, value }) => `Δ${SYMBOLS[name]} ${quantity(value, unit, 2)}`).join(', '),
      ),
    ];
  }
}
