// The form of the typed scene, what an edit of it does, and what is known of its values on their tracks.

import { criticalGain } from '../../api/answers.js';
import { byId } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { UNITS, followAddress, offerAngles } from '../../dom/units.js';
import { Form } from '../../form/form.js';
import { dropEdited } from '../../play/drop.js';
import { sign } from '../../panels/parts.js';
import { typedQuery, updateAddress, updateAddressSoon } from '../address-bar.js';
import { GAIN } from '../page.js';
import { sendChanges } from '../run-actions.js';
import { showRun } from '../run-watcher.js';
import { sceneChanged } from '../scenes.js';

/** Changes the run under way, where its table can. @param {import('../page.js').Page} page @param {string} path @param {boolean} final */
export function changeRun(page, path, final) {
  const { run, fields } = page;
  if (final && run.active && fields.find((field) => field.field === path)?.live) sendChanges(page);
  sceneChanged(page);
  if (run.phase === 'idle') updateAddressSoon(page);
  else showRun(page);
}

/** @param {import('../page.js').Page} page */
export function bringSettings(page) {
  const scene = () => String(typedQuery(page) ?? '');
  page.form = new Form(
    byId('parameters'),
    page.fields,
    (path, final) => (page.anew ? dropEdited(page) : changeRun(page, path, final)),
    {
      typed: page,
      before: (path, final) => page.history?.edit(path, final),
      // A table with a state feedback has no tilt gain, and a point has no angle.
      maps: {
        [GAIN]: () => (page.typed?.table?.feedback ? null : scene()),
        'release.theta': () => (page.typed?.body?.point ? null : scene()),
      },
    },
  );
  page.form.compare(page.chosen?.scene ?? null);
  offerAngles(byId('units'));
  addEventListener('popstate', () => followAddress(location.search));
  document.addEventListener(UNITS, () => {
    page.verdict?.retell();
    page.panels?.draw();
    page.view.redraw();
    updateAddress(page);
  });
  const underWay = byId('under-way', HTMLInputElement);
  page.anew = !underWay.checked;
  underWay.addEventListener('change', () => {
    page.anew = !underWay.checked;
    showRun(page);
  });
}

/** Marks κ_c on the track of κ. @param {import('../page.js').Page} page */
export function markCritical({ form, judged }) {
  const at = criticalGain(judged?.answer);
  form?.mark(GAIN, at === null ? null : { at, label: sign('κ_c'), words: `The critical gain is ${number(at)}.` });
}
