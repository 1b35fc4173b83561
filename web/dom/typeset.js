// Words with symbols, minus signs and numbers set as in print.

import { h } from './elements.js';
import { number } from './numbers.js';

/** @param {string} words */
export const capitalized = (words) => words.slice(0, 1).toUpperCase() + words.slice(1);

/**
 * A symbol in italics, `κ_c` with its subscript and `y*` with its star raised.
 * @param {string} text
 */
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

/**
 * The server's sentences: symbols and minus signs set as such, names of fields in words.
 * @param {string} text
 */
export const marked = (text) =>
  text
    .replaceAll('`', '')
    .replace(/(?<=[a-z])_(?=[a-z])/g, ' ')
    .replace(/(?<![\w.])-(?=\d)/g, '\u2212')
    .split(/((?:κ|σ)_[A-Za-z]+(?:,max)?|y\*)/)
    .map((part, index) => (index % 2 ? symbol(part) : part));

/** The same with numbers no longer than one reads. @param {string} text */
export const prose = (text) =>
  marked(text.replace(/-?\b\d+\.\d{6,}(?:e-?\d+)?/g, (digits) => number(Number(digits), 6)));
