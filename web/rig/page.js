// My rig: one numbered page, from the values of a rig to what it takes to keep it up.

import { get, wordsOf } from '../api/client.js';
import { copy } from '../dom/clipboard.js';
import { byId, h, retryButton } from '../dom/elements.js';
import { brokenLinkNotice, clearNotice, notice } from '../dom/notices.js';
import { knowTitles } from '../dom/typeset.js';
import { UNITS, angles, chooseAngles, followAddress } from '../dom/units.js';
import { download } from '../export/capture.js';
import { measured } from '../panels/measured/file.js';
import { html, render } from '../vendor/preact/preact.js';
import { useAnswer } from './ask.js';
import { openStep, useRig } from './parts.js';
import { Rig } from './rig.js';
import { Budget, useBudget, withErrors } from './steps/budget.js';
import { Controller } from './steps/controller.js';
import { Measurements } from './steps/measurements.js';
import { Noise } from './steps/noise.js';
import { Values } from './steps/values.js';
import { Verdict, resultOf } from './steps/verdict.js';
import { Watch } from './steps/watch.js';

/** @typedef {import('./parts.js').Shared} Shared */

/** @param {{shared: Shared}} props */
function Steps({ shared }) {
  const { rig } = shared;
  useRig(rig);
  const { query } = rig;
  const verdict = useAnswer(query && `v1/stability?${query}&release_margins=true`);
  const limits = useBudget(query);
  const result = withErrors(resultOf(rig, verdict), limits, rig.have);
  return html`<${Values} rig=${rig} verdict=${verdict} />
    <${Verdict} rig=${rig} verdict=${verdict} result=${result} />
    <${Budget} rig=${rig} limits=${limits} falls=${result?.tone === 'unstable'} />
    <${Controller} shared=${shared} held=${result?.tone === 'none'} />
    <${Measurements} shared=${shared} />
    <${Noise} shared=${shared} />
    <${Watch} shared=${shared} />`;
}

/** @param {string} kind @param {string[]} what */
function dropped(kind, what) {
  if (what.length > 0) brokenLinkNotice(`link-${kind}`, what);
  else clearNotice(`link-${kind}`);
}

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

/** The buttons of the page's head, and files dropped anywhere on the page. @param {Rig} rig */
function offerTools(rig) {
  const file = h('input', {
    type: 'file',
    id: 'scene-file',
    accept: '.json,application/json',
    hidden: true,
    change: () => {
      void takeFile(rig, file.files?.[0]);
      file.value = '';
    },
  });
  const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {(event: Event) => void} */ click) =>
    h('button', { type: 'button', id, click }, words);
  const scene = () => new Blob([`${JSON.stringify(rig.scene, null, 2)}\n`], { type: 'application/json' });
  byId('tools').append(
    button('save-link', 'Save link', (event) => {
      rig.keep(false);
      void copy(/** @type {HTMLElement} */ (event.currentTarget), location.href);
    }),
    button('export', 'Export', () => download(scene(), 'rig.json')),
    button('from-file', 'From a file…', () => file.click()),
    file,
  );
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

/** @param {Rig} rig */
function offerUnits(rig) {
  const button = byId('units');
  const show = () => {
    button.textContent = angles() === 'deg' ? '°' : 'rad';
    button.setAttribute('aria-label', `Angles in ${angles() === 'deg' ? 'degrees' : 'radians'}`);
  };
  button.addEventListener('click', () => chooseAngles(angles() === 'deg' ? 'rad' : 'deg'));
  document.addEventListener(UNITS, () => {
    show();
    rig.retell();
  });
  show();
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
  const rig = new Rig(fields, cases);
  dropped('page', rig.read(location.search));
  /** @type {Shared} */
  const shared = {
    rig,
    page: {
      fields,
      query: () => rig.query,
      scene: () => rig.scene,
      chosen: () => rig.chosen,
      played: () => rig.query,
      play: (scene) => rig.take(scene),
      changed: () => rig.keep(false),
      launch: (values) => rig.set(values),
    },
    dropped,
  };
  const linkPlay = () => {
    byId('play', HTMLAnchorElement).href = `./?${rig.words}`;
  };
  rig.watch(linkPlay);
  linkPlay();
  offerTools(rig);
  offerUnits(rig);
  addEventListener('popstate', () => {
    // A link to a step changes nothing.
    if (location.search === rig.search) return;
    followAddress(location.search);
    dropped('page', rig.read(location.search));
    for (const [id, panel] of rig.panels) dropped(id, panel.restore?.(rig.link) ?? []);
  });
  render(html`<${Steps} shared=${shared} />`, byId('steps'));
  arrive();
}

begin().catch((error) => {
  const again = retryButton(() => location.reload());
  notice('server', [wordsOf(error), ' ', again], { dismissible: false, caution: true });
});
