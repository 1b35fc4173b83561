// Numbers as people type them: with a unit, a decimal comma, a true minus, or as a fraction of π.

import { angles, isAngle } from './units.js';

const DEGREE = Math.PI / 180;
/** Units with their value in SI. @type {Record<string, [string, number]>} */
const UNITS = {
  m: ['m', 1],
  s: ['s', 1],
  rad: ['rad', 1],
  '°': ['rad', DEGREE],
  deg: ['rad', DEGREE],
  degree: ['rad', DEGREE],
  degrees: ['rad', DEGREE],
  1: ['', 1],
  '%': ['', 0.01],
};
/** @type {Record<string, number>} */
const PREFIXES = { '': 1, c: 1e-2, m: 1e-3, µ: 1e-6, μ: 1e-6, u: 1e-6 };
/** A unit with its prefix and power. */
const UNIT = /^([cmµμu]?)(m|s|rad|°|deg(?:rees?)?|1|%)(²|\^?2)?$/;
/** Smaller units that may be typed for one of SI. @type {Record<string, string[]>} */
const SMALLER = { m: ['mm', 'cm'], s: ['ms'], rad: ['°', 'mrad'] };

/** The units that a field takes, in words. @param {string | null} unit */
export function unitsFor(unit) {
  if (unit === null) return 'it without a unit';
  if (unit === '1') return 'a number without a unit, or %';
  const [, prefixed] = /^[mµ](rad|m|s)(?=$|\/)/.exec(unit) ?? [];
  if (prefixed) return `${unit}, or another unit such as ${unit.replace(/^./, '')}`;
  const [first] = /rad|[ms]/.exec(unit) ?? [''];
  const others = (SMALLER[first] ?? []).map((smaller) => unit.replace(first, smaller));
  return others.length > 0 ? `${others.join(', ')} or ${unit}` : unit;
}

/** Most characters of a refused text that are repeated. */
const MOST_SHOWN = 40;

/** A number, and all behind it: digits in groups of three, a decimal point or comma, an exponent. */
const NUMBER = /^([+-]?(?:\d{1,3}(?: \d{3})+|\d+|(?=[.,]\d))(?:[.,]\d*)?(?:e[+-]?\d+)?)(.*)$/i;
const FRACTION_OF_PI = /^(-?)(\d*\.?\d*)\*?(?:π|pi)(?:\/(\d+\.?\d*))?$/i;
/** A comma that one reader takes for a decimal one, and another for one between thousands. */
const AMBIGUOUS = /^[+-]?[1-9]\d{0,2},\d{3}$/;

/** The kind of a unit, as its base units with their powers, and its value in SI; null if it is none. @param {string} text */
export function unitOf(text) {
  let factor = 1;
  /** @type {Record<string, number>} */
  const powers = {};
  for (const [place, side] of text.split('/').entries())
    for (const part of side.split(/[·* ]/)) {
      const [, prefix, name, square] = UNIT.exec(part) ?? [];
      if (name === undefined) return null;
      const power = (square ? 2 : 1) * (place === 0 ? 1 : -1);
      const [base, size] = UNITS[name];
      factor *= (PREFIXES[prefix] * size) ** power;
      if (base) powers[base] = (powers[base] ?? 0) + power;
    }
  const kind = Object.entries(powers)
    .filter(([, power]) => power !== 0)
    .sort()
    .join();
  return { kind, factor };
}

/** A number and the text behind it; null if it begins with none. @param {string} text @returns {[number, string] | null} */
function split(text) {
  const plain = text.replaceAll('\u2212', '-').replace(/\s+/g, ' ').trim();
  const turn = FRACTION_OF_PI.exec(plain.replaceAll(' ', ''));
  if (turn) {
    const [, minus, times, parts] = turn;
    return [((minus ? -1 : 1) * (times ? Number(times) : 1) * Math.PI) / Number(parts ?? 1), 'π'];
  }
  const [, digits, rest] = NUMBER.exec(plain) ?? [];
  if (digits === undefined) return null;
  const value = Number(digits.replaceAll(' ', '').replace(',', '.'));
  return Number.isFinite(value) ? [value, rest.trim()] : null;
}

/** Factor from a typed unit to SI; null if it is none, or of another kind. @param {string} typed @param {string | null} unit in SI */
function factorOf(typed, unit) {
  if (typed === 'π') return 1;
  if (typed === '') return isAngle(unit) && angles() === 'deg' ? DEGREE ** (unit?.startsWith('/') ? -1 : 1) : 1;
  const own = unit === null ? null : unitOf(unit);
  const other = unitOf(typed);
  if (!own || !other) return null;
  // “20°” is understood where the field is in degrees per second.
  const isSame = other.kind === own.kind || (isAngle(unit) && other.kind === 'rad,1');
  return isSame ? other.factor / own.factor : null;
}

/**
 * Parses a typed number: decimal comma, typographic minus and `pi/4` included; null when it is none. It may have a unit, as in `20 cm`,
 * `20°` and `5 %`; without one it is in the unit that the page shows.
 * @param {string} text
 * @param {string | null} unit null for a number that takes none
 * @returns {number | null} in SI units
 */
export function parse(text, unit) {
  const [value, typed] = split(text) ?? [];
  const factor = typed === undefined ? null : factorOf(typed, unit);
  if (value === undefined || factor === null) return null;
  // Divided by 100, 35.6 cm have no rounding of 0.01 in them.
  const parts = Math.round(1 / factor);
  return Math.abs(parts * factor - 1) < 1e-12 ? value / parts : value * factor;
}

/** A reading of a text. @typedef {{value?: number, problem?: string}} Reading */

/** Reads a typed number; says why it is none. @param {string} text @param {string | null} unit @returns {Reading} */
export function read(text, unit) {
  const shown = `“${text.trim().slice(0, MOST_SHOWN)}”`;
  if (AMBIGUOUS.test(text.trim()))
    return {
      problem: `${shown} may be ${text.trim().replace(',', '.')} or ${text.trim().replace(',', '')}: type one of them.`,
    };
  const value = parse(text, unit);
  if (value !== null) return { value };
  const [, typed] = split(text) ?? [];
  if (!typed || !unitOf(typed)) return { problem: `${shown} is not a number${typed ? ` in ${unitsFor(unit)}` : ''}.` };
  return { problem: `${shown} has another unit: type ${unitsFor(unit)}.` };
}
