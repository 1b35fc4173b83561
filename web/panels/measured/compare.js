// Measured less simulated, impact by impact.

import { COMPARED } from './quantities.js';

/** @typedef {import('./quantities.js').Compared} Compared */
/** @typedef {import('./match.js').Match} Match */
/** @typedef {import('./match.js').Simulated} Simulated */
/** @typedef {import('./read.js').Measured} Measured */

/** @typedef {Record<'n' | Compared, number>} Residual in SI units; NaN where one of the two is not there */
/** @typedef {{quantity: Compared, count: number, rms: number, largest: number, at: number}} Sum the largest with its sign, at the impact of that number */

/**
 * The residuals of the pairs. That of the time is what the offset of the measured clock leaves.
 * @param {Measured[]} measured
 * @param {Simulated} simulated
 * @param {Match} match
 * @returns {Residual[]}
 */
export const residuals = (measured, simulated, { pairs, offset }) =>
  pairs.map(([row, place]) => {
    const off = COMPARED.map((quantity) => [quantity, measured[row][quantity] - simulated[quantity][place]]);
    const residual = /** @type {Residual} */ ({ n: simulated.n[place], ...Object.fromEntries(off) });
    return { ...residual, t: residual.t - offset };
  });

/**
 * The numbers of all measured impacts in the run. Those without a pair go on from the impact before them as in the file, extra ones by
 * halves.
 * @param {Measured[]} measured
 * @param {Simulated | null} simulated
 * @param {Match | null} match
 * @param {number} first number of the first one, where nothing is matched
 */
export function numbersOf(measured, simulated, match, first) {
  const known = new Map(match?.pairs.map(([row, place]) => [row, simulated?.n[place] ?? NaN]));
  const extra = new Set(match?.extra);
  const [row, number] = [...known][0] ?? [0, first];
  let n = number - (measured[row].n - measured[0].n);
  return measured.map((one, index) => {
    if (extra.has(index)) return n + 0.5;
    n = known.get(index) ?? n + (index > 0 ? one.n - measured[index - 1].n : 0);
    return n;
  });
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
