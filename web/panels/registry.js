// The studies: their tabs, and the panels in each with a sentence on them and where their code is.

/** The colours and sizes of the server's pictures in the page, and the form of a study. */
const FIGURE_STYLES = ['charts/generated/figure-colours.css', 'charts/readable/server-figure.css', 'panels/study.css'];

/** The tabs in their order; the first is open unless the address says another. @type {readonly {id: string, name: string}[]} */
export const TABS = [
  { id: 'run', name: 'Run' },
  { id: 'map', name: 'Map' },
  { id: 'orbits', name: 'Orbits' },
  { id: 'noise', name: 'Noise' },
  { id: 'control', name: 'Control' },
  { id: 'catch', name: 'Catch' },
  { id: 'measured', name: 'Measured' },
  { id: 'fit', name: 'Fit' },
  { id: 'api', name: 'API' },
];

/** @type {import('./card.js').Study[]} */
export const PANELS = [
  {
    id: 'map',
    tab: 'map',
    title: 'Stability map',
    about: 'Which scenes keep their balance, beside this one: a run in every cell.',
    load: () => import('./map/panel.js'),
  },
  {
    id: 'survival',
    tab: 'noise',
    title: 'Survival under noise',
    about: 'How long runs of this scene last when the table errs.',
    shared: FIGURE_STYLES,
    load: () => import('./survival/panel.js'),
  },
  {
    id: 'design',
    tab: 'control',
    title: 'Design a controller',
    about: 'A law that brings this scene to rest in place.',
    shared: FIGURE_STYLES,
    load: () => import('./design/panel.js'),
  },
  {
    id: 'catch',
    tab: 'catch',
    title: 'Catch the body',
    about: 'Brings this scene to rest on the table, and holds it there.',
    shared: FIGURE_STYLES,
    load: () => import('./catch/panel.js'),
  },
  {
    id: 'branch',
    tab: 'orbits',
    title: 'Orbits of period 2',
    about: 'What the boundary of stability gives birth to.',
    shared: FIGURE_STYLES,
    load: () => import('./branch/panel.js'),
  },
  {
    id: 'fit',
    tab: 'fit',
    title: 'Fit this scene to measured impacts',
    about: 'Which values your rig has, how well the data tell them, and which margins follow.',
    shared: [...FIGURE_STYLES, 'panels/measured/measured.css'],
    load: () => import('./fit/panel.js'),
  },
  {
    id: 'calls',
    tab: 'api',
    title: 'The same from the API',
    about: 'What this page shows, as commands.',
    load: () => import('./calls/panel.js'),
  },
];
