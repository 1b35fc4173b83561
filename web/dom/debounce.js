// Waits for quiet before a call.

/**
 * Makes only the last of several calls, once there was none for so long.
 * @template {unknown[]} A
 * @param {number} quiet_ms
 * @param {(...values: A) => void} run
 * @returns {(...values: A) => void}
 */
export function debounce(quiet_ms, run) {
  /** @type {number | undefined} */
  let timer;
  return (...values) => {
    clearTimeout(timer);
    timer = setTimeout(() => run(...values), quiet_ms);
  };
}
