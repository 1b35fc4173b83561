// The tabs beside the scene, and the panels in them: a panel's code is loaded when its tab is opened for the first time, and only the open tab is
// drawn.

import { byId } from '../dom/elements.js';
import { Tabs } from '../play/tabs.js';
import { card, entriesOf } from './card.js';
import { Parts } from './settings.js';

/** The tabs in their order; the first is open unless the address says another. @type {readonly import('../play/tabs.js').Tab[]} */
const TABS = [
  { id: 'map', name: 'Map' },
  { id: 'values', name: 'Values' },
  { id: 'why', name: 'Why', quiet: true },
  { id: 'more', name: 'More' },
];

/** Tabs of older links, and where their panels stand now. @type {Readonly<Record<string, string>>} */
const FORMER = { run: 'why', orbits: 'more', catch: 'more' };

const PANELS = entriesOf('./');

/** The panel that a part of the address belongs to. @param {string} key */
const ownerOf = (key) => key.split('.')[0];

export class Panels {
  #cards = PANELS.map((entry) => ({ ...entry, ...card(entry) }));
  /** @type {Map<string, Neighbour>} */
  #neighbours = new Map();
  #parts = new Parts();
  #page;
  #tabs;

  /**
   * @param {HTMLElement} list of the tabs
   * @param {() => Pick<PanelPage, 'fields' | 'query' | 'scene' | 'take' | 'launch' | 'dropWith' | 'play'>} page
   * @param {() => void} changed the address is another one
   * @param {(id: string, what: string[]) => void} dropped parts of a link that a panel could not keep
   */
  constructor(list, page, changed, dropped) {
    this.#page = page;
    this.#parts.dropped = dropped;
    this.#parts.changed = () => {
      this.draw();
      changed();
    };
    this.#tabs = new Tabs(list, TABS, (_, byHand) => {
      this.draw();
      if (byHand) changed();
    });
    for (const { tab, element } of this.#cards) byId(`panel-${tab}`).append(element);
  }

  /** Draws the panels of the open tab. */
  draw() {
    const { link, part, drop } = this.#parts;
    const page = {
      ...this.#page(),
      link,
      part,
      drop,
      open: (/** @type {string} */ id, /** @type {URLSearchParams} */ own) => this.open(id, own),
    };
    for (const { tab, draw } of this.#cards) if (tab === this.#tabs.chosen) draw(page);
  }

  /** Opens the tab with this panel. @param {string} id */
  show(id) {
    this.#tabs.choose(PANELS.find((entry) => entry.id === id)?.tab ?? id, true);
  }

  /** Opens a panel as a link with this part would show it. @param {string} id @param {URLSearchParams} part */
  open(id, part) {
    this.#parts.link = new URLSearchParams([...[...this.#parts.link].filter(([key]) => ownerOf(key) !== id), ...part]);
    this.show(id);
  }

  /** @param {string} id @param {Neighbour} neighbour */
  join(id, neighbour) {
    this.#neighbours.set(id, neighbour);
  }

  /** Shows what a link asks for: its tab, else that of the first panel with a part in it. @param {URLSearchParams} link */
  restore(link) {
    this.#parts.link = new URLSearchParams(
      [...link].filter(([key]) => key !== 'tab' && !this.#neighbours.has(ownerOf(key))),
    );
    for (const { id } of PANELS) this.#parts.dropped(id, []);
    for (const [id, neighbour] of this.#neighbours) this.#parts.dropped(id, neighbour.restore?.(link) ?? []);
    const told = link.get('tab');
    const named = told === null ? null : (FORMER[told] ?? told);
    const asked = [...link.keys()].map((key) => PANELS.find(({ id }) => id === ownerOf(key))).find(Boolean);
    const tab = named ?? asked?.tab ?? TABS[0].id;
    const known = TABS.some(({ id }) => id === tab);
    this.#parts.dropped('tab', known ? [] : [`the tab “${tab.slice(0, 40)}”, which is not known here`]);
    this.#tabs.choose(known ? tab : TABS[0].id);
  }

  /** The panels' part of the page’s address. */
  query() {
    const parts = [...this.#neighbours.values()].flatMap((one) => [...(one.query?.() ?? [])]);
    return new URLSearchParams([...this.#tabs.query(), ...this.#parts.link, ...parts]);
  }

  sceneChanged() {
    for (const neighbour of this.#neighbours.values()) neighbour.sceneChanged?.();
    this.draw();
  }
}
