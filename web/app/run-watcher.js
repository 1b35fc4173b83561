// Reacts to news of the run: impacts, a lost connection.

import { invalidate } from '../charts/surface.js';
import { connectionNotice } from '../dom/notices.js';
import { sendChanges } from './run-actions.js';
import { showRun, showThisRun } from './run-state.js';

/** @typedef {import('./page.js').Page} Page */

/** Loads the words for refusals, which come after the first plot. */
const problems = () => import('./late/run-problems.js');

/** @param {Page} page @returns {import('../run/run-state.js').Watcher} */
export const watcherOf = (page) => ({
  changed: () => {
    if (page.away && page.run.phase === 'idle') {
      page.away = false;
      connectionNotice(NaN, () => {});
    }
    showRun(page);
  },
  struck: () => {
    for (const plot of page.plots) invalidate(plot);
    page.interaction?.struck();
    page.view.redraw();
    showThisRun(page);
  },
  cleared: () => {
    for (const plot of page.plots) plot.clear();
    page.interaction?.cleared();
    page.view.reset();
  },
  lost: (seconds) => {
    connectionNotice(seconds, () => page.run.retry());
    const away = !Number.isNaN(seconds);
    if (away === page.away) return;
    page.away = away;
    // There is no verdict while the server is away.
    page.follow(true);
    if (!away) sendChanges(page);
  },
  refused: (problem) => void problems().then(({ refused }) => refused(page, problem)),
  problem: (message) => void problems().then(({ tell }) => tell(page, message)),
});
