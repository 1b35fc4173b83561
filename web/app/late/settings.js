// Brings the form of the typed scene, and the switch of the unit of angles.

import { criticalGain } from '../../api/margins.js';
import { byId, h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { symbol } from '../../dom/typeset.js';
import { UNITS, angles, chooseAngles, followAddress } from '../../dom/units.js';
import { Form } from '../../form/form.js';
import { NumberRow } from '../../form/number-row.js';
import { STILL, TrackMap } from '../../form/track-map.js';
import { updateAddress } from '../address-bar.js';
import { GAIN } from '../page.js';
import { typedQuery } from '../queries.js';
import { showRun } from '../run-state.js';
import { edited } from '../typed/edits.js';

/** @param {import('../page.js').Page} page */
export function bringSettings(page) {
  const form = new Form(byId('parameters'), page.fields, (path, final) => {
    page.history?.edit(path, final);
    page.take();
    edited(page, path, final);
  });
  page.join(form);
  form.compare(page.chosen?.scene ?? null);
  offerUnits(page);
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
  const trackOf = (/** @type {string} */ path) => {
    const row = form?.row(path);
    return row instanceof NumberRow && row.track ? [row.track] : [];
  };
  const gains = trackOf(GAIN);
  // A table with a state feedback has no tilt gain, and a point has no angle.
  const maps = [
    { path: GAIN, tracks: gains, has: () => !page.typed?.table?.feedback },
    { path: ANGLE, tracks: trackOf(ANGLE), has: () => !page.typed?.body?.point },
  ].flatMap(({ path, tracks, has }) => {
    const [field, still] = [path, STILL].map((name) => fields.find((one) => one.field === name));
    return field && still && tracks.length > 0
      ? [new TrackMap(field, still, tracks, () => (has() ? typedQuery(page) : null))]
      : [];
  });
  const sceneChanged = () => {
    for (const map of maps) map.renew();
  };
  const judged = (/** @type {import('../../panels/card.js').Judged} */ { answer }) => {
    const critical = criticalGain(answer);
    for (const track of gains) track.mark(critical, symbol('κ_c'), `The critical gain is ${number(critical)}.`);
  };
  document.addEventListener(UNITS, sceneChanged);
  panels.join('tracks', { sceneChanged, judged });
  sceneChanged();
}

/** @param {import('../page.js').Page} page */
function offerUnits(page) {
  const button = byId('units', HTMLButtonElement);
  button.hidden = false;
  const show = () => {
    const degrees = angles() === 'deg';
    button.replaceChildren(
      h('span', { class: 'unseen' }, 'Angles in '),
      degrees ? '°' : 'rad',
      h('span', { class: 'unseen' }, `; switch to ${degrees ? 'radians' : 'degrees'}`),
    );
    button.title = `Angles in ${degrees ? 'degrees' : 'radians'}`;
  };
  button.addEventListener('click', () => chooseAngles(angles() === 'deg' ? 'rad' : 'deg'));
  addEventListener('popstate', () => followAddress(location.search));
  document.addEventListener(UNITS, () => {
    show();
    page.verdict?.retell();
    page.panels?.retell();
    page.view.redraw();
    updateAddress(page);
  });
  show();
}
