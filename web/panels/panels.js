// What stands in tabs beside the scene: a tab's code is loaded when it is opened for the first time.

import { Tabs } from '../play/tabs.js';
import { card } from './card.js';
import { FORMER, PANELS, TABS } from './registry.js';

/** @typedef {import('./card.js').PanelPage} PanelPage */
/** @typedef {import('./card.js').Panel} Panel */
/** @typedef {import('./card.js').Judged} Judged */

export class Panels {
  /** @type {Map<string, Panel>} */
  #mounted = new Map();
  /** Panels in closed tabs that have not heard of a change. @type {Set<string>} */
  #missed = new Set();
  /** Loads the panels of a tab, until it was opened. @type {Map<string, (() => Promise<void>)[]>} */
  #waiting = new Map();
  #link = new URLSearchParams();
  /** @type {Judged | null} */
  #judged = null;
  #dropped;
  #tabs;

  /**
   * @param {HTMLElement} list of the tabs
   * @param {HTMLElement} panels
   * @param {PanelPage} page
   * @param {(id: string, what: string[]) => void} dropped parts of a link that a panel could not keep
   */
  constructor(list, panels, page, dropped) {
    this.#dropped = dropped;
    this.#tabs = new Tabs(list, panels, TABS, (id, byHand) => {
      this.#open(id);
      if (byHand) page.changed();
    });
    for (const entry of PANELS) {
      const { element, bring } = card(
        entry,
        page,
        () => this.#link,
        (panel) => {
          this.#mounted.set(entry.id, panel);
          this.#restore(entry.id, panel);
          if (this.#judged) panel.judged?.(this.#judged);
        },
      );
      this.#tabs.panel(entry.tab).append(element);
      this.#waiting.set(entry.tab, [...(this.#waiting.get(entry.tab) ?? []), bring]);
    }
  }

  /** @param {string} tab */
  #open(tab) {
    for (const bring of this.#waiting.get(tab) ?? []) void bring();
    this.#waiting.delete(tab);
    for (const { id } of PANELS.filter((entry) => entry.tab === tab && this.#missed.delete(entry.id))) {
      const panel = this.#mounted.get(id);
      panel?.sceneChanged?.();
      if (this.#judged) panel?.judged?.(this.#judged);
    }
  }

  /** Opens the tab with this panel. @param {string} id */
  show(id) {
    this.#tabs.choose(PANELS.find((entry) => entry.id === id)?.tab ?? id, true);
  }

  /** Opens a panel as a link with this part would show it. @param {string} id @param {URLSearchParams} part */
  open(id, part) {
    const link = new URLSearchParams([...this.#link].filter(([key]) => !key.startsWith(`${id}.`)));
    for (const [key, value] of part) link.append(key, value);
    this.#link = link;
    const panel = this.#mounted.get(id);
    if (panel) this.#restore(id, panel);
    this.show(id);
  }

  /** One that has its place already takes its part of the address as well. @param {string} id @param {Panel} panel */
  join(id, panel) {
    this.#mounted.set(id, panel);
  }

  /** @param {string} id @param {Panel} panel */
  #restore(id, panel) {
    this.#dropped(id, panel.restore?.(this.#link) ?? []);
  }

  /** Shows what a link asks for: its tab, else that of the first panel with a part in it. @param {URLSearchParams} link */
  restore(link) {
    this.#link = link;
    for (const [id, panel] of this.#mounted) this.#restore(id, panel);
    const told = link.get('tab');
    const named = told === null ? null : (FORMER[told] ?? told);
    const asked = [...link.keys()].map((key) => PANELS.find(({ id }) => id === key.split('.')[0])).find(Boolean);
    const tab = named ?? asked?.tab ?? TABS[0].id;
    const known = TABS.some(({ id }) => id === tab);
    this.#dropped('tab', known ? [] : [`the tab “${tab.slice(0, 40)}”, which is not known here`]);
    this.#tabs.choose(known ? tab : TABS[0].id);
  }

  /** Their parts of the page’s address: of those that are not there yet as the link had it. */
  query() {
    const query = this.#tabs.query();
    for (const [key, value] of this.#link)
      if (key !== 'tab' && !this.#mounted.get(key.split('.')[0])?.query) query.append(key, value);
    for (const panel of this.#mounted.values())
      for (const [key, value] of panel.query?.() ?? []) query.append(key, value);
    return query;
  }

  /** The panels that somebody sees; the others are told when their tab is opened. */
  *#seen() {
    for (const [id, panel] of this.#mounted) {
      const tab = PANELS.find((entry) => entry.id === id)?.tab;
      if (tab === undefined || tab === this.#tabs.chosen) yield panel;
      else this.#missed.add(id);
    }
  }

  /** Shows the same in another unit of angles. */
  retell() {
    for (const panel of this.#mounted.values()) panel.retell?.();
  }

  sceneChanged() {
    for (const panel of this.#seen()) panel.sceneChanged?.();
  }

  /** @param {Judged} judged */
  judged(judged) {
    this.#judged = judged;
    for (const panel of this.#seen()) panel.judged?.(judged);
  }
}
