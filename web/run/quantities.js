// The quantities of an impact as the page names them.

/** Symbol or word, unit, and decimals where a number is read by itself. @type {Partial<Record<Column, [sign: string, unit: string, decimals: number]>>} */
export const QUANTITIES = {
  t: ['t', 's', 4],
  x: ['x', 'm', 4],
  theta: ['θ', 'rad', 4],
  x_dot: ['ẋ', 'm/s', 4],
  y_dot: ['ẏ', 'm/s', 4],
  theta_dot: ['θ̇', 'rad/s', 3],
  alpha: ['α', 'rad', 4],
  table_speed: ['table', 'm/s', 4],
  contact_velocity: ['contact velocity', 'm/s', 4],
  flight_time: ['flight time', 's', 4],
  energy: ['E', 'm²/s²', 4],
};

/** @param {Column} column */
export function quantityOf(column) {
  const [sign, unit, decimals] = QUANTITIES[column] ?? ['bounce', '1', 0];
  // As printed on an axis.
  const name = unit === '1' ? sign : `${sign} / ${unit.replace('/s²', ' s⁻²').replace('/s', ' s⁻¹')}`;
  return { sign, unit, decimals, name };
}
