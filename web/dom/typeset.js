// Words with symbols, minus signs and numbers set as in print.

import { h } from './elements.js';
import { number, quantity } from './numbers.js';
import { angles } from './units.js';

/** @param {string} words */
export const capitalized = (words) => words.slice(0, 1).toUpperCase() + words.slice(1);

/** A symbol in italics, `κ_c` with its subscript and `y*` with its star raised. @param {string} text */
export function symbol(text) {
  const [base, low] = text.split('_');
  const star = base.endsWith('*');
  return h(
    'i',
    { class: 'symbol' },
    star ? base.slice(0, -1) : base,
    star && h('sup', {}, '*'),
    low && h('sub', {}, low),
  );
}

/** Titles of a scene's fields by the names that the server's sentences use: the path, and its last part where that is a name. */
const titles = new Map();

/** Takes the titles of fields from their table. @param {{field: string, title: string}[]} fields */
export function knowTitles(fields) {
  for (const { field: path, title } of fields) {
    // A symbol keeps its case: gain of θ; a word does not: tilt gain.
    const words = lower(title);
    const last = path.slice(path.lastIndexOf('.') + 1);
    if (path.includes('.')) titles.set(path, words);
    if (last.includes('_') && !path.startsWith('table.feedback.')) titles.set(last, titles.get(last) ?? words);
  }
}

/** Names of quantities in answers. @type {Record<string, string>} */
const QUANTITIES = {
  'table.feedback': 'state feedback',
  'table.limits': 'limits of the table',
  max_theta: 'largest |θ|',
  lyapunov: 'third-order coefficient',
  linear: 'linear map',
  loss_of_stability: 'loss of stability',
  agree: 'agreement with the run',
};

/** The server's sentences in words: titles in place of names of fields, `null` as what there is none of, angles in the page's unit. @param {string} text */
export function inWords(text) {
  const plain = text
    .replaceAll('`', '')
    .replace(/ ?\((?:no unit|null takes a preset's back)\)/g, '')
    .replace(/(^|; )(\w+(?:(?:, | and )\w+)*) (?:is|are) null: /gi, (_, before, names) => {
      const words = names.replace(/\w+/g, (/** @type {string} */ name) => lower(inOwnWords(name)));
      return before ? `; no ${words}: ` : `No ${words}: `;
    })
    .replace(/\b[a-z]+(?:_[a-z]+)*(?:\.[a-z]+(?:_[a-z]+)*)+\b|\b[a-z]+(?:_[a-z]+)+\b/gi, inOwnWords);
  if (angles() === 'rad') return plain;
  return plain.replace(/(-?\d[\d.]*(?:e[+-]?\d+)?) (rad(?:\/s)?)(?![\w/])/g, (_, digits, unit) =>
    quantity(Number(digits), unit).replaceAll('\u2212', '-'),
  );
}

/** @param {string} words */
const lower = (words) => words.slice(0, 1).toLowerCase() + words.slice(1);

/** @param {string} name */
function inOwnWords(name) {
  const key = lower(name);
  const words = QUANTITIES[key] ?? titles.get(key);
  if (words === undefined) return name.replaceAll('_', ' ');
  return key === name ? words : capitalized(words);
}

/** The server's sentences: symbols and minus signs set as such, names of fields in words. @param {string} text */
export const marked = (text) =>
  inWords(text)
    .replace(/(?<![\w.])-(?=\d)/g, '\u2212')
    .split(/((?:κ|σ)_[A-Za-z]+(?:,max)?|y\*)/)
    .map((part, index) => (index % 2 ? symbol(part) : part));

/** The same with numbers no longer than one reads. @param {string} text */
export const prose = (text) =>
  marked(text.replace(/-?\b\d+\.\d{5,}(?:e-?\d+)?/g, (digits) => number(Number(digits)).replaceAll('\u202f', ' ')));
