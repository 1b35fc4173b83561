// Step 7: exactly this rig in a dashboard, an alert and a script.

import { copy } from '../../dom/clipboard.js';
import { html } from '../../vendor/preact/preact.js';
import { RIG_PANELS } from '../panels.js';
import { PanelPlace, Step, useRig } from '../parts.js';

const absolute = (/** @type {string} */ path) => new URL(path, document.baseURI).href;

/** Text for an attribute. @param {string} text */
const attribute = (text) => text.replaceAll('&', '&amp;').replaceAll('"', '&quot;').replaceAll('<', '&lt;');

/** Text in quotes of YAML. @param {string} text */
const quoted = (text) => `'${text.replaceAll("'", "''")}'`;

/** The job of Prometheus that asks for the verdict on the rig. @param {string} query */
const scrape = (query) => `- job_name: equipoise_rigs
  metrics_path: /v1/probe
  static_configs:
    - targets: [${quoted(query)}]
      labels: { instance: my-rig }
  relabel_configs:
    - { source_labels: [__address__], target_label: __param_target }
    - { target_label: __address__, replacement: ${quoted(new URL(document.baseURI).host)} }`;

/** A rule of Prometheus on what the job above has asked. */
const ALERT = `- alert: MyRigUnstable
  expr: equipoise_stability_verdict{instance="my-rig",verdict_code=~"unstable|weakly_unstable"} == 1
- alert: MyRigNearItsLimit
  expr: min by (instance) (equipoise_margin{instance="my-rig",of="small"}) < 0.05`;

/** @param {{title: string, about: string, text: string}} props */
const Code = ({ title, about, text }) => html`<div class="call">
  <h3>${title}</h3>
  <p class="muted">${about}</p>
  <pre tabindex="0" role="region" aria-label=${title}><code>${text}</code></pre>
  <p class="actions"><button type="button" aria-label=${`Copy: ${title}`} onClick=${(/** @type {Event} */ event) => void copy(/** @type {HTMLElement} */ (event.currentTarget), text)}>Copy</button></p>
</div>`;

/** @param {{shared: import('../parts.js').Shared}} props */
export function Watch({ shared: { rig, page, dropped } }) {
  useRig(rig);
  const { words } = rig;
  const frame = `<iframe src="${attribute(absolute(`embed/scene?${words}`))}" title="equipoise: my rig" width="640" height="480"></iframe>`;
  return html`<${Step} n=${7} id="watch" title="Watch it" result=${{ tone: 'none', words: 'A link, a panel for your dashboard, an alert, a script' }}>
    <${Code} title="Link" about="Opens this page with your values." text=${absolute(`rig?${words}`)} />
    <${Code} title="In another page" about="The rig as it runs, in a frame." text=${frame} />
    <${Code} title="Prometheus" about="A job that asks for the verdict and its margins." text=${scrape(words)} />
    <${Code} title="Alert" about="Rules for that job: it falls, or a gain is near its limit." text=${ALERT} />
    <${PanelPlace} entry=${RIG_PANELS.calls} rig=${rig} page=${page} dropped=${dropped} />
  <//>`;
}
