// Tables of numbers that scroll in their box, and lists of named numbers.

import { h } from './elements.js';
import { UNITS, shownUnit } from './units.js';

/** A name with its unit, in the unit of angles that the page shows. @param {string} name as in `θ / rad` */
const named = (name) => (/\brad\b/.test(name) ? h('span', { 'data-named': name }, shownUnit(name)) : name);

document.addEventListener(UNITS, () => {
  for (const element of document.querySelectorAll('[data-named]'))
    element.textContent = shownUnit(element.getAttribute('data-named') ?? '');
});

/**
 * @param {string} label for those who do not see it
 * @param {(string | Node)[]} head
 * @param {HTMLElement | DocumentFragment} body
 * @param {string} [kind] its class
 */
export const table = (label, head, body, kind) =>
  h(
    'div',
    { class: 'table-box', tabindex: 0, role: 'region', 'aria-label': label },
    h(
      'table',
      { class: kind },
      h(
        'thead',
        {},
        h('tr', {}, ...head.map((name) => h('th', { scope: 'col' }, typeof name === 'string' ? named(name) : name))),
      ),
      body,
    ),
  );

/** A row of a table with its name first. @param {string | Node | (string | Node)[]} name @param {(string | Node)[]} cells */
export const row = (name, cells) =>
  h('tr', {}, h('th', { scope: 'row' }, ...[name].flat()), ...cells.map((cell) => h('td', {}, cell)));

/** The entries of a list of numbers: name, value and meaning. @param {(readonly [string | Node, string | Node, string])[]} rows */
export const entries = (rows) =>
  rows.map(([name, value, meaning]) =>
    h('div', {}, h('dt', {}, name), h('dd', {}, value), h('dd', { class: 'muted' }, meaning)),
  );
