// Reacts to an edit of the form or of a slider beside the scene.

import { valueAt } from '../../api/scene-fields.js';
import { updateAddressSoon } from '../address-bar.js';
import { GAIN } from '../page.js';
import { sendChanges } from '../run-actions.js';
import { showRun } from '../run-state.js';
import { sceneChanged } from '../scenes.js';

/**
 * @param {import('../page.js').Page} page
 * @param {string} path of the field
 * @param {boolean} final true when a slider was let go or a text was left
 */
export function edited(page, path, final) {
  const { run, controls, fields } = page;
  const value = valueAt(page.typed ?? {}, path);
  if (path === GAIN && typeof value === 'number') controls.setGain(value);
  if (final && run.active && fields.find((field) => field.field === path)?.live) sendChanges(page);
  sceneChanged(page);
  if (run.phase === 'idle') updateAddressSoon(page);
  else showRun(page);
}
