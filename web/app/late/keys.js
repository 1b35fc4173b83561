// Single keys for the run. They can be turned off for people whose tools send letters.

import { remember, remembered } from '../../api/remembered.js';
import { TYPED_IN, byId, h, pressedIn } from '../../dom/elements.js';
import STORIES from '../../play/stories.json' with { type: 'json' };
import { tell } from '../../play/tell.js';
import { FASTEST, SLOWEST } from '../../run/interventions.js';
import { AUTORUN } from '../scenes.js';
import { saveCsv } from './share.js';

/** The keys, their label, their name, and the action. @typedef {[keys: string, label: string, name: string, act: (key: string) => void]} Key */

const STORED = 'equipoise.keys';
/** The speeds that `[` and `]` go through. */
const SPEEDS = [SLOWEST, 0.1, 0.2, 0.5, 1, 2, 5, 10, FASTEST];

/** Focuses the picture of the map, once it has loaded. */
function focusMap() {
  const body = byId('map-body');
  const picture = /** @type {HTMLElement | null} */ (body.querySelector('[role=application]'));
  if (picture) picture.focus({ preventScroll: true });
  else if (body.checkVisibility()) requestAnimationFrame(focusMap);
}

/** @param {Page} page */
function showMap(page) {
  /** @type {HTMLDialogElement | null} */ (document.querySelector('dialog.large'))?.close();
  page.panels?.show('map');
  focusMap();
}

/** @param {Page} page @param {string} key */
function changeSpeed(page, key) {
  const { speed } = page;
  const next = key === '[' ? SPEEDS.findLast((one) => one < speed) : SPEEDS.find((one) => one > speed);
  page.setSpeed(next ?? speed);
}

/** @param {Page} page @returns {Key[]} */
const keysOf = (page) => [
  [' ', 'Space', 'Run, pause, resume', () => page.toggle()],
  ['.', '.', 'Stop at the next strike', () => void ((page.run.active || page.run.past !== null) && page.step())],
  [',', ',', 'Back to the strike before', () => void page.timeline?.step(-1)],
  ['a', 'a', 'Pin this run as a reference', () => page.pins?.pin()],
  ['n', 'n', 'Back to now', () => page.timeline?.toNow()],
  ['r', 'r', 'Restart from the release', () => page.restart()],
  ['k', 'k', 'Kick', () => void (page.run.active && page.sliders?.kick())],
  ['12345', '1 – 5', 'The stories; in a lecture ← and → as well', (key) => tell(page, STORIES[Number(key) - 1])],
  ['[]', '[ ]', 'Slower, faster', (key) => changeSpeed(page, key)],
  ['m', 'm', 'Go to the stability map', () => showMap(page)],
  ['p', 'p', 'Present: scene, map and verdict, large', () => byId('present').click()],
  // Undo listens by itself, since it works while single keys are off.
  ['', 'Ctrl Z', 'Undo; with Shift redo', () => {}],
  ['l', 'l', 'Show the symbols in the scene', () => byId('symbols').click()],
  ['s', 's', 'Copy the link', () => byId('share').click()],
  ['e', 'e', 'Save the bounces as CSV', () => saveCsv(page)],
  ['?', '?', 'Show these keys', () => byId('keys', HTMLDialogElement).showModal()],
];

/** A box that stays as it is in later visits. @param {string} id @param {string} stored */
function keptBox(id, stored) {
  const box = byId(id, HTMLInputElement);
  box.checked = remembered(stored, true);
  box.addEventListener('change', () => remember(stored, box.checked));
  return box;
}

/** @param {Page} page */
export function listenToKeys(page) {
  const dialog = byId('keys', HTMLDialogElement);
  const on = keptBox('keys-on', STORED);
  keptBox('autorun-on', AUTORUN);
  const all = keysOf(page);
  byId('keys-list').append(
    ...all.map(([, label, name]) => h('div', {}, h('dt', {}, h('kbd', {}, label)), h('dd', {}, name))),
  );
  byId('keys-open').addEventListener('click', () => dialog.showModal());
  addEventListener('keydown', (event) => {
    const { key, defaultPrevented, repeat, ctrlKey, metaKey, altKey } = event;
    if (!on.checked || defaultPrevented || repeat || ctrlKey || metaKey || altKey) return;
    // Letters belong to where one types, and Space to whatever it presses.
    if (document.querySelector('dialog[open]:not(.large)') || pressedIn(event, `select, ${TYPED_IN}`)) return;
    if (key === ' ' && pressedIn(event, 'button, a, summary, input, [tabindex]:not(dialog)')) return;
    const [, , , act] = all.find(([keys]) => keys.includes(key)) ?? [];
    if (!act) return;
    event.preventDefault();
    act(key);
  });
}
