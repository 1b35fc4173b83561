// The symbols of the methods, as in the server's pictures: shape and colour tell the same.

import { OUTLINES } from './generated/method-outlines.js';

const NAMES = Object.keys(OUTLINES);
/** @type {[number, number][][]} */
const CORNERS = Object.values(OUTLINES).map((text) =>
  text.split(', ').map((corner) => /** @type {[number, number]} */ (corner.split(' ').map(Number))),
);

/** The number of a method's symbol; a method that is new here shares the last one. @param {string} method */
export const symbolOf = (method) => (NAMES.includes(method) ? NAMES.indexOf(method) : NAMES.length - 1);

/** The corners of a symbol about its middle, in half widths. @param {number} symbol */
export const outline = (symbol) => CORNERS[symbol];
