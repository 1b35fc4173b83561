// Numbers as people read them: true minus, narrow spaces, units.

import { shownFactor, shownUnit } from './units.js';

const MINUS = '\u2212';
const NARROW = '\u202f';
const SUPERSCRIPT = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** @param {string} text */
const typeset = (text) => text.replaceAll('-', MINUS);

/** A number with so many significant digits, trailing zeros left out. @param {number | null | undefined} value */
export function number(value, digits = 4) {
  if (value == null || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    const power = exponent
      .replace('+', '')
      .replace('-', '⁻')
      .replace(/\d/g, (d) => SUPERSCRIPT[Number(d)]);
    return `${typeset(String(Number(mantissa)))}${NARROW}×${NARROW}10${power}`;
  }
  return grouped(String(Number(value.toPrecision(digits))));
}

/** A number with a constant count of decimals, so that a readout does not jump. @param {number | null | undefined} value @param {number} decimals */
export function fixed(value, decimals) {
  if (value == null || !Number.isFinite(value)) return '–';
  const text = value.toFixed(decimals);
  return grouped(Number(text) === 0 ? text.replace('-', '') : text);
}

/** @param {string} text */
function grouped(text) {
  const [whole, part] = text.split('.');
  const parted = whole.replace('-', '').length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, NARROW) : whole;
  return typeset(part === undefined ? parted : `${parted}.${part}`);
}

/** The unit as printed after a number: nothing for a pure number, and no space before a degree sign. @param {string | null} unit */
export function unitAfter(unit) {
  if (unit === null || unit === '1' || unit === '') return '';
  const printed = shownUnit(unit);
  return printed.startsWith('°') ? printed : NARROW + printed;
}

/** A value with its unit; angles in the unit that the page shows. @param {number | null | undefined} value in SI units @param {string | null} unit */
export const quantity = (value, unit, digits = 4) =>
  value == null ? number(value) : number(value * shownFactor(unit), digits) + unitAfter(unit);

/**
 * A value of a readout or a table without its unit; an angle in degrees has a decimal less.
 * @param {number | null | undefined} value in SI units
 * @param {string} unit
 * @param {number} decimals
 */
export function fixedIn(value, unit, decimals) {
  const factor = shownFactor(unit);
  return value == null ? fixed(value, 0) : fixed(value * factor, factor > 1 ? Math.max(0, decimals - 1) : decimals);
}

/** The same with its unit. @param {number | null | undefined} value @param {string} unit @param {number} decimals */
export const fixedQuantity = (value, unit, decimals) =>
  fixedIn(value, unit, decimals) + (value == null ? '' : unitAfter(unit));

/** A readout that breaks between its quantities only, which three spaces part; a sentence is none. @param {string} text */
export const unbroken = (text) =>
  text
    .split('   ')
    .map((part) => (part.length > 48 ? part : part.replaceAll(' ', '\u00a0')))
    .join('   ');

/** The round step (1, 2 or 5 times a power of ten) that parts a span into about so many. @param {number} span @param {number} count */
export function roundStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const multiple = raw / power;
  return power * (multiple < 1.5 ? 1 : multiple < 3.5 ? 2 : multiple < 7.5 ? 5 : 10);
}

/** Round numbers in a range, about so many. @param {Interval} range @param {number} count */
export function ticks({ low, high }, count) {
  const step = roundStep(high - low, count);
  const first = Math.ceil(low / step - 1e-9);
  const length = Math.max(0, Math.floor(high / step + 1e-9) - first + 1);
  // 3 / 10 is 0.3, and 3 × 0.1 is not.
  const parts = Math.round(1 / step);
  return Array.from({ length }, (_, k) => (step < 1 ? (first + k) / parts : (first + k) * step));
}
