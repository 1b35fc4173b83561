// The columns of a file, each with what it is taken for, which the reader may correct.

import { html, useRef } from '../../vendor/preact/preact.js';
import { Choice, Row, Table } from '../parts.js';
import { ALL, QUANTITIES, UNITS } from './quantities.js';
import { shown } from './read.js';

/** @typedef {import('./read.js').Head} Head */
/** @typedef {import('./quantities.js').Quantity} Quantity */

const CHOICES = {
  '': 'not used',
  ...Object.fromEntries(ALL.map((one) => [one, `${QUANTITIES[one][0]}, ${QUANTITIES[one][2]}`])),
};
/** Columns beyond these are no table of impacts. */
const MOST = 40;
/** Columns beyond these are not named one by one. */
const NAMED = 20;

/** Units of a column, that of SI first, and the one that its head tells among them. @param {Head} head */
function unitsOf({ quantity, unit }) {
  const units = quantity ? UNITS[QUANTITIES[quantity][1]] : [];
  return units.length === 0 || unit === '' || units.includes(unit) ? units : [...units, unit];
}

/** @param {{file: typeof import('./file.js').measured}} props */
export function Columns({ file: { content, pick } }) {
  const { heads, reading } = content;
  // It stays open while its columns are taken for others.
  const open = useRef(false);
  if (heads.length === 0) return null;
  if (!reading) open.current = true;
  const left = heads.filter(({ quantity }) => quantity === null);
  const named = left.map(({ head }) => shown(head)).filter(Boolean);
  const row = (/** @type {Head} */ one, /** @type {number} */ place) => {
    const label = one.head || `column ${place + 1}`;
    const units = unitsOf(one);
    const take = (/** @type {Partial<Head>} */ part) =>
      pick(new Map(heads.map((head, at) => [at, at === place ? { ...head, ...part } : head])));
    // A column that is taken for something else begins in the unit of SI.
    const is = (/** @type {string} */ name) =>
      take({ quantity: /** @type {Quantity | ''} */ (name) || null, unit: '' });
    return html`<${Row} cells=${[
      label,
      html`<${Choice} label=${`${label}: is`} value=${one.quantity ?? ''} choices=${CHOICES} changed=${is} />`,
      html`<${Choice} label=${`${label}: unit`} value=${one.unit || (units[0] ?? '')} disabled=${units.length === 0}
        choices=${Object.fromEntries(units.map((unit) => [unit, unit]))} changed=${(/** @type {string} */ unit) => take({ unit })} />`,
    ]} />`;
  };
  return html`<details class="measured-columns" id="fit-columns" open=${open.current}>
    <summary>Columns: ${heads.length - left.length} used, ${left.length} not used</summary>
    <${Table} label="Columns of the file" head=${['Column', 'is', 'in']}>${heads.slice(0, MOST).map(row)}<//>
    ${reading && named.length > 0 && html`<p class="muted">Not used: ${named.slice(0, NAMED).join(', ')}${named.length > NAMED && ' and more'}.</p>`}
  </details>`;
}
