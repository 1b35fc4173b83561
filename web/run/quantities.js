// The quantities of an impact as the page names them.

import TABLE from './quantities.json' with { type: 'json' };

/** Symbol or word, unit, and decimals where a number is read by itself. @type {Partial<Record<Column, {sign: string, unit: string, decimals: number}>>} */
export const QUANTITIES = TABLE;

/** @param {Column} column */
export function quantityOf(column) {
  const { sign, unit, decimals } = QUANTITIES[column] ?? { sign: 'bounce', unit: '1', decimals: 0 };
  // As printed on an axis.
  const name = unit === '1' ? sign : `${sign} / ${unit.replace('/s²', ' s⁻²').replace('/s', ' s⁻¹')}`;
  return { sign, unit, decimals, name };
}
