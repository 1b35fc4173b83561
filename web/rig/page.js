// My rig: one numbered page, from the values of a rig to what it takes to keep it up.

import { arrive } from '../app/arrive.js';
import { takeDrops } from '../app/drops.js';
import { copy } from '../dom/clipboard.js';
import { byId, h } from '../dom/elements.js';
import { clearNotice, notice } from '../dom/notices.js';
import { UNITS, offerAngles } from '../dom/units.js';
import { downloadJson } from '../export/capture.js';
import { measured } from '../panels/measured/read.js';
import { FileButton } from '../panels/parts.js';
import { begin } from '../panels/scene-page.js';
import { html, render } from '../vendor/preact/preact.js';
import { Rig } from './rig.js';
import { Steps, openStep } from './steps.js';

/** Takes a file: a scene as JSON, or a table of measured impacts. @param {Rig} rig @param {File | undefined} file */
async function takeFile(rig, file) {
  if (!file) return;
  if (!/\.json$/i.test(file.name) && file.type !== 'application/json') {
    openStep('measurements');
    return void measured.take(file);
  }
  const lost = rig.load(await file.text().catch(() => ''));
  clearNotice('file');
  if (lost.length > 0)
    notice('file', [h('strong', {}, `${file.name} was not whole. `), `Dropped: ${lost.join('; ')}.`], {
      caution: true,
    });
}

/** The buttons of the page's head. @param {{rig: Rig}} props */
function Tools({ rig }) {
  const save = (/** @type {Event} */ event) => {
    rig.keep(false);
    void copy(/** @type {HTMLElement} */ (event.currentTarget), location.href);
  };
  return html`<button type="button" id="save-link" onClick=${save}>Save link</button>
    <button type="button" id="export" onClick=${() => downloadJson(rig.scene, 'rig.json')}>Export</button>
    <${FileButton} id="from-file" field="scene-file" accept=".json,application/json" taken=${(/** @type {File} */ file) => void takeFile(rig, file)}>From a file…<//>`;
}

begin((fields, cases) => {
  const rig = new Rig(fields, cases);
  rig.addEventListener('change', () => {
    byId('play', HTMLAnchorElement).href = `./?${rig.words}`;
  });
  rig.read(location.search);
  rig.followHistory();
  takeDrops((file) => void takeFile(rig, file));
  offerAngles(byId('units'));
  document.addEventListener(UNITS, () => rig.changed());
  render(html`<${Tools} rig=${rig} />`, byId('tools'));
  render(html`<${Steps} rig=${rig} />`, byId('steps'));
  arrive(byId('steps'));
});
