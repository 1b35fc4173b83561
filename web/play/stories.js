// The stories under the scene: a scene, a caption and, for some, what is done to its run. A lecture walks through them by keys.

/** @typedef {{name: string, preset: string, caption: string, deeds?: [string, string][]}} Story */

/** @type {readonly Story[]} */
export const STORIES = [
  { name: 'Balanced', preset: 'case-1', caption: 'A table keeps a bouncing rod upright by tilting.' },
  { name: 'Too much tilt', preset: 'case-3', caption: 'The table tilts too much: each swing is wider than the last.' },
  {
    name: 'Lossy, on an incline',
    preset: 'case-4',
    caption: 'Each bounce loses half its speed. The table strikes back to make up for it.',
  },
  { name: 'Juggle', preset: 'juggling', caption: 'A low bounce and a high one, in turn.' },
  {
    name: 'Caught',
    preset: 'rough-catch',
    caption: 'A few bounces, then the table takes the rod down to rest and holds it.',
    deeds: [
      ['interventions.0.impact', '5'],
      ['interventions.0.catch.strategy', 'bounce_down'],
    ],
  },
];

/** The caption of a case that is a story. @param {string} preset */
export const captionOf = (preset) => STORIES.find((story) => story.preset === preset)?.caption;
