// Runs the scene by itself when the page opens without a run in its address, unless that is unwanted.

import { byId } from '../dom/elements.js';
import { start } from './run-actions.js';
import { whenSeen } from './scenes.js';

/** @typedef {import('./page.js').Page} Page */

const STORED = 'equipoise.autorun';

/** A browser may refuse to store anything. */
function stored() {
  try {
    return localStorage.getItem(STORED) !== 'off';
  } catch {
    return true;
  }
}

/** True where scenes run without being asked to. */
export const runsByItself = () => stored() && !matchMedia('(prefers-reduced-motion: reduce)').matches;

/** @param {Page} page */
function runByItself(page) {
  if (!runsByItself()) return;
  whenSeen(() => {
    if (page.run.phase !== 'idle' || !page.complete || page.unknown !== null) return;
    start(page);
    page.byItself = true;
  });
}

/** @param {Page} page */
export function beginAutorun(page) {
  const on = byId('autorun-on', HTMLInputElement);
  on.checked = stored();
  on.addEventListener('change', () => {
    try {
      localStorage.setItem(STORED, on.checked ? 'on' : 'off');
    } catch {
      /* lasts for this visit only */
    }
  });
  page.opened = () => runByItself(page);
  page.opened();
}
