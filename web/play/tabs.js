// Tabs: one panel shown at a time, arrow keys between them, the chosen one in the address.

import { h } from '../dom/elements.js';

/** A quiet tab shows its button only while it is chosen: something else opens it. @typedef {{id: string, name: string, quiet?: boolean}} Tab */

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class Tabs {
  #list;
  #tabs;
  /** @type {Map<string, {button: HTMLButtonElement, panel: HTMLElement}>} */
  #parts = new Map();
  #chosen = '';
  /** The choice differs from what a link without one shows. */
  #named = false;
  #opened;

  /**
   * @param {HTMLElement} list
   * @param {HTMLElement} panels where those stand that are not in the page yet
   * @param {readonly Tab[]} tabs
   * @param {(id: string, byHand: boolean) => void} opened
   */
  constructor(list, panels, tabs, opened) {
    this.#list = list;
    this.#tabs = tabs;
    this.#opened = opened;
    for (const { id, name } of tabs) {
      const button = h(
        'button',
        {
          type: 'button',
          role: 'tab',
          id: `tab-${id}`,
          'aria-controls': `panel-${id}`,
          click: () => this.choose(id, true),
        },
        name,
      );
      const panel =
        document.getElementById(`panel-${id}`) ??
        panels.appendChild(
          h('div', {
            id: `panel-${id}`,
            class: 'tab-panel',
            role: 'tabpanel',
            'aria-labelledby': `tab-${id}`,
            tabindex: 0,
            hidden: true,
          }),
        );
      list.append(button);
      this.#parts.set(id, { button, panel });
    }
    list.addEventListener('keydown', (event) => this.#key(event));
    this.#show(tabs[0].id);
  }

  get chosen() {
    return this.#chosen;
  }

  /** @param {string} id */
  panel(id) {
    const part = this.#parts.get(id);
    if (!part) throw new Error(`there is no tab ${id}`);
    return part.panel;
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const ids = this.#tabs.filter(({ id }) => !this.#parts.get(id)?.button.hidden).map(({ id }) => id);
    const at = ids.indexOf(this.#chosen);
    /** @type {Record<string, number>} */
    const places = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: ids.length - 1 };
    if (!(event.key in places) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.choose(/** @type {string} */ (ids.at(places[event.key] % ids.length)), true);
    this.#parts.get(this.#chosen)?.button.focus();
  }

  /** Opens a tab. @param {string} id @param {boolean} [byHand] not by a link */
  choose(id, byHand = false) {
    this.#named = byHand || id !== this.#tabs[0].id;
    if (id !== this.#chosen) this.#show(id);
    this.#opened(id, byHand);
    // On a phone the tabs may be below the screen.
    if (byHand && this.#list.getBoundingClientRect().top > innerHeight / 2)
      this.#list.parentElement?.scrollIntoView({ behavior: stillness.matches ? 'auto' : 'smooth' });
  }

  /** @param {string} chosen */
  #show(chosen) {
    this.#chosen = chosen;
    for (const [id, { button, panel }] of this.#parts) {
      button.hidden = id !== chosen && this.#tabs.some((tab) => tab.id === id && tab.quiet);
      button.setAttribute('aria-selected', String(id === chosen));
      button.tabIndex = id === chosen ? 0 : -1;
      panel.hidden = id !== chosen;
      if (id === chosen && this.#named) button.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    }
  }

  /** The chosen tab for the address. */
  query() {
    return new URLSearchParams(this.#chosen === this.#tabs[0].id ? [] : [['tab', this.#chosen]]);
  }
}
