// Steps of keys through the items of a chart.

/** Items that keys go in a row of many. @type {Record<string, number | undefined>} */
export const KEY_STEPS = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: 10,
  PageDown: -10,
  Home: -Infinity,
  End: Infinity,
};

/**
 * The item that a key leads to among items in a row, if there are any: arrows go one on, page up and page down a tenth.
 * @param {string} key
 * @param {number | null} at
 * @param {number} count
 * @returns {number | null | undefined}
 */
export function movedInRow(key, at, count) {
  const tenth = Math.max(1, Math.round(count / 10));
  const by = (/** @type {number} */ step) => Math.max(0, Math.min(count - 1, (at ?? (step > 0 ? -1 : count)) + step));
  const to = {
    ArrowRight: by(1),
    ArrowLeft: by(-1),
    PageUp: by(tenth),
    PageDown: by(-tenth),
    Home: 0,
    End: count - 1,
    Escape: null,
  };
  return count > 0 ? to[/** @type {keyof typeof to} */ (key)] : undefined;
}
