// The tabs beside the scene, and the panels in each with a sentence on them and where their code is.

/** The colours and sizes of the server's pictures in the page, and the form of a study. */
const FIGURE_STYLES = ['charts/generated/figure-colours.css', 'charts/readable/server-figure.css', 'panels/study.css'];

/** The tabs in their order; the first is open unless the address says another. @type {readonly import('../play/tabs.js').Tab[]} */
export const TABS = [
  { id: 'map', name: 'Map' },
  { id: 'values', name: 'Values' },
  { id: 'why', name: 'Why', quiet: true },
  { id: 'more', name: 'More' },
];

/** Tabs of older links, and where their panels stand now. @type {Readonly<Record<string, string>>} */
export const FORMER = { run: 'why', orbits: 'more', catch: 'more' };

/** @type {import('./card.js').Study[]} */
export const PANELS = [
  {
    id: 'map',
    tab: 'map',
    fills: true,
    title: 'Which drops survive?',
    about: '',
    load: () => import('./map/panel.js'),
  },
  {
    id: 'catch',
    tab: 'more',
    title: 'Catch the body',
    about: 'Brings this scene to rest on the table, and holds it there.',
    shared: FIGURE_STYLES,
    load: () => import('./catch/panel.js'),
  },
  {
    id: 'branch',
    tab: 'more',
    title: 'Orbits of period 2',
    about: 'What the boundary of stability gives birth to.',
    shared: FIGURE_STYLES,
    load: () => import('./branch/panel.js'),
  },
];
