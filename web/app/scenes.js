// Brings a scene to the page: a case, that of the address, or that of a panel; names it, and runs it by itself where that is wanted.

import { remembered } from '../api/remembered.js';
import { differences, setAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';
import { titlesOf } from '../api/settings.js';
import { byId, h } from '../dom/elements.js';
import { brokenLinkNotice } from '../dom/notices.js';
import { prose } from '../dom/typeset.js';
import STORIES from '../play/stories.json' with { type: 'json' };
import { interventionsOf } from '../run/interventions.js';
import { caseOf, sceneOf } from './link.js';

/** Text without subscripts, for an option or the window's title. @param {string} text */
export const plain = (text) => text.replaceAll('κ_', 'κ');

/** @param {Page} page @param {() => void} back returns to the case */
function nameScene({ typed = {}, chosen: one, fields, chooser }, back) {
  const other = one ? differences(fields, typed, one.scene) : [];
  const shows = byId('case-shows');
  chooser.value = one?.name ?? '';
  document.title = one ? `${plain(one.title)}${other.length > 0 ? ', changed' : ''} · equipoise` : 'equipoise';
  const changed = `Changed from the case: ${titlesOf(other, 3)}. `;
  const story = STORIES.find(({ preset }) => preset === one?.name);
  const words = other.length > 0 ? changed : (story?.caption ?? one?.shows ?? 'A scene of your own.');
  // A button that is being pressed has to stay.
  if (shows.dataset.words === words) return;
  shows.dataset.words = words;
  const button = h('button', { type: 'button', id: 'case-back', click: back }, 'Back to the case');
  shows.replaceChildren(...prose(words), one && other.length > 0 ? button : '');
}

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
  sceneChanged(page, true);
}

/** Shows another scene, at an address of its own. @param {Page} page @param {Scene} scene @param {Page['chosen']} chosen @param {string} words that undo names */
function bring(page, scene, chosen, words) {
  page.history?.record(words);
  page.chosen = chosen;
  page.pushAddress(sceneQuery(scene, chosen, page.fields));
  page.run.reset();
  present(page, scene);
}

/** Shows a case; runs it where a run was going on. @param {Page} page @param {Case} one */
export function choose(page, one) {
  const going = page.run.phase !== 'idle';
  const { byItself } = page;
  bring(page, one.scene, one, 'the choice of a case');
  if (going) page.start();
  page.byItself = byItself;
}

/** Releases the typed scene with these values in it; the way back leads to the run before. @param {Page} page @param {Record<string, number>} values */
export function launch(page, values) {
  page.history?.record('the release');
  page.updateAddress();
  history.pushState(null, '', location.href);
  for (const [path, value] of Object.entries(values)) page.put(path, value);
  page.run.reset();
  sceneChanged(page);
  page.start();
}

/** Shows and runs a scene from further below. @param {Page} page @param {Scene} scene @param {Iterable<[string, string]>} [deeds] to its run */
export function play(page, scene, deeds) {
  bring(page, scene, caseOf(scene, page.fields, page.cases), 'the release');
  page.start(deeds);
  scrollTo(0, 0);
}

/** Counts what is to be done: what waits for its turn is void when there is more. */
let turn = 0;

/** Shows the scene of an address, and joins its run. @param {Page} page @param {string} search */
export function restore(page, search) {
  const { fields, cases, run } = page;
  const { link, chosen, scene, query } = sceneOf(search, fields, cases);
  page.chosen = chosen;
  page.speed = link.speed;
  run.reset();
  page.panelLink = link.panels;
  page.panels?.restore(link.panels);
  brokenLinkNotice('link', link.dropped);
  page.byItself = false;
  turn += 1;
  if (!link.run) {
    present(page, scene);
    page.unknown = link.unknown;
    return runByItself(page);
  }
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
function whenSeen(act) {
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

/** Brings back an earlier state. A run that goes on is replayed at the place where it is. @param {Page} page @param {PageState} state */
export function restoreState(page, { scene, releasedAs, chosen, run: wanted }) {
  const { run } = page;
  const before = run.phase === 'idle' ? null : run.query;
  page.chosen = chosen;
  present(page, scene);
  page.releasedAs = releasedAs;
  if (wanted === null) {
    if (before) run.reset();
    return;
  }
  const query = new URLSearchParams(wanted);
  if (before?.get('epoch_ms') !== query.get('epoch_ms')) return run.start(query);
  const clock = (/** @type {[string, string]} */ [key]) => key.startsWith('clock.');
  const own = [...query].filter((entry) => !clock(entry));
  // The same run goes on.
  if (String(own) === String([...(before ?? [])].filter((entry) => !clock(entry)))) return;
  run.start(new URLSearchParams([...own, ...[...(before ?? [])].filter(clock)]));
}

export const AUTORUN = 'equipoise.autorun';

/** True where scenes run without being asked to. */
export const runsByItself = () => remembered(AUTORUN, true) && !matchMedia('(prefers-reduced-motion: reduce)').matches;

/** @param {Page} page */
function runByItself(page) {
  if (!runsByItself()) return;
  whenSeen(() => {
    if (page.run.phase !== 'idle' || !page.complete || page.unknown !== null) return;
    page.start();
    page.byItself = true;
  });
}
