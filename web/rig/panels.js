// Panels of the rig's steps. Each can stand alone under `embed/`.

/** The colours and sizes of the server's pictures in the page, and the form of a study. */
const FIGURE_STYLES = ['charts/generated/figure-colours.css', 'charts/readable/server-figure.css', 'panels/study.css'];

/** @type {Record<'survival' | 'design' | 'fit' | 'calls', import('../panels/card.js').Entry>} */
export const RIG_PANELS = {
  survival: {
    id: 'survival',
    title: 'Survival under noise',
    about: 'How long runs of this scene last when the table errs.',
    shared: FIGURE_STYLES,
    load: () => import('../panels/survival/panel.js'),
  },
  design: {
    id: 'design',
    title: 'Design a controller',
    about: 'A law that brings this scene to rest in place.',
    shared: FIGURE_STYLES,
    load: () => import('../panels/design/panel.js'),
  },
  fit: {
    id: 'fit',
    title: 'Fit this scene to measured bounces',
    about: 'Which values your rig has, how well the data tell them, and which margins follow.',
    shared: [...FIGURE_STYLES, 'panels/measured/measured.css'],
    load: () => import('../panels/fit/panel.js'),
  },
  calls: {
    id: 'calls',
    title: 'The same from the API',
    about: 'What this page shows, as commands.',
    load: () => import('../panels/calls/panel.js'),
  },
};
