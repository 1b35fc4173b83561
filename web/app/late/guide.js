// Requests to the table of a run under way: to catch its body, to throw it, to juggle it.

import { THROWN, contactDistance } from '../../physics/body.js';
import { changeRun } from './settings.js';

/** Time for which a throw out of a hold is waited for before the heights after it are sent, ms. */
const THROWN_MS = 50;

/** Sends what the table shall do. @param {Page} page @param {string} words that undo names @param {Parameters<Page['run']['send']>[0]} message @param {boolean} [byPanel] */
function guide(page, words, message, byPanel = false) {
  page.guidedByPanel = byPanel;
  page.act(words, message);
}

/** True from the news of a hold on: no news follows at the moment when it begins. @param {Page} page */
export const isHeld = ({ run }) => {
  const { scene, impacts, holds } = run;
  return run.active && scene !== null && Boolean(holds?.at(holds.until, impacts.last?.t ?? -Infinity, scene));
};

/** From the contact point to the centre of gravity, m. @param {Page} page */
export const lengthOf = ({ run, view }) => contactDistance(run.scene ?? view.drawn);

/** Catches the body from the next strike on. @param {Page} page @param {Record<string, string | number>} [settings] of a panel */
export const catchIt = (page, settings) => guide(page, 'the catch', { type: 'catch', ...settings }, Boolean(settings));

/** Throws the body, straight up to the usual height without an apex. @param {Page} page @param {{height: number, theta: number}} [apex] of a panel */
export const throwIt = (page, apex) =>
  guide(
    page,
    'the throw',
    { type: 'throw', apex: apex ?? { height: THROWN * lengthOf(page), theta: 0 } },
    Boolean(apex),
  );

/** @param {Page} page @param {number[]} heights one for each strike, in turn */
export function juggle(page, heights) {
  const held = isHeld(page);
  if (held) guide(page, 'the juggling', { type: 'throw', apex: { height: heights[0], theta: 0 } }, true);
  else page.history?.record('the juggling');
  // The settings go through the form, so that form and run agree.
  setTimeout(
    () => {
      page.put('table.energy_law', 'one_strike');
      page.put('table.program', heights);
      changeRun(page, 'table.program', true);
    },
    held ? THROWN_MS : 0,
  );
}
