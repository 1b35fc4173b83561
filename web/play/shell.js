// Around the scene: menus, the time line, the way to the reasons, the mode for a lecture, files that are dropped.

import { remember, remembered } from '../api/remembered.js';
import { takeDrops } from '../app/drops.js';
import { byId, h, pressedIn } from '../dom/elements.js';
import { notice } from '../dom/notices.js';

/** An entry of a menu that opens something else closes the menu. @param {HTMLElement} button @param {HTMLElement} menu */
function offerMenu(button, menu) {
  menu.addEventListener('toggle', (event) =>
    button.setAttribute('aria-expanded', String(/** @type {ToggleEvent} */ (event).newState === 'open')),
  );
  menu.addEventListener(
    'click',
    ({ target }) => {
      if (!(target instanceof Element) || !target.closest('#time-open, [aria-haspopup]')) return;
      menu.hidePopover();
      // Before the dialog, which gives the focus back.
      button.focus();
    },
    { capture: true },
  );
}

const STORED = 'equipoise.time';

/** Shows or hides the time line and the exact kicks, in later visits as well. @param {boolean} open */
function showTime(open) {
  byId('time').hidden = !open;
  byId('time-open').setAttribute('aria-pressed', String(open));
  remember(STORED, open);
}

/** @param {Page} page */
export function bringShell(page) {
  offerMenu(byId('tools-open'), byId('tools'));
  offerMenu(byId('share-open'), byId('share-menu'));
  byId('time-open').addEventListener('click', () => showTime(byId('time').hidden !== false));
  showTime(remembered(STORED, false));
  byId('why').addEventListener('click', () => page.panels?.show('why'));
  // My rig reads files: measured bounces, and scenes.
  takeDrops(() => {
    const rig = h('a', { href: `rig?${page.typedQuery ?? ''}#measurements` }, 'My rig');
    notice('file', ['Measured bounces and scenes are read on ', rig, '. Drop the file there.']);
  });
}

/** Offers the mode for a lecture: scene, map and verdict, large and on the full screen where the browser allows it. @param {(by: number) => void} walk to another story */
export function bringPresent(walk) {
  const button = byId('present', HTMLButtonElement);
  const root = document.documentElement;
  const on = () => root.classList.contains('presenting');
  const set = async (/** @type {boolean} */ wanted) => {
    root.classList.toggle('presenting', wanted);
    button.setAttribute('aria-pressed', String(wanted));
    button.textContent = wanted ? 'End' : 'Present';
    scrollTo(0, 0);
    // Space is for the run.
    button.blur();
    // A browser may refuse the full screen; the mode works in its window as well.
    if (wanted) await root.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement === root) await document.exitFullscreen().catch(() => {});
  };
  button.addEventListener('click', () => void set(!on()));
  button.disabled = false;
  document.addEventListener('fullscreenchange', () => {
    if (on() && !document.fullscreenElement) void set(false);
  });
  addEventListener('keydown', (event) => {
    if (!on() || event.defaultPrevented || document.querySelector('dialog[open]')) return;
    if (event.key === 'Escape') return void set(false);
    // Arrows belong to what they move.
    if (pressedIn(event, 'input, select, textarea, [role=slider], [role=application], [role=tab]')) return;
    const by = { ArrowRight: 1, PageDown: 1, ArrowLeft: -1, PageUp: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    walk(by);
  });
}
