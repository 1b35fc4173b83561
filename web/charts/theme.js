// The style sheet's colours for canvases, read once per change of scheme.

import { UNITS } from '../dom/units.js';

/** @type {Map<string, string>} */
const colours = new Map();
/** @type {Set<() => void>} */
const listeners = new Set();

/** @param {Colour} name */
export function colourOf(name) {
  const found = () => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const colour = colours.get(name) ?? (found() || name);
  colours.set(name, colour);
  return colour;
}

/** Red, green and blue of a colour. @param {Colour} name */
export const partsOf = (name) => [1, 3, 5].map((at) => Number.parseInt(colourOf(name).slice(at, at + 2), 16));

/** A pixel as the canvas has it in memory. @param {number[]} parts red, green and blue @param {number} [opacity] up to 255 */
export const pixel = ([red, green, blue], opacity = 255) => ((opacity << 24) | (blue << 16) | (green << 8) | red) >>> 0;

/** Calls when what is drawn looks another way: the scheme or the unit of angles has changed. @param {() => void} listener */
export const onThemeChange = (listener) => void listeners.add(listener);

/** True while a room looks on, from afar. */
export const presenting = () => document.documentElement.classList.contains('presenting');

function changed() {
  colours.clear();
  for (const listener of listeners) listener();
}
// Units are drawn too, and a room sees larger dots.
document.addEventListener(UNITS, changed);
new MutationObserver(changed).observe(document.documentElement, { attributeFilter: ['class'] });
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);

export const SANS = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", Arial, sans-serif';
// Other serif fonts of a system may lose the dot of θ̇ within the letter.
export const SERIF = `"STIX Two Text", "Cambria", "Georgia", "Times New Roman", "Liberation Serif", ${SANS}`;
