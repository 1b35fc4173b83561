// Steps 5 to 7: measured bounces, noise, and this rig elsewhere.

import { absolute, frame } from '../../export/save-actions.js';
import { useMeasured } from '../../panels/measured/file.js';
import { Code } from '../../panels/parts.js';
import { Panel } from '../../panels/card.js';
import { html, useEffect, useState } from '../../vendor/preact/preact.js';
import { RIG_PANELS } from '../panels.js';
import { Step } from '../parts.js';

/** @typedef {import('../rig.js').Rig} Rig */

/** Measured bounces, over the run of the rig's values, and what they tell of them. @param {{rig: Rig}} props */
export function Measurements({ rig }) {
  const { name, content, words } = useMeasured();
  const [told, tell] = useState(/** @type {import('../parts.js').Result} */ (null));
  useEffect(() => tell(null), [content]);
  const say = (/** @type {string} */ said, /** @type {boolean | null} */ holds) =>
    tell({ tone: holds === null ? 'none' : holds ? 'stable' : 'unstable', words: `${name}: ${said}` });
  return html`<${Step} n=${5} id="measurements" title="Your measurements" result=${told ?? { tone: 'none', words: words || 'Drop a CSV file anywhere on the page' }}>
    <${Panel} entry=${RIG_PANELS.fit} page=${rig} told=${say} />
  <//>`;
}

/** How many of many runs last when the table errs at random. @param {{rig: Rig}} props */
export function Noise({ rig }) {
  const [words, tell] = useState('How many of many runs last when the table errs at random');
  return html`<${Step} n=${6} id="noise" title="Under noise" result=${{ tone: 'none', words }}>
    ${(/** @type {boolean} */ open) => html`<${Panel} entry=${RIG_PANELS.survival} page=${rig} open=${open} told=${tell} />`}
  <//>`;
}

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

/** Exactly this rig in a dashboard, an alert and a script. @param {{rig: Rig}} props */
export function Watch({ rig }) {
  const { words } = rig;
  return html`<${Step} n=${7} id="watch" title="Watch it" result=${{ tone: 'none', words: 'A link, a panel for your dashboard, an alert, a script' }}>
    <${Code} title="Link" about="Opens this page with your values." code=${absolute(`rig?${words}`)} />
    <${Code} title="In another page" about="The rig as it runs, in a frame." code=${frame('scene', 'my rig', `?${words}`)} />
    <${Code} title="Prometheus" about="A job that asks for the verdict and its margins." code=${scrape(words)} />
    <${Code} title="Alert" about="Rules for that job: it falls, or a gain is near its limit." code=${ALERT} />
    <div id="calls-body"><${Panel} entry=${RIG_PANELS.calls} page=${rig} /></div>
  <//>`;
}
