// The columns of a file, each with what it is taken for, which the reader may correct.

import { html, useRef } from '../../vendor/preact/preact.js';
import { Choice, Row, Table } from '../parts.js';
import { ALL, QUANTITIES } from './quantities.js';
import { unitsOf } from './read.js';

/** @typedef {import('./read.js').Head} Head */
/** @typedef {import('./quantities.js').Quantity} Quantity */

const CHOICES = {
  '': 'not used',
  ...Object.fromEntries(ALL.map((one) => [one, `${QUANTITIES[one][0]}, ${QUANTITIES[one][2]}`])),
};
/** Columns beyond these are no table of impacts. */
const MOST = 40;

/** Units of a column. @param {Quantity | null} quantity */
const unitsFor = (quantity) => (quantity && quantity !== 'n' ? unitsOf(quantity) : []);

/** The unit of a column: the one that its head tells, else that of SI. @param {Head} head */
const unitOf = ({ quantity, unit }) => (unitsFor(quantity).includes(unit) ? unit : (unitsFor(quantity)[0] ?? ''));

/** @param {{file: typeof import('./file.js').measured}} props */
export function Columns({ file: { heads, reading, pick } }) {
  // It stays open while its columns are taken for others.
  const open = useRef(false);
  if (heads.length === 0) return null;
  if (!reading) open.current = true;
  const used = heads.filter(({ quantity }) => quantity !== null).length;
  const taken = (/** @type {number} */ place, /** @type {Quantity | null} */ quantity, /** @type {string} */ unit) =>
    pick(new Map(heads.map((one, at) => [at, at === place ? { quantity, unit } : { ...one, unit: unitOf(one) }])));
  const row = (/** @type {Head} */ one, /** @type {number} */ place) => {
    const label = one.head || `column ${place + 1}`;
    const units = unitsFor(one.quantity);
    // A column that is taken for something else begins in the unit of SI.
    const is = (/** @type {string} */ name) => {
      const quantity = /** @type {Quantity | ''} */ (name) || null;
      taken(place, quantity, unitsFor(quantity)[0] ?? '');
    };
    return html`<${Row} cells=${[
      label,
      html`<${Choice} label=${`${label}: is`} value=${one.quantity ?? ''} choices=${CHOICES} changed=${is} />`,
      html`<${Choice} label=${`${label}: unit`} value=${unitOf(one)} disabled=${units.length === 0}
        choices=${Object.fromEntries(units.map((unit) => [unit, unit]))} changed=${(/** @type {string} */ unit) => taken(place, one.quantity, unit)} />`,
    ]} />`;
  };
  return html`<details class="measured-columns" id="fit-columns" open=${open.current}>
    <summary>Columns: ${used} used, ${heads.length - used} not used</summary>
    <${Table} label="Columns of the file" head=${['Column', 'is', 'in']}>${heads.slice(0, MOST).map(row)}<//>
    <p class="muted">${reading?.unused}</p>
  </details>`;
}
