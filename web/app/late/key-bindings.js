// The single keys of the page and what they do.

import { byId, h } from '../../dom/elements.js';
import { FASTEST, SLOWEST } from '../../run/speed.js';
import { impactsPath } from '../queries.js';
import { restart, setSpeed, step, toggle } from '../run-actions.js';
import { STORIES } from '../../play/stories.js';
import { tell } from '../../play/tell.js';

/** The speeds that `[` and `]` go through. */
const SPEEDS = [SLOWEST, 0.1, 0.2, 0.5, 1, 2, 5, 10, FASTEST];

/** Focuses the picture of the map, which may not have loaded yet. @param {HTMLElement} body */
async function focusIn(body) {
  const first = () => /** @type {HTMLElement | null} */ (body.querySelector('[role=application]'));
  while (!first()) {
    await new Promise((resolve) => {
      new MutationObserver((_, observer) => {
        observer.disconnect();
        resolve(null);
      }).observe(body, { childList: true, subtree: true });
    });
  }
  first()?.focus({ preventScroll: true });
}

/** @param {import('../page.js').Page} page @returns {import('./keys.js').Key[]} */
export function bindingsOf(page) {
  const { run, controls } = page;
  return [
    { keys: [' '], label: 'Space', name: 'Run, pause, resume', act: () => toggle(page) },
    {
      keys: ['.'],
      label: '.',
      name: 'Stop at the next strike',
      act: () => {
        if (run.active || run.past !== null) step(page);
      },
    },
    { keys: [','], label: ',', name: 'Back to the strike before', act: () => void page.timeline?.step(-1) },
    { keys: ['a'], label: 'a', name: 'Pin this run as a reference', act: () => page.pins?.pin() },
    { keys: ['n'], label: 'n', name: 'Back to now', act: () => page.timeline?.toNow() },
    { keys: ['r'], label: 'r', name: 'Restart from the release', act: () => restart(page) },
    {
      keys: ['k'],
      label: 'k',
      name: 'Kick',
      act: () => {
        if (run.active) controls.kick();
      },
    },
    {
      keys: ['1', '2', '3', '4', '5'],
      label: '1 – 5',
      name: 'The stories; in a lecture ← and → as well',
      act: (key) => tell(page, STORIES[Number(key) - 1]),
    },
    {
      keys: ['[', ']'],
      label: '[ ]',
      name: 'Slower, faster',
      act: (key) => {
        const { speed } = page;
        const next = key === '[' ? SPEEDS.findLast((one) => one < speed) : SPEEDS.find((one) => one > speed);
        setSpeed(page, next ?? speed);
      },
    },
    {
      keys: ['m'],
      label: 'm',
      name: 'Go to the stability map',
      act: () => {
        /** @type {HTMLDialogElement | null} */ (document.querySelector('dialog.large'))?.close();
        page.panels?.show('map');
        void focusIn(byId('map-body'));
      },
    },
    { keys: ['p'], label: 'p', name: 'Present: scene, map and verdict, large', act: () => byId('present').click() },
    // Undo listens by itself, since it works while single keys are off.
    { keys: [], label: 'Ctrl Z', name: 'Undo; with Shift redo', act: () => {} },
    { keys: ['l'], label: 'l', name: 'Show the symbols in the scene', act: () => byId('symbols').click() },
    { keys: ['s'], label: 's', name: 'Copy the link', act: () => byId('share').click() },
    {
      keys: ['e'],
      label: 'e',
      name: 'Save the bounces as CSV',
      act: () => {
        const path = impactsPath(page);
        if (path) h('a', { href: `${path}&format=csv`, download: 'equipoise-impacts.csv' }).click();
      },
    },
  ];
}
