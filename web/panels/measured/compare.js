// Measured less simulated, impact by impact.

/** @typedef {import('../../run/impacts.js').Impacts} Impacts */
/** @typedef {import('./read.js').Measured} Measured */

export const COMPARED = /** @type {const} */ (['t', 'theta', 'x_dot', 'y_dot', 'theta_dot']);
/** @typedef {(typeof COMPARED)[number]} Compared */
/** Symbols and units. @type {Record<Compared | 'x', [string, string]>} */
export const SYMBOLS = {
  t: ['t', 's'],
  theta: ['θ', 'rad'],
  x_dot: ['ẋ', 'm/s'],
  y_dot: ['ẏ', 'm/s'],
  theta_dot: ['θ̇', 'rad/s'],
  x: ['x', 'm'],
};
/** @typedef {Record<'n' | Compared, number>} Residual in SI units; NaN where one of the two is not there */
/** @typedef {{quantity: Compared, count: number, rms: number, largest: number, at: number}} Sum the largest with its sign, at the impact of that number */

/**
 * The place of the impact of this number, or null.
 * @param {Impacts} impacts
 * @param {number} n
 */
function placeOf(impacts, n) {
  let [low, high] = [impacts.begin, impacts.end];
  while (low < high) {
    const middle = Math.floor((low + high) / 2);
    if (impacts.at('n', middle) < n) low = middle + 1;
    else high = middle;
  }
  return low < impacts.end && impacts.at('n', low) === n ? low : null;
}

/**
 * The residuals of the impacts that are simulated by now. Time counts from the first of them: no two clocks began together.
 * @param {Measured[]} measured with their numbers in the run
 * @param {Impacts} impacts
 * @returns {Residual[]}
 */
export function residuals(measured, impacts) {
  /** @type {[number, number] | null} */
  let zero = null;
  /** @type {Residual[]} */
  const found = [];
  for (const one of measured) {
    const place = placeOf(impacts, one.n);
    if (place === null) continue;
    /** @type {Residual} */
    const residual = { n: one.n, t: NaN, theta: NaN, x_dot: NaN, y_dot: NaN, theta_dot: NaN };
    for (const quantity of COMPARED)
      if (quantity !== 't') residual[quantity] = one[quantity] - impacts.at(quantity, place);
    const t = impacts.at('t', place);
    if (!Number.isNaN(one.t)) {
      zero ??= [one.t, t];
      residual.t = one.t - zero[0] - (t - zero[1]);
    }
    found.push(residual);
  }
  return found;
}

/** @param {Residual[]} all @returns {Sum[]} of the quantities that there are */
export function sums(all) {
  return COMPARED.flatMap((quantity) => {
    const told = all.filter((one) => !Number.isNaN(one[quantity]));
    if (told.length === 0) return [];
    const largest = told.reduce((most, one) => (Math.abs(one[quantity]) > Math.abs(most[quantity]) ? one : most));
    return [
      {
        quantity,
        count: told.length,
        rms: Math.sqrt(told.reduce((sum, one) => sum + one[quantity] ** 2, 0) / told.length),
        largest: largest[quantity],
        at: largest.n,
      },
    ];
  });
}
