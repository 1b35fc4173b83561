// My rig: one numbered page, from the values of a rig to what it takes to keep it up.

import { get, wordsOf } from '../api/client.js';
import { copy } from '../dom/clipboard.js';
import { byId, h, retryButton } from '../dom/elements.js';
import { brokenLinkNotice, clearNotice, notice } from '../dom/notices.js';
import { knowTitles } from '../dom/typeset.js';
import { UNITS, followAddress, offerAngles } from '../dom/units.js';
import { download } from '../export/capture.js';
import { useAnswer } from '../panels/ask.js';
import { measured } from '../panels/measured/file.js';
import { html, render, useEffect, useRef, useState } from '../vendor/preact/preact.js';
import { openStep } from './parts.js';
import { Rig } from './rig.js';
import { Budget, useBudget, withErrors } from './steps/budget.js';
import { Controller } from './steps/controller.js';
import { Measurements, Noise, Watch } from './steps/studies.js';
import { Values } from './steps/values.js';
import { Verdict, resultOf } from './steps/verdict.js';

/** All steps, drawn anew with each change of the rig. @param {{rig: Rig}} props */
function Steps({ rig }) {
  const [, again] = useState({});
  useEffect(() => rig.watch(() => again({})), []);
  const { query } = rig;
  const verdict = useAnswer(query && `v1/stability?${query}&release_margins=true`);
  const limits = useBudget(query);
  const result = withErrors(resultOf(rig, verdict), limits, rig.have);
  return html`<${Values} rig=${rig} verdict=${verdict} />
    <${Verdict} rig=${rig} verdict=${verdict} result=${result} />
    <${Budget} rig=${rig} limits=${limits} falls=${result?.tone === 'unstable'} />
    <${Controller} rig=${rig} held=${result?.tone === 'none'} />
    <${Measurements} rig=${rig} />
    <${Noise} rig=${rig} />
    <${Watch} rig=${rig} />`;
}

/** @param {string} kind @param {string[]} what */
const dropped = (kind, what) => brokenLinkNotice(`link-${kind}`, what);

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
  const file = useRef(/** @type {HTMLInputElement | null} */ (null));
  const scene = () => new Blob([`${JSON.stringify(rig.scene, null, 2)}\n`], { type: 'application/json' });
  const save = (/** @type {Event} */ event) => {
    rig.keep(false);
    void copy(/** @type {HTMLElement} */ (event.currentTarget), location.href);
  };
  const take = (/** @type {Event} */ event) => {
    const input = /** @type {HTMLInputElement} */ (event.currentTarget);
    void takeFile(rig, input.files?.[0]);
    input.value = '';
  };
  return html`<button type="button" id="save-link" onClick=${save}>Save link</button>
    <button type="button" id="export" onClick=${() => download(scene(), 'rig.json')}>Export</button>
    <button type="button" id="from-file" onClick=${() => file.current?.click()}>From a file…</button>
    <input type="file" id="scene-file" accept=".json,application/json" hidden ref=${file} onChange=${take} />`;
}

/** Takes files that are dropped anywhere on the page. @param {Rig} rig */
function takeDrops(rig) {
  const carries = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files') ?? false;
  addEventListener('dragover', (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    document.body.classList.add('awaited');
  });
  addEventListener('dragleave', (event) => {
    if (!event.relatedTarget) document.body.classList.remove('awaited');
  });
  addEventListener('drop', (event) => {
    document.body.classList.remove('awaited');
    if (!carries(event)) return;
    event.preventDefault();
    void takeFile(rig, event.dataTransfer?.files[0]);
  });
}

/** Keeps the step of the address in view while those above it grow, until the reader goes elsewhere. */
function arrive() {
  const watch = new ResizeObserver(() => {
    if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
  });
  watch.observe(byId('steps'));
  for (const kind of ['wheel', 'pointerdown', 'keydown', 'touchstart'])
    addEventListener(kind, () => watch.disconnect(), { once: true, passive: true });
}

async function begin() {
  const [{ items: fields }, { items: cases }] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
  clearNotice('server');
  knowTitles(fields);
  const rig = new Rig(fields, cases, dropped);
  rig.watch(() => {
    byId('play', HTMLAnchorElement).href = `./?${rig.words}`;
  });
  rig.read(location.search);
  takeDrops(rig);
  offerAngles(byId('units'));
  document.addEventListener(UNITS, () => rig.retell());
  addEventListener('popstate', () => {
    // A link to a step changes nothing.
    if (location.search === rig.search) return;
    followAddress(location.search);
    rig.read(location.search);
  });
  render(html`<${Tools} rig=${rig} />`, byId('tools'));
  render(html`<${Steps} rig=${rig} />`, byId('steps'));
  arrive();
}

begin().catch((error) => {
  const again = retryButton(() => location.reload());
  notice('server', [wordsOf(error), ' ', again], { dismissible: false, caution: true });
});
