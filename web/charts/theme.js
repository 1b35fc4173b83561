// The style sheet's colours for canvases, read once per change of scheme.

import { UNITS } from '../dom/units.js';

const NAMES = /** @type {const} */ ([
  'ink',
  'muted',
  'line',
  'faint',
  'surface',
  'accent',
  'strike',
  'good',
  'caution',
  'survives',
  'falls',
  'rests',
  'series-0',
  'series-1',
  'series-2',
  'series-3',
  'measured',
]);

/** @typedef {Record<(typeof NAMES)[number], string>} Colours */

/** @type {Colours | null} */
let colours = null;
/** @type {Set<() => void>} */
const listeners = new Set();

/** @returns {Colours} */
export function theme() {
  if (colours) return colours;
  const style = getComputedStyle(document.documentElement);
  const found = NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]);
  colours = /** @type {Colours} */ (Object.fromEntries(found));
  return colours;
}

/** Calls when what is drawn looks another way: the scheme or the unit of angles has changed. @param {() => void} listener */
export const onThemeChange = (listener) => void listeners.add(listener);

/** True while a room looks on, from afar. */
export const presenting = () => document.documentElement.classList.contains('presenting');

function changed() {
  colours = null;
  for (const listener of listeners) listener();
}
// Units are drawn too, and a room sees larger dots.
document.addEventListener(UNITS, changed);
new MutationObserver(changed).observe(document.documentElement, { attributeFilter: ['class'] });
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);

export const SANS = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "Noto Sans", Arial, sans-serif';
// Other serif fonts of a system may lose the dot of θ̇ within the letter.
export const SERIF = `"STIX Two Text", "Cambria", "Georgia", "Times New Roman", "Liberation Serif", ${SANS}`;
