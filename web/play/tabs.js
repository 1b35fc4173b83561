// Tabs: one panel shown at a time, arrow keys between them, the chosen one in the address.

import { byId } from '../dom/elements.js';
import { html, render } from '../vendor/preact/preact.js';

/** A quiet tab shows its button only while it is chosen: something else opens it. @typedef {{id: string, name: string, quiet?: boolean}} Tab */

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class Tabs {
  chosen = '';
  #list;
  #tabs;
  #opened;

  /** @param {HTMLElement} list @param {readonly Tab[]} tabs each with its panel in the page @param {(id: string, byHand: boolean) => void} opened */
  constructor(list, tabs, opened) {
    this.#list = list;
    this.#tabs = tabs;
    this.#opened = opened;
    list.addEventListener('keydown', (event) => this.#key(event));
    this.#show(tabs[0].id);
  }

  /** The button of the chosen tab. */
  get #button() {
    return document.getElementById(`tab-${this.chosen}`);
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const ids = this.#tabs.filter(({ id, quiet }) => !quiet || id === this.chosen).map(({ id }) => id);
    const at = ids.indexOf(this.chosen);
    /** @type {Record<string, number>} */
    const places = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: ids.length - 1 };
    if (!(event.key in places) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.choose(/** @type {string} */ (ids.at(places[event.key] % ids.length)), true);
    this.#button?.focus();
  }

  /** Opens a tab. @param {string} id @param {boolean} [byHand] not by a link */
  choose(id, byHand = false) {
    if (id !== this.chosen) this.#show(id);
    if (byHand || id !== this.#tabs[0].id) this.#button?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    this.#opened(id, byHand);
    // On a phone the tabs may be below the screen.
    if (byHand && this.#list.getBoundingClientRect().top > innerHeight / 2)
      this.#list.parentElement?.scrollIntoView({ behavior: stillness.matches ? 'auto' : 'smooth' });
  }

  /** @param {string} chosen */
  #show(chosen) {
    this.chosen = chosen;
    for (const { id } of this.#tabs) byId(`panel-${id}`).hidden = id !== chosen;
    const button = (/** @type {Tab} */ { id, name, quiet }) => html`<button
      type="button"
      role="tab"
      id=${`tab-${id}`}
      aria-controls=${`panel-${id}`}
      aria-selected=${String(id === chosen)}
      tabindex=${id === chosen ? 0 : -1}
      hidden=${quiet && id !== chosen}
      onClick=${() => this.choose(id, true)}
    >${name}</button>`;
    render(this.#tabs.map(button), this.#list);
  }

  /** The chosen tab for the address. */
  query() {
    return new URLSearchParams(this.chosen === this.#tabs[0].id ? [] : [['tab', this.chosen]]);
  }
}
