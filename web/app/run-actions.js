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
  page.lastSent = 'other';
  performance.mark('run asked for');
  run.start(query);
}

/** @param {Page} page */
export function toggle(page) {
  const { run } = page;
  if (page.timeline?.toggle()) return;
  page.lastSent = 'other';
  if (run.phase === 'idle' || run.phase === 'ended') {
    page.history?.record('the release');
    start(page);
  } else if (run.active) run.toggle();
}

/** @param {Page} page */
export function step(page) {
  if (page.timeline?.step(1)) return;
  page.lastSent = 'other';
  page.run.step();
}

/** From the release again, with what is typed now. @param {Page} page */
export function restart(page) {
  const { run } = page;
  page.lastSent = 'other';
  if (run.phase === 'idle') return;
  page.history?.record('the restart');
  page.timeline?.toNow();
  if (!run.active || unplayed(page).length > 0) start(page);
  else run.restart();
}

/** @param {Page} page @param {Record<string, number>} velocities */
export function kick(page, velocities) {
  page.lastSent = 'kick';
  page.history?.record('the kick');
  page.timeline?.toNow();
  page.run.kick(velocities);
}

/** @param {Page} page @param {number} value */
export function setSpeed(page, value) {
  const { run } = page;
  page.speed = value;
  page.controls.setSpeed(value);
  page.lastSent = 'other';
  if (run.active) run.setSpeed(value);
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
  page.lastSent = 'set';
  run.set(changes);
});

/** True while the typed scene is its case. @param {Page} page */
export const unchanged = ({ chosen, typed = {}, fields }) =>
  chosen !== null && differences(fields, typed, chosen.scene).length === 0;
