// The state of the run in words, beside the scene and at its controls.

import { byId } from '../dom/elements.js';
import { capitalized, prose } from '../dom/typeset.js';
import { updateAddressSoon } from './address-bar.js';
import { unplayed } from './queries.js';

/** @param {import('./page.js').Page} page */
export function showRun(page) {
  const { run, controls } = page;
  const { phase, outcome, impacts } = run;
  const words = run.words || 'Ready';
  const state = byId('run-state');
  if (state.textContent !== words) state.textContent = words;
  state.dataset.phase = phase;
  const ending = byId('outcome');
  ending.hidden = phase !== 'ended' && impacts.missing === 0;
  ending.replaceChildren(
    ...(phase === 'ended'
      ? prose(capitalized(outcome?.detail ?? ''))
      : [`${impacts.missing} impacts were skipped over.`]),
  );
  controls.show(phase, phase !== 'idle' && unplayed(page).length > 0, page.typed !== undefined);
  if (run.active) {
    page.speed = run.clock.speed || page.speed;
    controls.setSpeed(page.speed);
    updateAddressSoon(page);
  }
  page.view.redraw();
}
