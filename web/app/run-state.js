// The state of the run in words, beside the scene, at its controls and beside the verdict.

import { byId } from '../dom/elements.js';
import { updateAddressSoon } from './address-bar.js';
import { unplayed } from './queries.js';

/** @typedef {import('./page.js').Page} Page */

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
    controls.setSpeed(page.speed);
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
