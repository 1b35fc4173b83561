// Reacts to news of the run: its state in words, beside the scene, at its controls and beside the verdict; impacts; a lost connection.

import { byId } from '../dom/elements.js';
import { connectionNotice } from '../dom/notices.js';
import { unplayed, updateAddressSoon } from './address-bar.js';
import { sendChanges } from './run-actions.js';

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
    page.view.redraw();
    showThisRun(page);
  },
  cleared: () => page.view.reset(),
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

/** @param {Page} page */
export function showRun(page) {
  const { run, controls } = page;
  const { phase } = run;
  if (phase !== 'ended') tell(run.words || 'Ready');
  Object.assign(byId('run-state').dataset, { phase, fate: run.fate });
  showThisRun(page);
  controls.show(phase, phase !== 'idle' && unplayed(page).length > 0, page.typed !== undefined);
  if (run.active) {
    page.speed = run.clock.speed || page.speed;
    updateAddressSoon(page);
  }
  page.view.redraw();
}

/** @param {string} words */
function tell(words) {
  const state = byId('run-state');
  if (state.textContent !== words) state.textContent = words;
}

/** The line on the run; its code comes with the first run. @param {Page} page */
export function showThisRun(page) {
  const { run, thisRun } = page;
  if (thisRun) {
    const [fact, after] = thisRun.show(run, page.fields);
    if (run.phase === 'ended') tell(fact + after);
    page.verdict?.ended(run.phase === 'ended' ? run.fate : null, fact);
  } else if (run.phase !== 'idle') void bringThisRun(page);
}

/** @param {Page} page */
async function bringThisRun(page) {
  const { ThisRun } = await import('../panels/verdict/this-run.js');
  page.thisRun ??= new ThisRun(byId('this-run'));
  showThisRun(page);
}
