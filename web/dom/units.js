// The unit of the angles that the page shows: radians or degrees. Requests and typed scenes keep radians.

import { remember, remembered } from '../api/remembered.js';

const STORED = 'equipoise.angles';
/** @typedef {'rad' | 'deg'} Angles */

/** The choice that an address asks for, if any. @param {string} search @returns {Angles | null} */
function asked(search) {
  const value = new URLSearchParams(search).get('angles');
  return value === 'deg' || value === 'rad' ? value : null;
}

/** The reader's own choice. @returns {Angles} */
const stored = () => (remembered(STORED, 'rad') === 'deg' ? 'deg' : 'rad');

/** @type {Angles} */
// Formulas of the page are tested without one.
let shown = asked(globalThis.location?.search ?? '') ?? stored();

/** The unit in which angles are shown. */
export const angles = () => shown;

/** Event of the document after the unit of angles has changed. */
export const UNITS = 'units';

/** @param {Angles} unit */
function show(unit) {
  if (unit === shown) return;
  shown = unit;
  document.dispatchEvent(new Event(UNITS));
}

/** Lets a button switch the unit, for later visits as well. @param {HTMLElement} button */
export function offerAngles(button) {
  const tell = () => {
    const [now, other] = shown === 'deg' ? ['degrees', 'radians'] : ['radians', 'degrees'];
    button.textContent = shown === 'deg' ? '°' : 'rad';
    button.title = `Angles in ${now}`;
    // The name has the text that one sees.
    button.ariaLabel = `Angles in ${button.textContent}; switch to ${other}`;
  };
  button.addEventListener('click', () => {
    const other = shown === 'deg' ? 'rad' : 'deg';
    remember(STORED, other);
    show(other);
  });
  document.addEventListener(UNITS, tell);
  tell();
}

/** The unit that an address asks for, for this visit; without one the reader's own. @param {string} search */
export const followAddress = (search) => show(asked(search) ?? stored());

/** Adds the unit of angles to a query of the page where it is not the usual one. @param {URLSearchParams} query */
export function keepAngles(query) {
  if (shown === 'deg') query.set('angles', 'deg');
}

/** Degrees, or radians, as a unit. @param {string | null} unit in rad */
export const isAngle = (unit) => unit !== null && /^\/?rad/.test(unit);

/** Number by which a value in SI units is multiplied to be shown. @param {string | null} unit of the value */
export function shownFactor(unit) {
  if (shown === 'rad' || !isAngle(unit)) return 1;
  const factor = 180 / Math.PI;
  if (!unit?.startsWith('/')) return factor;
  return unit === '/rad²' ? factor ** -2 : 1 / factor;
}

/** A unit or the name of an axis as shown: `θ / rad` becomes `θ / °`. @param {string} text */
export const shownUnit = (text) => (shown === 'rad' ? text : text.replace(/\brad\b/, '°'));

/**
 * A value as shown, in the digits that a double has beyond its rounding: 20° stay 20 after a turn through radians.
 * @param {number} value in SI units
 * @param {string | null} unit
 */
export function shownValue(value, unit) {
  const factor = shownFactor(unit);
  return factor === 1 ? value : Number((value * factor).toPrecision(15));
}
