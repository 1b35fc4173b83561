// Asks for a map from coarse to fine, each pass drawn as it streams, and keeps the answers.

import { Grid } from './grid.js';
import { Problem, get, problemOf } from '../../api/client.js';
import { bouncesOf, outlineQuery, passesOf, requestQuery, rowsOf } from './settings.js';
import { lines } from '../../api/answers.js';

/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {{arrived: number, rows: number, columns: number}} Progress of a pass, in rows */
/** @typedef {{grid: Grid, request: URLSearchParams}} Pass */

/**
 * @typedef {object} Watcher
 * @property {(pass: Pass) => void} show a pass that has its first rows, or all
 * @property {() => void} row more rows of it
 * @property {(progress: Progress | null) => void} busy null when no answer is awaited
 * @property {(grid: Grid, refused: Problem | null) => void} whole as fine as wanted, or as the server allows
 * @property {(settings: Settings) => void} waits for somebody to ask for this pass
 * @property {(error: unknown, progress: Progress) => void} failed
 * @property {() => boolean} wanted false while nobody sees the map
 */

/** A pass of more bounces than this waits until somebody asks for it: about a second of one core. */
const UNASKED_BOUNCES = 1e8;
/** Answers kept, to go back without asking again: eight maps with their passes. */
const KEPT = 24;

/** @param {Settings} pass @returns {Progress} */
const progressOf = ({ columns }) => ({ arrived: 0, rows: rowsOf(columns), columns });

export class Refinement {
  #watcher;
  /** @type {Map<string, Grid>} */
  #kept = new Map();
  /** @type {AbortController | null} */
  #asking = null;

  /** @param {Watcher} watcher */
  constructor(watcher) {
    this.#watcher = watcher;
  }

  get active() {
    return this.#asking !== null;
  }

  cancel() {
    if (!this.#asking) return;
    this.#asking.abort();
    this.#asking = null;
    this.#watcher.busy(null);
  }

  /**
   * Shows a map, finer and finer.
   * @param {Settings} settings
   * @param {URLSearchParams} scene
   * @param {boolean} unasked true when nobody has pressed a button for it
   * @returns {Promise<boolean>} false when it was left because nobody sees it
   */
  async ask(settings, scene, unasked) {
    this.cancel();
    const asking = new AbortController();
    this.#asking = asking;
    const passes = passesOf(settings.columns).map((columns) => ({ ...settings, columns }));
    const progress = progressOf(passes[0]);
    try {
      return await this.#passes(passes, scene, unasked, asking.signal, progress);
    } catch (error) {
      if (!asking.signal.aborted) this.#watcher.failed(error, progress);
      return true;
    } finally {
      if (this.#asking === asking) {
        this.#asking = null;
        this.#watcher.busy(null);
      }
    }
  }

  /**
   * @param {Settings[]} passes
   * @param {URLSearchParams} scene
   * @param {boolean} unasked
   * @param {AbortSignal} signal
   * @param {Progress} progress
   */
  async #passes(passes, scene, unasked, signal, progress) {
    /** @type {Grid | null} */
    let whole = null;
    /** @type {Problem | null} */
    let refused = null;
    /** @type {any} */
    let outline = null;
    // What is kept needs no coarser one before it.
    const from = passes.findLastIndex((pass) => this.#kept.has(String(requestQuery(pass, scene))));
    for (let index = Math.max(0, from); index < passes.length; index += 1) {
      const pass = passes[index];
      const request = requestQuery(pass, scene);
      const kept = this.#kept.get(String(request));
      if (kept) {
        whole = kept;
        this.#watcher.show({ grid: kept, request });
        continue;
      }
      if (whole && !this.#watcher.wanted()) return false;
      if (unasked && bouncesOf(pass) > UNASKED_BOUNCES) {
        this.#watcher.waits(pass);
        return true;
      }
      Object.assign(progress, progressOf(pass));
      this.#watcher.busy(progress);
      try {
        outline ??= await get(`v1/regions?${outlineQuery(request)}`, signal);
        whole = await this.#pass(new Grid(pass, outline, whole), request, signal, progress);
        if (signal.aborted) return true;
      } catch (error) {
        if (!whole || !(error instanceof Problem) || error.status !== 422) throw error;
        // Its price is too high; one of half as many columns may do.
        refused = error;
        const columns = pass.columns / 2;
        if (columns > whole.columns) passes.splice(index + 1, Infinity, { ...pass, columns });
        else passes.length = index;
      }
    }
    if (whole) this.#watcher.whole(whole, refused);
    return true;
  }

  /**
   * @param {Grid} grid
   * @param {URLSearchParams} request
   * @param {AbortSignal} signal
   * @param {Progress} progress
   */
  async #pass(grid, request, signal, progress) {
    const response = await fetch(`v1/regions?${request}&format=ndjson`, { signal });
    if (!response.ok || !response.body) throw await problemOf(response);
    let shown = false;
    for await (const line of lines(response.body)) {
      if (signal.aborted) return grid;
      grid.take(line);
      progress.arrived = grid.arrived;
      if (!grid.isFiner) grid.judge();
      // The cells of before stay until there are new ones.
      if (!shown) this.#watcher.show({ grid, request });
      shown = true;
      this.#watcher.row();
    }
    if (!grid.counts) throw new Problem('', 'The answer was cut off.', [], 0);
    this.#kept.set(String(request), grid);
    for (const key of this.#kept.keys()) if (this.#kept.size > KEPT) this.#kept.delete(key);
    return grid;
  }
}
