// The form of the typed scene, and what is known of its values on their tracks. An edit changes the run under way, or drops the scene anew: it
// falls from its release at once, and its live run begins when the hand rests.

import { criticalGain } from '../../api/answers.js';
import { debounce } from '../../dom/debounce.js';
import { byId } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { UNITS, followAddress, offerAngles } from '../../dom/units.js';
import { Form } from '../../form/form.js';
import { sign } from '../../panels/parts.js';
import { GAIN } from '../page.js';
import { showRun } from '../run-watcher.js';
import { runsByItself, sceneChanged } from '../scenes.js';

/** Changes the run under way, where its table can. @param {Page} page @param {string} path @param {boolean} final */
export function changeRun(page, path, final) {
  const { run, fields } = page;
  if (final && run.active && fields.find((field) => field.field === path)?.live) page.sendChanges();
  sceneChanged(page);
  if (run.phase === 'idle') page.updateAddressSoon();
  else showRun(page);
}

/** The live run begins after so long without another drop, ms. Until then the page draws the first fall by itself. */
const REST_MS = 70;

/** The page whose drop waits for its run. @type {Page | null} */
let waiting = null;

const run = debounce(REST_MS, (/** @type {Page} */ page) => {
  waiting = null;
  // Another run may have been chosen meanwhile.
  if (page.run.phase === 'idle' && page.complete) page.start();
});

/** Drops the typed scene after a change. @param {Page} page */
function drop(page) {
  waiting = page;
  if (page.run.phase !== 'idle') page.run.reset();
  sceneChanged(page);
  if (!page.complete) return;
  page.view.fall(page.speed);
  run(page);
  page.updateAddressSoon();
}

/** Drops the scene after an edit. A page that does not run by itself stays at rest. @param {Page} page */
function dropEdited(page) {
  if (page.run.phase !== 'idle' || waiting === page || runsByItself()) return drop(page);
  sceneChanged(page);
  page.updateAddressSoon();
}

/** Drops the scene with other values of some fields. @param {Page} page @param {Record<string, number>} values @param {boolean} first of a drag */
export function dropWith(page, values, first) {
  if (first) page.history?.record('the drop');
  for (const [path, value] of Object.entries(values)) page.put(path, value);
  drop(page);
}

/** @param {Page} page */
export function bringSettings(page) {
  const scene = () => String(page.typedQuery ?? '');
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
  page.markGain = () => {
    const at = criticalGain(page.judged?.answer);
    const words = `The critical gain is ${number(at)}.`;
    page.form?.mark(GAIN, at === null ? null : { at, label: sign('κ_c'), words });
  };
  page.markGain();
  offerAngles(byId('units'));
  addEventListener('popstate', () => followAddress(location.search));
  document.addEventListener(UNITS, () => {
    page.panels?.draw();
    page.view.redraw();
    page.updateAddress();
  });
  const underWay = byId('under-way', HTMLInputElement);
  page.anew = !underWay.checked;
  underWay.addEventListener('change', () => {
    page.anew = !underWay.checked;
    showRun(page);
  });
}
