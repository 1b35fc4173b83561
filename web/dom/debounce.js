// Calls that wait for quiet, or keep a pace.

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

/**
 * Makes a call at most so often. The newest of those in between comes at the end, so that none is the last and lost.
 * @template {unknown[]} A
 * @param {number} pace_ms
 * @param {(...values: A) => void} run
 * @returns {(...values: A) => void}
 */
export function paced(pace_ms, run) {
  /** @type {number | undefined} */
  let timer;
  let due_ms = -Infinity;
  /** @type {A} */
  let newest;
  return (...values) => {
    newest = values;
    if (timer !== undefined) return;
    timer = setTimeout(() => {
      timer = undefined;
      due_ms = performance.now() + pace_ms;
      run(...newest);
    }, due_ms - performance.now());
  };
}
