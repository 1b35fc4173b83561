// A setting: a field of the server's table with its value as text to type, in an address, and in words.

import { number, quantity } from '../dom/numbers.js';
import { parse, read } from '../dom/typed-number.js';
import { shownValue } from '../dom/units.js';

/** A value, or the reason why a text is none. @typedef {{value?: unknown, problem?: string}} Reading */

/** The id of the control of a field. @param {Field} field */
export const idOf = ({ field }) => `field-${field.replaceAll('.', '-')}`;

/** The titles of fields in a sentence, so many of them at most. @param {Field[]} fields @param {number} most */
export function titlesOf(fields, most) {
  const titles = fields.slice(0, most).map(({ title }) => title.toLowerCase());
  return titles.join(', ') + (fields.length > most ? ` and ${fields.length - most} more` : '');
}

/** The number that stands where none is set. @param {Field} field */
export const usual = ({ default: value }) => (typeof value === 'number' ? value : null);

/** The limits with their unit; '' for a field without them. @param {Field} field */
export const limitsOf = ({ minimum, maximum, unit }) =>
  minimum == null || maximum == null ? '' : `${number(shownValue(minimum, unit))} to ${quantity(maximum, unit)}`;

/** The fault of a field that has to have a value. @param {Field} field */
export const missing = (field) => `${field.title} is needed${limitsOf(field) && `: ${limitsOf(field)}`}.`;

/** A value in words. @param {Field} field @param {unknown} value @returns {string} */
export function told(field, value) {
  if (value == null) return field.default == null ? 'not set' : told(field, field.default);
  if (Array.isArray(value)) return 'those of the case';
  return typeof value === 'number' ? quantity(value, field.unit) : String(value);
}

/** The fault of a value, after “which …”; null for one that is allowed. @param {Field} field @param {unknown} value */
function fault(field, value) {
  const { kind, minimum, maximum, choices } = field;
  if (kind === 'boolean') return typeof value === 'boolean' ? null : 'is neither true nor false';
  if (choices) return choices.includes(String(value)) ? null : `is none of ${choices.join(', ')}`;
  if (!Number.isFinite(value)) return 'is not a number';
  if (kind === 'integer' && !Number.isInteger(value)) return 'is not a whole number';
  const outside = Number(value) < (minimum ?? -Infinity) || Number(value) > (maximum ?? Infinity);
  return outside ? `is outside its limits, ${limitsOf(field)}` : null;
}

/** Reads a value, or a number of a list, from an address. @param {Field} field @param {string} text @returns {Reading} */
export function linked(field, text) {
  const number = text.trim() === '' ? NaN : Number(text);
  const value = field.choices ? text : field.kind === 'boolean' ? ({ true: true, false: false }[text] ?? text) : number;
  const problem = fault(field, value);
  return problem === null ? { value } : { problem };
}

/** Numbers apart by commas, semicolons or blanks. @param {string} text @param {string} unit */
const numbers = (text, unit) =>
  text
    .trim()
    .split(/\s*[,;]\s*|\s+(?=[-+.\d\u2212])/)
    .map((part) => parse(part, unit));

/** Reads a typed value that is not empty, by kind. @type {Partial<Record<Field['kind'], (field: Field, text: string) => Reading>>} */
const READERS = {
  vertices: ({ unit }, text) => {
    const value = text
      .trim()
      .split('\n')
      .map((line) => numbers(line, unit));
    const wrong = value.findIndex((place) => place.length !== 2 || place.includes(null));
    return wrong < 0 ? { value } : { problem: `Line ${wrong + 1} is not x and y, as in “0.1, 0.2”.` };
  },
  numbers: ({ unit }, text) => {
    const value = numbers(text, unit);
    return value.includes(null)
      ? { problem: `“${text.trim()}” is not a list of numbers, as in “0.2, 0.3”.` }
      : { value };
  },
};

/** Reads a typed value. @param {Field} field @param {string} text @param {boolean} needed false where it may be left empty @returns {Reading} */
export function typed(field, text, needed) {
  if (text.trim() === '') return needed ? { problem: missing(field) } : {};
  const reader = READERS[field.kind];
  if (reader) return reader(field, text);
  const { value, problem } = read(text, field.kind === 'integer' ? null : field.unit);
  const range = limitsOf(field) && ` from ${limitsOf(field)}`;
  if (value === undefined) return { problem: problem?.replace(/(is not a number)\.$/, `$1${range}.`) };
  const wrong = fault(field, value);
  if (wrong === null) return { value };
  const whole = wrong.endsWith('number');
  return { problem: `${whole ? `“${text.trim()}”` : quantity(value, field.unit)} ${wrong}${whole ? range : ''}.` };
}

/** Longest number that is shown whole without focus, in characters, and the digits of a longer one. */
const SHORT = 8;
const DIGITS = 4;

/** A value as a text to type, in the unit that the page shows. @param {Field} field @param {unknown} value @param {boolean} [whole] with all digits */
export function textOf({ unit }, value, whole = true) {
  if (Array.isArray(value))
    return value.map((one) => [one].flat().join(', ')).join(Array.isArray(value[0]) ? '\n' : ', ');
  if (typeof value !== 'number') return String(value ?? '');
  const shown = shownValue(value, unit);
  return whole || String(shown).length <= SHORT ? String(shown) : String(Number(shown.toPrecision(DIGITS)));
}
