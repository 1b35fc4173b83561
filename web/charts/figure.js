// The frame around a chart: title, sentence, picture with a name, readout, table of its numbers.

import { paced } from '../dom/debounce.js';
import { h } from '../dom/elements.js';
import { unbroken } from '../dom/numbers.js';
import { UNITS } from '../dom/units.js';
import { Table } from '../panels/parts.js';
import { html, render } from '../vendor/preact/preact.js';

/** Rows that a table lists. */
const LISTED = 50;

/** The picture's name and its table change at most so often, ms. */
const PACE_MS = 1000;

/**
 * @param {string} id
 * @param {string} title
 * @param {string | Node} about one sentence
 * @param {string[]} columns of the table of its numbers
 * @param {(most: number) => (string | number)[][]} rows newest first
 */
export function makeFigure(id, title, about, columns, rows) {
  const box = h('div', { class: 'canvas-box', role: 'img', 'aria-label': 'Nothing to show yet' });
  const head = h('div', { class: 'card-head' }, h('h3', {}, title));
  const readout = h('output', { class: 'readout', 'aria-live': 'off' });
  const table = h('div');
  const fill = () => {
    if (!numbers.open) return;
    const cells = rows(LISTED).map((row) => html`<tr>${row.map((cell) => html`<td>${cell}</td>`)}</tr>`);
    render(html`<${Table} label=${`Numbers: ${title}`} head=${columns} children=${cells} />`, table);
  };
  const numbers = h('details', { toggle: fill }, h('summary', {}, 'Numbers'), table);
  const caption = h('figcaption', {}, head, h('p', { class: 'muted' }, about));
  document.addEventListener(UNITS, fill);
  return {
    id,
    title,
    /** The box of the picture. */
    box,
    element: h('figure', { class: 'card chart', id }, caption, box, readout, numbers),
    /** Describes the picture in words. */
    name: paced(PACE_MS, (/** @type {() => string} */ words) => box.setAttribute('aria-label', words())),
    /** Brings the table up to date while it is open. */
    list: paced(PACE_MS, fill),
    /** Adds a button to its head. @param {HTMLElement} button */
    offer: (button) => head.append(button),
    /** @param {string} text */
    read: (text) => {
      readout.textContent = unbroken(text);
    },
  };
}
