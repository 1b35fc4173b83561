// Reacts to an edit of the form: drops the body anew, or changes the run under way.

import { updateAddressSoon } from '../address-bar.js';
import { dropEdited } from '../../play/drop.js';
import { sendChanges } from '../run-actions.js';
import { showRun } from '../run-state.js';
import { sceneChanged } from '../scenes.js';

/**
 * @param {import('../page.js').Page} page
 * @param {string} path of the field
 * @param {boolean} final true when a slider was let go or a text was left
 */
export function edited(page, path, final) {
  if (page.anew) dropEdited(page, final);
  else changeRun(page, path, final);
}

/** Changes the run under way, where its table can. @param {import('../page.js').Page} page @param {string} path @param {boolean} final */
export function changeRun(page, path, final) {
  const { run, fields } = page;
  if (final && run.active && fields.find((field) => field.field === path)?.live) sendChanges(page);
  sceneChanged(page);
  if (run.phase === 'idle') updateAddressSoon(page);
  else showRun(page);
}
