// The paper item by item: what is printed, what is computed, why they differ, and a way to run it.

import { get, wordsOf } from '../../api/client.js';
import { h, retryButton } from '../../dom/elements.js';
import { UNITS } from '../../dom/units.js';
import { ItemView } from './item.js';

/** @typedef {import('contract').PaperItem} PaperItem */

const KINDS = { equation: 'Equations', table: 'Tables', figure: 'Figures', claim: 'Claims' };
/** The filters: all items, those that differ, or one kind. @type {Record<string, (item: PaperItem) => boolean>} */
const FILTERS = {
  all: () => true,
  differs: ({ agrees }) => !agrees,
  ...Object.fromEntries(
    Object.keys(KINDS).map((kind) => [kind, (/** @type {PaperItem} */ item) => item.kind === kind]),
  ),
};
const NAMES = { all: 'All', differs: 'Differs', ...KINDS };

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page, link) => new Reading(root, page, link);

class Reading {
  #root;
  #page;
  #told = h('p', { class: 'muted', role: 'status' });
  #list = h('ol', { class: 'reading-items' });
  /** @type {Map<string, ItemView>} */
  #views = new Map();
  #filter = 'all';
  /** The item that the address names. */
  #opened = '';

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   * @param {URLSearchParams} link
   */
  constructor(root, page, link) {
    this.#root = root;
    this.#page = page;
    this.restore(link);
    void this.#load();
    document.addEventListener(UNITS, () => {
      for (const view of this.#views.values()) view.redraw();
    });
  }

  /** The panel's part of the address. */
  query() {
    return new URLSearchParams(this.#opened ? { 'reading.item': this.#opened } : {});
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    this.#opened = link.get('reading.item') ?? '';
    if (this.#views.size === 0) return [];
    const view = this.#views.get(this.#opened);
    if (this.#opened && !view) return [this.#unknown()];
    if (view) this.#show(view);
    return [];
  }

  /** Names the item that the paper does not have, and forgets it. */
  #unknown() {
    const name = this.#opened.slice(0, 40);
    this.#opened = '';
    return `reading.item “${name}”, which is no item of the paper`;
  }

  async #load() {
    this.#told.textContent = 'Every item is being computed…';
    this.#root.replaceChildren(this.#told);
    try {
      const { items } = await get('v1/paper');
      for (const item of items) {
        this.#views.set(item.id, new ItemView(item, this.#page, (open) => this.#turned(item.id, open)));
      }
      this.#root.replaceChildren(this.#filters(items), this.#told, this.#list);
      this.#list.append(...[...this.#views.values()].map(({ element }) => element));
      this.#choose('all', items);
      const view = this.#views.get(this.#opened);
      if (view) this.#show(view);
      else if (this.#opened) this.#told.textContent = `The link named ${this.#unknown()}.`;
    } catch (error) {
      this.#told.textContent = wordsOf(error);
      this.#root.append(retryButton(() => void this.#load()));
    }
  }

  /** @param {PaperItem[]} items */
  #filters(items) {
    const choices = Object.entries(NAMES).map(([value, name]) => {
      const input = h('input', {
        type: 'radio',
        name: 'reading-filter',
        value,
        change: () => this.#choose(value, items),
      });
      input.checked = value === this.#filter;
      return h('label', { class: 'check' }, input, `${name} (${items.filter(FILTERS[value]).length})`);
    });
    return h('fieldset', { class: 'reading-filters' }, h('legend', { class: 'unseen' }, 'Items to show'), ...choices);
  }

  /** @param {string} filter @param {PaperItem[]} items */
  #choose(filter, items) {
    this.#filter = filter;
    const shown = items.filter(FILTERS[filter]);
    for (const item of items) {
      const view = this.#views.get(item.id);
      if (view) view.element.hidden = !FILTERS[filter](item);
    }
    const differing = shown.filter(({ agrees }) => !agrees).length;
    this.#told.textContent = `${shown.length} items; ${differing} differ from the paper, each with the reason.`;
  }

  /** @param {string} id @param {boolean} open */
  #turned(id, open) {
    const named = open ? id : this.#opened === id ? '' : this.#opened;
    if (named === this.#opened) return;
    this.#opened = named;
    this.#page.changed();
  }

  /** @param {ItemView} view */
  #show(view) {
    view.element.hidden = false;
    view.open();
    view.element.scrollIntoView({ block: 'nearest' });
  }
}
