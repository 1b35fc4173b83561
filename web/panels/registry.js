// The tabs beside the scene, and the panels in each with a sentence on them and where their code is.

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
    // The second has the form of the settings of a catch.
    sheets: ['panels/map/map.css', 'panels/study.css'],
    load: () => import('./map/panel.js').then(({ StabilityMap }) => StabilityMap),
  },
  {
    id: 'catch',
    tab: 'more',
    title: 'Catch the body',
    about: 'Brings this scene to rest on the table, and holds it there.',
    load: () => import('./catch/panel.js').then(({ CatchBody }) => CatchBody),
  },
  {
    id: 'branch',
    tab: 'more',
    title: 'Orbits of period 2',
    about: 'What the boundary of stability gives birth to.',
    load: () => import('./branch/panel.js').then(({ Branch }) => Branch),
  },
];
