// The actions on the run, for the controls and the keys.

import { differences, playedAt } from '../api/scene-fields.js';
import { debounce } from '../dom/debounce.js';
import { clearNotice } from '../dom/notices.js';
import { typedQuery, unplayed, updateAddressSoon } from './address-bar.js';

/** @typedef {import('./page.js').Page} Page */

/** Releases the typed scene. @param {Page} page @param {Record<string, string>} [deeds] what is done to its run */
export function start(page, deeds = {}) {
  const { run } = page;
  const query = typedQuery(page);
  if (!query) return page.showFault();
  query.set('speed', String(page.speed));
  for (const [key, value] of Object.entries(deeds)) query.set(key, value);
  page.releasedAs = page.typed ?? {};
  page.byItself = false;
  clearNotice('run');
  performance.mark('run asked for');
  run.start(query);
}

/** @param {Page} page */
export function toggle(page) {
  const { run } = page;
  if (page.timeline?.toggle()) return;
  if (run.phase === 'idle' || run.phase === 'ended') {
    page.history?.record('the release');
    start(page);
  } else if (run.active) run.send({ type: run.clock.paused ? 'resume' : 'pause' });
}

/** @param {Page} page */
export function step(page) {
  if (page.timeline?.step(1)) return;
  // Only a run that stands still can step.
  if (!page.run.clock.paused) page.run.send({ type: 'pause' });
  page.run.send({ type: 'step' });
}

/** From the release again, with what is typed now. @param {Page} page */
export function restart(page) {
  const { run } = page;
  if (run.phase === 'idle') return;
  page.history?.record('the restart');
  page.timeline?.toNow();
  if (!run.active || unplayed(page).length > 0) start(page);
  else run.send({ type: 'restart' });
}

/** Does something to the run. @param {Page} page @param {string} words that undo names @param {Parameters<Page['run']['send']>[0]} message */
export function act(page, words, message) {
  page.history?.record(words);
  page.timeline?.toNow();
  page.run.send(message);
}

/** @param {Page} page @param {number} value */
export function setSpeed(page, value) {
  const { run } = page;
  page.speed = value;
  if (run.active) run.send({ type: 'speed', value });
  else updateAddressSoon(page);
}

/** Sends the live parameters that the run does not play yet; some make sense only together. */
export const sendChanges = debounce(100, (/** @type {Page} */ page) => {
  const { run, typed } = page;
  if (!typed || !run.active) return;
  // Another kind of control law is no change of a value: it needs a restart.
  const swapped = Boolean(typed.table?.feedback) !== Boolean(run.asked?.table?.feedback);
  const changes = Object.fromEntries(
    unplayed(page)
      .filter(({ live, field }) => live && !(swapped && /^table\.(tilt_gain$|feedback)/.test(field)))
      .map((field) => [field.field, playedAt(typed, field)])
      .filter(([, value]) => value !== undefined),
  );
  if (Object.keys(changes).length === 0) return;
  run.send({ type: 'set', ...changes });
});

/** True while the typed scene is its case. @param {Page} page */
export const unchanged = ({ chosen, typed = {}, fields }) =>
  chosen !== null && differences(fields, typed, chosen.scene).length === 0;
