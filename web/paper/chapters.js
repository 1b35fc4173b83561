// The chapters of the paper's page, in their order. Each can stand alone under `embed/`.

/** @type {Entry[]} */
export const CHAPTERS = [
  {
    id: 'reading',
    title: 'The paper, item by item',
    about: 'Each equation, table, figure and claim: as printed, as computed, and why they differ.',
    kind: 'reading',
    fills: true,
    sheets: [],
    load: () => import('./contents.js').then(({ items }) => items()),
  },
  {
    id: 'paper',
    title: 'The cases',
    about: 'The numbers that the paper prints for its cases, beside those of this server.',
    kind: 'reading',
    fills: true,
    sheets: [],
    load: () => import('./contents.js').then(({ PaperCases }) => PaperCases),
  },
  {
    id: 'gallery',
    title: 'Where usual methods fail',
    about: 'Scenes on which they are wrong, with what is true.',
    kind: 'reading',
    fills: true,
    sheets: [],
    load: () => import('./contents.js').then(({ failures }) => failures()),
  },
  {
    id: 'precision',
    title: 'Speed against accuracy',
    about: 'What a scene costs by each method, and how far it ends from the truth.',
    load: () => import('../panels/precision/panel.js').then(({ SpeedAgainstAccuracy }) => SpeedAgainstAccuracy),
  },
  {
    id: 'ladder',
    title: 'Which model a scene needs',
    about: 'The same scene by every simpler model, and what each leaves out.',
    load: () => import('../panels/ladder/panel.js').then(({ LadderOf }) => LadderOf),
  },
];
