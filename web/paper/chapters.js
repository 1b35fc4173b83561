// The chapters of the paper's page, in their order. Each can stand alone under `embed/`.

import { STUDY_SHEETS } from '../dom/styles.js';
import { html } from '../vendor/preact/preact.js';

/** @type {{id: string, title: string, about: string, load: import('./words.js').Load}[]} */
export const CHAPTERS = [
  {
    id: 'reading',
    title: 'The paper, item by item',
    about: 'Each equation, table, figure and claim: as printed, as computed, and why they differ.',
    load: (context) => import('./contents.js').then(({ items }) => items(context)),
  },
  {
    id: 'paper',
    title: 'The cases',
    about: 'The numbers that the paper prints for its cases, beside those of this server.',
    load: (context) => import('./contents.js').then(({ cases }) => cases(context)),
  },
  {
    id: 'gallery',
    title: 'Where usual methods fail',
    about: 'Scenes on which they are wrong, with what is true.',
    load: (context) => import('./contents.js').then(({ failures }) => failures(context)),
  },
];

/** Panels that are chapters too: they ask about one scene. @type {import('../panels/card.js').Entry[]} */
export const PANEL_CHAPTERS = [
  {
    id: 'precision',
    title: 'Speed against accuracy',
    about: 'What a scene costs by each method, and how far it ends from the truth.',
    sheets: STUDY_SHEETS,
    load: () => import('../panels/precision/panel.js'),
  },
  {
    id: 'ladder',
    title: 'Which model a scene needs',
    about: 'The same scene by every simpler model, and what each leaves out.',
    sheets: STUDY_SHEETS,
    load: () => import('../panels/ladder/panel.js'),
  },
];

/** The title of a chapter with what it is about. @param {{id: string, title: string, about: string}} chapter */
export const head = ({ id, title, about }) => html`<h2 id=${`${id}-title`}>${title}</h2>
  <p class="lead">${about}</p>`;
