// Numbers as people read and type them: true minus, narrow spaces, units.

const MINUS = '\u2212';
const NARROW = '\u202f';
const SUPERSCRIPT = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** @param {string} text */
const typeset = (text) => text.replaceAll('-', MINUS);

/**
 * A number with so many significant digits, trailing zeros left out.
 * @param {number | null | undefined} value
 */
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

/**
 * A number with a constant count of decimals, so that a readout does not jump.
 * @param {number | null | undefined} value
 * @param {number} decimals
 */
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

/** The unit as printed after a number: nothing for a pure number. @param {string | null} unit */
export const unitAfter = (unit) => (unit === null || unit === '1' || unit === '' ? '' : NARROW + unit);

/**
 * @param {number | null | undefined} value
 * @param {string | null} unit
 */
export const quantity = (value, unit, digits = 4) => number(value, digits) + (value == null ? '' : unitAfter(unit));

/** A readout that breaks between its quantities only, which three spaces part; a sentence is none. @param {string} text */
export const unbroken = (text) =>
  text
    .split('   ')
    .map((part) => (part.length > 48 ? part : part.replaceAll(' ', '\u00a0')))
    .join('   ');

/**
 * Parses a typed number: decimal comma, typographic minus, `45°` and `pi/4` included; null when it is none.
 * @param {string} text
 * @param {string | null} unit
 */
export function parse(text, unit) {
  const plain = text
    .trim()
    .replaceAll(MINUS, '-')
    .replace(/[\s\u202f\u2009]/g, '')
    .replace(/^(-?\d*),(\d+)$/, '$1.$2');
  const turn = /^(-?)(\d*\.?\d*)\*?(?:π|pi)(?:\/(\d+\.?\d*))?$/i.exec(plain);
  if (turn) return ((turn[1] ? -1 : 1) * (turn[2] ? Number(turn[2]) : 1) * Math.PI) / (turn[3] ? Number(turn[3]) : 1);
  const degrees = unit?.startsWith('rad') && /^(.+)°$/.exec(plain);
  if (degrees) return scaled(degrees[1], Math.PI / 180);
  return scaled(plain, 1);
}

/**
 * @param {string} text
 * @param {number} factor
 */
function scaled(text, factor) {
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text)) return null;
  const value = Number(text) * factor;
  return Number.isFinite(value) ? value : null;
}
