// cividis: the colours of a map. Equal steps look equally large, with any colour vision, and lightness rises all the way.
//
// J. R. Nuñez, C. R. Anderton, R. S. Renslow: Optimizing colormaps with consideration for color vision deficiency to enable
// accurate interpretation of scientific data. PLoS ONE 13 (2018) e0199239.

import COLOURS from './generated/cividis.json' with { type: 'json' };
import { pixel } from './theme.js';

/** Some of them, as a background. */
export const GRADIENT = `linear-gradient(90deg, ${COLOURS.filter((_, index) => index % 15 === 0).map((colour) => `#${colour}`)})`;

/** All colours, from the darkest on, as pixels of an ImageData. */
export const PIXELS = Uint32Array.from(COLOURS, (colour) =>
  pixel([0, 2, 4].map((at) => parseInt(colour.slice(at, at + 2), 16))),
);
