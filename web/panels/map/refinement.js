// Asks for a map from coarse to fine, each pass drawn as it streams, and keeps the answers.

import { Grid } from './grid.js';
import { Problem, get, problemOf } from '../../api/client.js';
import { bouncesOf, outlineQuery, passesOf, requestQuery, rowsOf } from './settings.js';
import { lines } from '../../api/answers.js';

/** @typedef {import('./settings.js').Settings} Settings */

/** A pass of more bounces than this waits until somebody asks for it: about a second of one core. */
const UNASKED_BOUNCES = 1e8;
/** Answers kept, to go back without asking again: eight maps with their passes. */
const KEPT = 24;
/** @type {Map<string, Grid>} */
const known = new Map();

/**
 * Asks for a map, finer and finer.
 * @param {Settings} settings
 * @param {URLSearchParams} scene
 * @param {object} how
 * @param {AbortSignal} how.signal
 * @param {boolean} how.unasked true when nobody has pressed a button for it
 * @param {(progress: {done: number, of: number, columns: number}) => void} how.heard rows of a pass
 * @param {(grid: Grid, request: URLSearchParams) => void} how.show a pass has its first rows, or all
 * @returns {Promise<{grid: Grid | null, refused: Problem | null, waits: Settings | null}>} as fine as wanted, or as the server allows; or up to a pass that waits for somebody to ask for it
 */
export async function refine(settings, scene, { signal, unasked, heard, show }) {
  const passes = passesOf(settings.columns).map((columns) => ({ ...settings, columns }));
  /** @type {Grid | null} */
  let grid = null;
  /** @type {Problem | null} */
  let refused = null;
  /** @type {any} */
  let outline = null;
  // What is kept needs no coarser one before it.
  const from = passes.findLastIndex((pass) => known.has(String(requestQuery(pass, scene))));
  for (let index = Math.max(0, from); index < passes.length && !signal.aborted; index += 1) {
    const pass = passes[index];
    const request = requestQuery(pass, scene);
    const kept = known.get(String(request));
    if (kept) {
      grid = kept;
      heard(kept.progress);
      show(kept, request);
      continue;
    }
    if (unasked && bouncesOf(pass) > UNASKED_BOUNCES) return { grid, refused, waits: pass };
    heard({ done: 0, of: rowsOf(pass.columns), columns: pass.columns });
    try {
      outline ??= await get(`v1/regions?${outlineQuery(request)}`, signal);
      const next = new Grid(pass, outline, grid);
      // The cells of before stay until there are new ones.
      let shown = false;
      await fill(next, request, signal, () => {
        heard(next.progress);
        if (!shown) show(next, request);
        shown = true;
      });
      grid = next;
    } catch (error) {
      if (!grid || !(error instanceof Problem) || error.status !== 422) throw error;
      // Its price is too high; one of half as many columns may do.
      refused = error;
      const columns = pass.columns / 2;
      if (columns > grid.columns) passes.splice(index + 1, Infinity, { ...pass, columns });
      else passes.length = index;
    }
  }
  return { grid, refused, waits: null };
}

/** @param {Grid} grid @param {URLSearchParams} request @param {AbortSignal} signal @param {() => void} grown */
async function fill(grid, request, signal, grown) {
  const response = await fetch(`v1/regions?${request}&format=ndjson`, { signal });
  if (!response.ok || !response.body) throw await problemOf(response);
  for await (const line of lines(response.body)) {
    if (signal.aborted) return;
    grid.take(line);
    if (!grid.isFiner) grid.judge();
    grown();
  }
  if (!grid.counts) throw new Problem('', 'The answer was cut off.', [], 0);
  known.set(String(request), grid);
  for (const key of known.keys()) if (known.size > KEPT) known.delete(key);
}
