// The form of the typed scene, what an edit of it does, and what is known of its values on their tracks.

import { criticalGain } from '../../api/answers.js';
import { byId } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { UNITS, followAddress, offerAngles } from '../../dom/units.js';
import { Form } from '../../form/form.js';
import { TrackMap } from '../../form/track-map.js';
import { dropEdited } from '../../play/drop.js';
import { html } from '../../vendor/preact/preact.js';
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
  page.form = new Form(
    byId('parameters'),
    page.fields,
    (path, final) => (page.anew ? dropEdited(page) : changeRun(page, path, final)),
    { typed: page, before: (path, final) => page.history?.edit(path, final) },
  );
  page.form.compare(page.chosen?.scene ?? null);
  offerAngles(byId('units'));
  addEventListener('popstate', () => followAddress(location.search));
  document.addEventListener(UNITS, () => {
    page.verdict?.retell();
    page.panels?.retell();
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

/** The field of the release whose track has a map as well. */
const ANGLE = 'release.theta';

/**
 * Shows on the tracks of κ and θ₀ what is known of their values: κ_c, and a map of runs.
 * @param {import('../page.js').Page} page
 * @param {import('../../panels/panels.js').Panels} panels tell of scenes and verdicts
 */
export function bringTracks(page, panels) {
  const { form, fields } = page;
  if (!form) return;
  // A table with a state feedback has no tilt gain, and a point has no angle.
  const has = /** @type {Record<string, () => boolean>} */ ({
    [GAIN]: () => !page.typed?.table?.feedback,
    [ANGLE]: () => !page.typed?.body?.point,
  });
  const maps = fields
    .filter(({ field }) => field in has)
    .map((field) => new TrackMap(field, form, () => (has[field.field]() ? typedQuery(page) : null)));
  const sceneChanged = () => {
    for (const map of maps) map.renew();
  };
  const judged = (/** @type {import('../../panels/card.js').Judged} */ { answer }) => {
    const at = criticalGain(answer);
    const label = html`<i class="symbol">κ<sub>c</sub></i>`;
    form.show(GAIN, { mark: at === null ? null : { at, label, words: `The critical gain is ${number(at)}.` } });
  };
  document.addEventListener(UNITS, sceneChanged);
  panels.join('tracks', { sceneChanged, judged });
  sceneChanged();
}
