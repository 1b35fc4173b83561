// Requests to the table of a run under way: to catch its body, to throw it, to juggle it.

import { THROWN, contactDistance } from '../../physics/body.js';
import { changeRun } from './settings.js';

/** @typedef {import('../page.js').Page} Page */

/** Time for which a throw out of a hold is waited for before the heights after it are sent, ms. */
const THROWN_MS = 50;

/** Sends what the table shall do; an undo takes it back. @param {Page} page @param {string} words for it @param {Page['lastSent']} sent @param {() => void} send */
function guide(page, words, sent, send) {
  page.lastSent = sent;
  page.history?.record(words);
  page.timeline?.toNow();
  send();
}

/** Catches the body from the next strike on. @param {Page} page @param {Record<string, string | number>} settings @param {Page['lastSent']} sent */
export const catchIt = (page, settings, sent) => guide(page, 'the catch', sent, () => page.run.catchIt(settings));

/** True from the news of a hold on: no news follows at the moment when it begins. @param {Page} page */
const isHeld = ({ run }) => {
  const { scene, impacts, holds } = run;
  return run.active && scene !== null && Boolean(holds?.at(holds.until, impacts.last?.t ?? -Infinity, scene));
};

/** @param {Page} page @param {{height: number, theta: number}} apex @param {string} words */
const throwIt = (page, apex, words) => guide(page, words, 'guide', () => page.run.throwIt(apex));

/** A throw straight up, to the usual height. @param {Page} page */
export const throwUp = (page) =>
  throwIt(page, { height: THROWN * contactDistance(page.run.scene ?? page.view.drawn), theta: 0 }, 'the throw');

/** @param {Page} page @param {number[]} heights one for each strike, in turn */
function juggle(page, heights) {
  const held = isHeld(page);
  if (held) throwIt(page, { height: heights[0], theta: 0 }, 'the juggling');
  else page.history?.record('the juggling');
  // What is set goes through the form, so that form and run agree.
  setTimeout(
    () => {
      page.put('table.energy_law', 'one_strike');
      page.put('table.program', heights);
      changeRun(page, 'table.program', true);
    },
    held ? THROWN_MS : 0,
  );
}

/** @param {Page} page @returns {import('../../panels/card.js').Guide} */
export const guideOf = (page) => ({
  live: () => page.run.active,
  held: () => isHeld(page),
  length: () => contactDistance(page.run.scene ?? page.view.drawn),
  watch: ({ changed, problem }) => {
    page.run.watch({ changed, struck: changed, cleared: () => {} });
    const { watcher } = page.run;
    page.run.watcher = {
      ...watcher,
      problem: (told) => {
        if (page.lastSent === 'guide') problem(told);
        else watcher.problem(told);
      },
    };
  },
  catchIt: (settings) => catchIt(page, settings, 'guide'),
  throwIt: (apex) => throwIt(page, apex, 'the throw'),
  juggle: (heights) => juggle(page, heights),
});
