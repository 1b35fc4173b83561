// What moves in the shell of the page: menus, sheets, the headline, charts that share a place.

import { byId } from '../dom/elements.js';
import { chartSwitch, chartTabs } from './chart-switch.js';
import { headline } from './headline.js';
import { present } from './present.js';
import { sheets } from './sheets.js';

/** Opens and closes what a button controls; a press elsewhere and Escape close it. @param {HTMLElement} button @param {HTMLElement} menu @param {(open: boolean) => void} show */
function menu(button, menu, show) {
  const set = (/** @type {boolean} */ open) => {
    button.setAttribute('aria-expanded', String(open));
    show(open);
  };
  const isOpen = () => button.getAttribute('aria-expanded') === 'true';
  button.addEventListener('click', () => set(!isOpen()));
  document.addEventListener('pointerdown', ({ target }) => {
    if (isOpen() && target instanceof Node && !menu.contains(target) && !button.contains(target)) set(false);
  });
  for (const element of [menu, button])
    element.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || !isOpen()) return;
      event.stopPropagation();
      set(false);
      button.focus();
    });
}

/** @param {() => void} changed another chart is shown @returns the switch, as far as the address knows it */
export function bringShell(changed) {
  const tools = byId('tools');
  menu(byId('tools-open'), tools, (open) => tools.classList.toggle('open', open));
  const share = byId('share-menu');
  menu(byId('share-open'), share, (open) => {
    share.hidden = !open;
  });
  // The menu is offered once somebody has put something into it.
  const offer = () => {
    byId('share-open').hidden = share.childElementCount === 0;
  };
  new MutationObserver(offer).observe(share, { childList: true });
  offer();
  headline(byId('headline'), byId('verdict-card'));
  const button = byId('present', HTMLButtonElement);
  present(button);
  button.disabled = false;
  sheets(byId('parts'));
  chartTabs(byId('chart-tabs'), byId('charts'));
  return chartSwitch(byId('other-charts'), changed);
}
