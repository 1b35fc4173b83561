// Reacts to news of the run: impacts, a lost connection, refusals.

import { pathOf } from '../api/scene-fields.js';
import { invalidate } from '../charts/surface.js';
import { h } from '../dom/elements.js';
import { clearNotice, connectionNotice, notice } from '../dom/notices.js';
import { inWords } from '../dom/typeset.js';
import { updateAddressSoon } from './address-bar.js';
import { sendChanges } from './run-actions.js';
import { showRun, showThisRun } from './run-state.js';

/** @typedef {import('./page.js').Page} Page */

/** @param {Page} page @returns {import('../run/run-state.js').Watcher} */
export const watcherOf = (page) => ({
  changed: () => showRun(page),
  struck: () => {
    for (const plot of page.plots) invalidate(plot);
    page.interaction?.struck();
    page.view.redraw();
    showThisRun(page);
  },
  cleared: () => {
    for (const plot of page.plots) plot.clear();
    page.interaction?.cleared();
    page.view.reset();
  },
  lost: (seconds) => {
    connectionNotice(seconds, () => page.run.retry());
    if (!Number.isNaN(seconds)) page.away = true;
    else if (page.away) returned(page);
  },
  refused: (problem) => {
    clearNotice('connection');
    const elsewhere = page.form?.blame(problem.errors) ?? [];
    const words = [inWords(problem.message), ...elsewhere, 'Its scene is kept; Run releases it anew.'].join(' ');
    notice('run', [h('strong', {}, 'The server did not take this run. '), words], { caution: true });
    updateAddressSoon(page);
  },
  problem: ({ title, detail, errors }) => {
    const own = errors.filter(({ pointer }) => page.fields.some((field) => field.path === pathOf(pointer)));
    const others = errors.filter((error) => !own.includes(error)).map((error) => inWords(error.detail));
    const words =
      [...(page.form?.blame(own) ?? []), ...others].join(' ') || (errors.length > 0 ? '' : inWords(detail || title));
    if (page.lastSent === 'kick') page.controls.blameKick(words || inWords(detail));
    else if (words) notice('message', [words], { caution: true });
  },
});

/** Makes up for what was missed while the server was away. @param {Page} page */
function returned(page) {
  page.away = false;
  if (page.unjudged) page.follow(false);
  sendChanges(page);
}
