// Panels of the rig's steps. Each can stand alone under `embed/`.

import { STUDY_SHEETS } from '../dom/styles.js';

/** @type {Record<'survival' | 'design' | 'fit' | 'calls', Entry>} */
export const RIG_PANELS = {
  survival: {
    id: 'survival',
    title: 'Survival under noise',
    about: 'How long runs of this scene last when the table errs.',
    load: () => import('../panels/survival/panel.js').then(({ Survival }) => Survival),
  },
  design: {
    id: 'design',
    title: 'Design a controller',
    about: 'A law that brings this scene to rest in place.',
    load: () => import('../panels/design/panel.js').then(({ Design }) => Design),
  },
  fit: {
    id: 'fit',
    title: 'Fit this scene to measured bounces',
    about: 'Which values your rig has, how well the data tell them, and which margins follow.',
    sheets: [...STUDY_SHEETS, 'panels/fit/fit.css'],
    load: () => import('../panels/fit/panel.js').then(({ Fit }) => Fit),
  },
  calls: {
    id: 'calls',
    title: 'The same from the API',
    about: 'What this page shows, as commands.',
    load: () => import('../panels/calls/panel.js').then(({ Calls }) => Calls),
  },
};
