// The words of the page when the server refuses a run, or something that was sent to it.

import { pathOf } from '../../api/scene-fields.js';
import { h } from '../../dom/elements.js';
import { clearNotice, notice } from '../../dom/notices.js';
import { inWords } from '../../dom/typeset.js';
import { updateAddressSoon } from '../address-bar.js';

/** @typedef {import('../page.js').Page} Page */

/** The run is refused for good. @param {Page} page @param {import('../../api/client.js').Problem} problem */
export function refused(page, problem) {
  clearNotice('connection');
  const elsewhere = page.form?.blame(problem.errors) ?? [];
  const words = [inWords(problem.message), ...elsewhere, 'Its scene is kept; Run releases it anew.'].join(' ');
  notice('run', [h('strong', {}, 'The server did not take this run. '), words], { caution: true });
  updateAddressSoon(page);
}

/** A message to the run is refused. @param {Page} page @param {{title: string, detail: string, errors: import('contract').ProblemError[]}} message */
export function tell(page, { title, detail, errors }) {
  const { run } = page;
  if (run.guided && page.guidedByPanel) return;
  const own = errors.filter(({ pointer }) => page.fields.some((field) => field.field === pathOf(pointer)));
  const others = errors.filter((error) => !own.includes(error)).map((error) => inWords(error.detail));
  const words =
    [...(page.form?.blame(own) ?? []), ...others].join(' ') || (errors.length > 0 ? '' : inWords(detail || title));
  if (run.guided || run.sent === 'kick') page.controls.sliders?.blame(words || inWords(detail));
  else if (words) notice('message', [words], { caution: true });
}
