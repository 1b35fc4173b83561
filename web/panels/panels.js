// The tabs beside the scene, and the panels in them: a panel's code is loaded when its tab is opened for the first time, and only the open tab is
// drawn. The address has the chosen tab and the parts of all panels.

import { dropWith } from '../app/late/settings.js';
import { launch, play } from '../app/scenes.js';
import { byId } from '../dom/elements.js';
import { html, render } from '../vendor/preact/preact.js';
import { card, entriesOf } from './card.js';
import { Parts } from './settings.js';

/**
 * The tabs in their order; the first is open unless the address says another. A quiet one shows its button only while it is chosen: something else
 * opens it.
 * @type {readonly {id: string, name: string, quiet?: boolean}[]}
 */
const TABS = [
  { id: 'map', name: 'Map' },
  { id: 'values', name: 'Values' },
  { id: 'why', name: 'Why', quiet: true },
  { id: 'more', name: 'More' },
];
const USUAL = TABS[0].id;

/** Tabs of older links, and where their panels stand now. @type {Readonly<Record<string, string>>} */
const FORMER = { run: 'why', orbits: 'more', catch: 'more' };

const PANELS = entriesOf('./');
const stillness = matchMedia('(prefers-reduced-motion: reduce)');

/** The panel that a part of the address belongs to. @param {string} key */
const ownerOf = (key) => key.split('.')[0];

/** @param {Page} page @returns {Panels} */
export function bringPanels(page) {
  const list = byId('tabs');
  const cards = PANELS.map((entry) => ({ ...entry, ...card(entry) }));
  for (const { tab, element } of cards) byId(`panel-${tab}`).append(element);
  /** @type {Map<string, Neighbour>} */
  const neighbours = new Map();
  const parts = new Parts();
  let chosen = USUAL;

  const drawTabs = () => {
    for (const { id } of TABS) byId(`panel-${id}`).hidden = id !== chosen;
    const button = (/** @type {typeof TABS[number]} */ { id, name, quiet }) => html`<button
      type="button"
      role="tab"
      id=${`tab-${id}`}
      aria-controls=${`panel-${id}`}
      aria-selected=${String(id === chosen)}
      tabindex=${id === chosen ? 0 : -1}
      hidden=${quiet && id !== chosen}
      onClick=${() => choose(id, true)}
    >${name}</button>`;
    render(TABS.map(button), list);
  };

  /** Draws the panels of the open tab. */
  const draw = () => {
    const { link, part, drop } = parts;
    /** @type {PanelPage} */
    const own = {
      fields: page.fields,
      query: page.typedQuery,
      scene: page.typed ?? {},
      link,
      part,
      drop,
      take: (scene) => play(page, scene),
      open: (id, other) => {
        parts.link = new URLSearchParams([...[...parts.link].filter(([key]) => ownerOf(key) !== id), ...other]);
        show(id);
      },
      launch: (values) => launch(page, values),
      dropWith: (values, first) => dropWith(page, values, first),
      play: page,
    };
    for (const { tab, draw: drawCard } of cards) if (tab === chosen) drawCard(own);
  };

  /** Opens a tab. @param {string} id @param {boolean} [byHand] not by a link */
  const choose = (id, byHand = false) => {
    chosen = id;
    drawTabs();
    if (byHand || id !== USUAL) byId(`tab-${id}`).scrollIntoView({ block: 'nearest', inline: 'nearest' });
    draw();
    if (!byHand) return;
    page.updateAddressSoon();
    // On a phone the tabs may be below the screen.
    if (list.getBoundingClientRect().top > innerHeight / 2)
      list.parentElement?.scrollIntoView({ behavior: stillness.matches ? 'auto' : 'smooth' });
  };

  /** Opens a tab, or that of a panel. @param {string} id */
  const show = (id) => choose(PANELS.find((entry) => entry.id === id)?.tab ?? id, true);

  parts.changed = () => {
    draw();
    page.updateAddressSoon();
  };
  list.addEventListener('keydown', (event) => {
    const ids = TABS.filter(({ id, quiet }) => !quiet || id === chosen).map(({ id }) => id);
    const at = ids.indexOf(chosen);
    /** @type {Record<string, number>} */
    const places = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: ids.length - 1 };
    if (!(event.key in places) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    choose(/** @type {string} */ (ids.at(places[event.key] % ids.length)), true);
    byId(`tab-${chosen}`).focus();
  });
  drawTabs();

  return {
    draw,
    show,
    join: (id, neighbour) => neighbours.set(id, neighbour),
    restore: (link) => {
      parts.link = new URLSearchParams([...link].filter(([key]) => key !== 'tab' && !neighbours.has(ownerOf(key))));
      for (const { id } of PANELS) parts.dropped(id, []);
      for (const [id, neighbour] of neighbours) parts.dropped(id, neighbour.restore?.(link) ?? []);
      const told = link.get('tab');
      const named = told === null ? null : (FORMER[told] ?? told);
      const asked = [...link.keys()].map((key) => PANELS.find(({ id }) => id === ownerOf(key))).find(Boolean);
      const tab = named ?? asked?.tab ?? USUAL;
      const known = TABS.some(({ id }) => id === tab);
      parts.dropped('tab', known ? [] : [`the tab “${tab.slice(0, 40)}”, which is not known here`]);
      choose(known ? tab : USUAL);
    },
    query: () => {
      const others = [...neighbours.values()].flatMap((one) => [...(one.query?.() ?? [])]);
      return new URLSearchParams([...(chosen === USUAL ? [] : [['tab', chosen]]), ...parts.link, ...others]);
    },
    sceneChanged: () => {
      for (const neighbour of neighbours.values()) neighbour.sceneChanged?.();
      draw();
    },
  };
}
