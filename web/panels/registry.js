// The panels below the fold: their names, a sentence on each, and where their code is.

/** The colours and sizes of the server's pictures in the page. */
const FIGURE_STYLES = ['charts/generated/figure-colours.css', 'charts/readable/server-figure.css'];

/** @type {import('./card.js').Entry[]} */
export const PANELS = [
  {
    id: 'map',
    title: 'Stability map',
    about: 'Which scenes keep their balance, beside this one: a run in every cell.',
    load: () => import('./map/panel.js'),
  },
  {
    id: 'survival',
    title: 'Survival under noise',
    about: 'How long runs of this scene last when the table errs.',
    shared: FIGURE_STYLES,
    load: () => import('./survival/panel.js'),
  },
  {
    id: 'ladder',
    title: 'Which model does it need',
    about: 'The same scene by every simpler model, and what each leaves out.',
    load: () => import('./ladder/panel.js'),
  },
  {
    id: 'design',
    title: 'Design a controller',
    about: 'A law that brings this scene to rest in place.',
    shared: FIGURE_STYLES,
    load: () => import('./design/panel.js'),
  },
  {
    id: 'branch',
    title: 'Orbits of period 2',
    about: 'What the boundary of stability gives birth to.',
    shared: FIGURE_STYLES,
    load: () => import('./branch/panel.js'),
  },
  {
    id: 'precision',
    title: 'Speed against accuracy',
    about: 'What this scene costs by each method, and how far it ends from the truth.',
    shared: FIGURE_STYLES,
    load: () => import('./precision/panel.js'),
  },
  {
    id: 'paper',
    title: 'Printed and computed',
    about: 'The numbers of the paper beside those of the server.',
    half: true,
    load: () => import('./paper/panel.js'),
  },
  {
    id: 'calls',
    title: 'The same from the API',
    about: 'What this page shows, as commands.',
    half: true,
    load: () => import('./calls/panel.js'),
  },
  {
    id: 'gallery',
    title: 'Where usual methods fail',
    about: 'Scenes on which they are wrong, with what is true.',
    load: () => import('./gallery/panel.js'),
  },
];
