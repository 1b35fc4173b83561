// The reach map: which releases, over angle and spin, a table catches.

import { serverFigure } from '../../charts/readable/server-figure.js';
import { get, wordsOf } from '../../api/client.js';
import { LatestRequest } from '../../api/latest-request.js';
import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { marked } from '../../dom/typeset.js';
import { actions } from '../../export/save-actions.js';
import { isCaught } from './answer.js';

/** The two fields of the map, with their ends and their cells. */
const SIDES = {
  x: { field: 'release.theta', from: -1, to: 1, count: 61 },
  y: { field: 'release.theta_dot', from: -8, to: 8, count: 41 },
};

export class ReachMap {
  element;
  #query;
  #open;
  #latest = new LatestRequest();
  #told = h('p', { id: 'catch-reach-told', role: 'status' });
  #sheet = h('div', { id: 'catch-reach-sheet' });
  #bar = h('progress', { hidden: true, 'aria-label': 'Catching from each release' });
  #start = h('button', { type: 'button', id: 'catch-reach', click: () => void this.#ask() }, 'Map its reach');
  #cancel = h(
    'button',
    { type: 'button', id: 'catch-reach-cancel', disabled: true, click: () => this.#stop('Cancelled.') },
    'Cancel',
  );

  /**
   * @param {() => URLSearchParams | null} query of the scene with the settings of the catch as `catch.…`; null while something is wrong
   * @param {((id: string, link: URLSearchParams) => void) | undefined} open another panel with its part of the address
   */
  constructor(query, open) {
    this.#query = query;
    this.#open = open;
    this.element = h(
      'section',
      { class: 'catch-reach', 'aria-labelledby': 'catch-reach-title' },
      h('h3', { id: 'catch-reach-title' }, 'Reach'),
      h('p', { class: 'buttons' }, this.#start, this.#cancel, this.#bar),
      this.#told,
      this.#sheet,
    );
    this.#told.textContent = 'Which releases the table catches, over angle and spin: a catch in every cell.';
  }

  /** The map is of another scene or other settings. */
  stale() {
    this.#stop('');
    if (!this.#sheet.firstChild) return;
    this.#sheet.classList.add('stale');
    this.#told.textContent = 'The scene or the settings have changed since; map the reach anew.';
  }

  /** @param {string} words */
  #stop(words) {
    this.#latest.cancel();
    this.#busy(false);
    if (words) this.#told.textContent = words;
  }

  /** @param {boolean} busy */
  #busy(busy) {
    const [on, off] = busy ? [this.#cancel, this.#start] : [this.#start, this.#cancel];
    on.disabled = false;
    // Whoever pressed it should not find the focus gone.
    if (off === document.activeElement) on.focus();
    off.disabled = true;
    this.#bar.hidden = !busy;
  }

  async #ask() {
    const query = this.#query();
    if (!query) return;
    for (const [name, side] of Object.entries(SIDES)) {
      query.delete(`scene.${side.field}`);
      for (const [key, value] of Object.entries(side)) query.set(`${name}.${key}`, String(value));
    }
    query.set('quantity', 'caught');
    // Each cell by one strategy: to compare them all in each takes too long.
    if (!query.has('catch.strategy')) query.set('catch.strategy', 'bounce_down');
    const path = `v1/regions?${query}`;
    const signal = this.#latest.next();
    this.#busy(true);
    this.#told.textContent = 'Catching from each release…';
    try {
      const figure = await serverFigure(`${path}&format=svg`, signal);
      // It is kept for the picture, so the numbers cost nothing more.
      const answer = await get(path, signal);
      if (signal.aborted) return;
      this.#show(answer, figure, path);
      this.#busy(false);
    } catch (error) {
      if (signal.aborted) return;
      this.#busy(false);
      this.#told.replaceChildren(...marked(wordsOf(error)));
    }
  }

  /** @param {import('contract').Region} answer @param {SVGSVGElement} figure @param {string} path */
  #show({ counts }, figure, path) {
    const cells = SIDES.x.count * SIDES.y.count;
    const caught = Object.entries(counts).reduce((sum, [kind, count]) => sum + (isCaught({ kind }) ? count : 0), 0);
    const words = `Caught from ${number((100 * caught) / cells, 3)}\u202f% of the releases with ${quantity(SIDES.x.from, 'rad')} to ${quantity(SIDES.x.to, 'rad')} and ${quantity(SIDES.y.from, 'rad/s')} to ${quantity(SIDES.y.to, 'rad/s')}.`;
    this.#told.textContent = words;
    this.#sheet.classList.remove('stale');
    this.#sheet.replaceChildren(
      h('div', { class: 'figure-box', role: 'img', 'aria-label': words, tabindex: 0 }, figure),
      h(
        'p',
        { class: 'actions', id: 'catch-reach-links' },
        ...actions({
          id: 'catch-reach',
          title: 'Reach of the catch',
          path,
          formats: ['svg', 'png', 'csv', 'arrow', 'json'],
        }).slice(0, -1),
        this.#open &&
          h('button', { type: 'button', id: 'catch-map', click: () => this.#closer(path) }, 'Look closer in the map'),
      ),
    );
  }

  /** Opens the map tab with the same fields and settings. @param {string} path of the shown map */
  #closer(path) {
    const link = new URLSearchParams([['map.quantity', 'caught']]);
    for (const [name, { field, from, to }] of Object.entries(SIDES))
      for (const [key, value] of Object.entries({ parameter: field, from, to }))
        link.set(`map.${name}.${key}`, String(value));
    for (const [key, value] of new URLSearchParams(path.split('?')[1]))
      if (key.startsWith('catch.')) link.set(`map.${key}`, value);
    this.#open?.('map', link);
  }
}
