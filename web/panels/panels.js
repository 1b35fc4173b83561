// All panels below the fold, each loaded when it comes near.

import { h } from '../dom/elements.js';
import { card } from './card.js';
import { PANELS } from './registry.js';

/** @typedef {import('./card.js').PanelPage} PanelPage */
/** @typedef {import('./card.js').Panel} Panel */
/** @typedef {import('./card.js').Judged} Judged */

/** All of them, each brought when it comes near. */
export class Panels {
  /** @type {Map<string, Panel>} */
  #mounted = new Map();
  #link = new URLSearchParams();
  /** @type {Judged | null} */
  #judged = null;
  #dropped;

  /**
   * @param {HTMLElement} main
   * @param {PanelPage} page
   * @param {(id: string, what: string[]) => void} dropped parts of a link that a panel could not keep
   */
  constructor(main, page, dropped) {
    this.#dropped = dropped;
    /** @type {HTMLElement | null} */
    let row = null;
    for (const entry of PANELS) {
      const { element, body, bring } = card(
        entry,
        page,
        () => this.#link,
        (panel) => {
          this.#mounted.set(entry.id, panel);
          this.#restore(entry.id, panel);
          if (this.#judged) panel.judged?.(this.#judged);
        },
      );
      if (entry.half) {
        row ??= main.appendChild(h('div', { class: 'notes' }));
        row.append(element);
      } else main.append(element);
      new IntersectionObserver(
        (entries, observer) => {
          if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
          observer.disconnect();
          void bring();
        },
        { rootMargin: '100px 0px' },
      ).observe(body);
    }
  }

  /** One that has its place already takes its part of the address as well. @param {string} id @param {Panel} panel */
  join(id, panel) {
    this.#mounted.set(id, panel);
  }

  /** @param {string} id @param {Panel} panel */
  #restore(id, panel) {
    this.#dropped(id, panel.restore?.(this.#link) ?? []);
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    this.#link = link;
    for (const [id, panel] of this.#mounted) this.#restore(id, panel);
  }

  /** Their parts of the page’s address: of those that are not there yet as the link had it. */
  query() {
    const query = new URLSearchParams();
    for (const [key, value] of this.#link) if (!this.#mounted.get(key.split('.')[0])?.query) query.append(key, value);
    for (const panel of this.#mounted.values())
      for (const [key, value] of panel.query?.() ?? []) query.append(key, value);
    return query;
  }

  played() {
    for (const panel of this.#mounted.values()) panel.played?.();
  }

  sceneChanged() {
    for (const panel of this.#mounted.values()) panel.sceneChanged?.();
  }

  /** @param {Judged} judged */
  judged(judged) {
    this.#judged = judged;
    for (const panel of this.#mounted.values()) panel.judged?.(judged);
  }
}
