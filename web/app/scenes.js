// Brings a scene to the page: a case, that of the address, or that of a panel.

import { setAt } from '../api/scene-fields.js';
import { merged, sceneQuery } from '../api/scene-query.js';
import { brokenLinkNotice, clearNotice } from '../dom/notices.js';
import { interventionsOf } from '../run/interventions.js';
import { pushAddress, updateAddress } from './address-bar.js';
import { readLink } from './link.js';
import { start } from './run-actions.js';
import { caseOf, nameScene } from './typed/scene-name.js';

/** @typedef {import('./page.js').Page} Page */
/** @typedef {import('./page.js').Scene} Scene */

/** Tells all parts of the page that the typed scene is another one. @param {Page} page @param {boolean} [another] answers on the scene before are void */
export function sceneChanged(page, another = false) {
  page.unknown = null;
  nameScene(page, () => {
    if (page.chosen) choose(page, page.chosen);
  });
  page.form?.compare(page.chosen?.scene ?? null);
  page.view.draft(page.typed ?? {}, page.chosen?.derived);
  for (const plot of page.plots) plot.redraw();
  page.panels?.sceneChanged();
  page.follow(another);
}

/** Shows a scene without running it. @param {Page} page @param {Scene} scene */
export function present(page, scene) {
  page.fill(scene);
  page.controls.setSpeed(page.speed);
  sceneChanged(page, true);
}

/** Shows a case; runs it where a run was going on. @param {Page} page @param {import('contract').Preset} one */
export function choose(page, one) {
  const { run } = page;
  const going = run.phase !== 'idle';
  const { byItself } = page;
  page.history?.record('the choice of a case');
  page.chosen = one;
  pushAddress(page, [['preset', one.name]]);
  run.reset();
  present(page, one.scene);
  if (going) start(page);
  page.byItself = byItself;
}

/** Releases the typed scene with these values in it; the way back leads to the run before. @param {Page} page @param {Record<string, number>} values */
export function launch(page, values) {
  page.history?.record('the release');
  updateAddress(page);
  history.pushState(null, '', location.href);
  for (const [path, value] of Object.entries(values)) page.put(path, value);
  page.run.reset();
  sceneChanged(page);
  start(page);
}

/** Shows and runs a scene from further below. @param {Page} page @param {Scene} scene @param {string} [words] what undo names */
export function play(page, scene, words = 'the release') {
  page.history?.record(words);
  page.chosen = caseOf(page, scene);
  pushAddress(page, sceneQuery(scene, page.chosen, page.fields));
  page.run.reset();
  present(page, scene);
  start(page);
  scrollTo(0, 0);
}

/** Counts what is to be done: what waits for its turn is void when there is more. */
let turn = 0;

/** Shows the scene of an address, and joins its run. @param {Page} page @param {string} search */
export function restore(page, search) {
  const { fields, cases, run } = page;
  const link = readLink(search, fields, cases);
  const bare = link.preset === null && Object.keys(link.changes).length === 0;
  page.chosen = cases.find((one) => one.name === (bare ? cases[0]?.name : link.preset)) ?? caseOf(page, link.changes);
  page.speed = link.speed;
  run.reset();
  page.panelLink = link.panels;
  page.panels?.restore(link.panels);
  if (link.dropped.length > 0) brokenLinkNotice('link', link.dropped);
  else clearNotice('link');
  const scene = merged(page.chosen?.scene ?? {}, link.changes);
  page.byItself = false;
  turn += 1;
  if (!link.run) {
    present(page, scene);
    page.unknown = link.unknown;
    return page.opened();
  }
  const query = sceneQuery(scene, page.chosen, fields);
  for (const [key, value] of link.run) query.set(key, value);
  query.set('speed', String(page.speed));
  for (const { set } of interventionsOf(link.run)) {
    for (const [path, value] of Object.entries(set)) setAt(scene, path, value);
  }
  present(page, scene);
  page.releasedAs = page.typed ?? {};
  if (link.run.has('epoch_ms')) run.start(query);
  else whenSeen(() => run.start(query));
}

/** Acts now, or once a hidden tab is looked at, if nothing else is to be done by then. @param {() => void} act */
export function whenSeen(act) {
  turn += 1;
  const mine = turn;
  if (!document.hidden) return act();
  document.addEventListener(
    'visibilitychange',
    () => {
      if (mine === turn) act();
    },
    { once: true },
  );
}

/** Brings back an earlier state. A run that goes on is replayed at the place where it is. @param {Page} page @param {import('./page.js').State} state */
export function restoreState(page, { scene, releasedAs, chosen, run: wanted }) {
  const { run } = page;
  const before = run.phase === 'idle' ? null : new URLSearchParams(run.query);
  page.chosen = chosen;
  present(page, scene);
  page.releasedAs = releasedAs;
  if (wanted === null) {
    if (before) run.reset();
    return;
  }
  const query = new URLSearchParams(wanted);
  if (before && before.get('epoch_ms') === query.get('epoch_ms')) {
    const own = (/** @type {URLSearchParams} */ params) => [...params].filter(([key]) => !key.startsWith('clock.'));
    if (String(own(before)) === String(own(query))) return;
    for (const key of [...query.keys()]) if (key.startsWith('clock.')) query.delete(key);
    for (const [key, value] of before) if (key.startsWith('clock.')) query.set(key, value);
  }
  run.start(query);
}
