// The single keys of the page and what they do.

import { byId, h } from '../../dom/elements.js';
import { FASTEST, SLOWEST } from '../../run/speed.js';
import { impactsPath } from '../queries.js';
import { restart, setSpeed, step, toggle } from '../run-actions.js';
import { choose } from '../scenes.js';

/** The speeds that `[` and `]` go through. */
const SPEEDS = [SLOWEST, 0.1, 0.2, 0.5, 1, 2, 5, 10, FASTEST];

/** Focuses the first control of a panel, which may not have loaded yet. @param {HTMLElement} body */
async function focusIn(body) {
  const first = () => /** @type {HTMLElement | null} */ (body.querySelector('input, select, button'));
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
      name: 'Cases 1 to 5 of the paper',
      act: (key) => {
        const one = page.cases.find(({ name }) => name === `case-${key}`);
        if (one) choose(page, one);
      },
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
        document.dispatchEvent(new Event('show-desk'));
        page.panels?.show('map');
        byId('studies').scrollIntoView();
        void focusIn(byId('map-body'));
      },
    },
    { keys: ['p'], label: 'p', name: 'Present: scene, one plane and headline', act: () => byId('present').click() },
    // Undo listens by itself, since it works while single keys are off.
    { keys: [], label: 'Ctrl Z', name: 'Undo; with Shift redo', act: () => {} },
    { keys: ['l'], label: 'l', name: 'Show the symbols in the scene', act: () => byId('symbols').click() },
    { keys: ['s'], label: 's', name: 'Copy the link', act: () => byId('share').click() },
    {
      keys: ['e'],
      label: 'e',
      name: 'Save the impacts as CSV',
      act: () => {
        const path = impactsPath(page);
        if (path) h('a', { href: `${path}&format=csv`, download: 'equipoise-impacts.csv' }).click();
      },
    },
  ];
}
