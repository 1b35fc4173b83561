// cividis: the colours of a map. Equal steps look equally large, with any colour vision, and lightness rises all the way.
//
// J. R. Nuñez, C. R. Anderton, R. S. Renslow: Optimizing colormaps with consideration for color vision deficiency to enable
// accurate interpretation of scientific data. PLoS ONE 13 (2018) e0199239.

import { TABLE } from './generated/cividis-table.js';

const COLOURS = 256;

/** Some of them, as a background. */
export const GRADIENT = `linear-gradient(90deg, ${(TABLE.match(/.{6}/g) ?? []).filter((_, index) => index % 15 === 0).map((colour) => `#${colour}`)})`;

/** All colours, from the darkest on, as pixels of an ImageData. */
export const PIXELS = Uint32Array.from({ length: COLOURS }, (_, index) => {
  const at = 6 * index;
  const [r, g, b] = [0, 2, 4].map((byte) => parseInt(TABLE.slice(at + byte, at + byte + 2), 16));
  const pixel = new Uint8ClampedArray([r, g, b, 255]);
  return new Uint32Array(pixel.buffer)[0];
});
