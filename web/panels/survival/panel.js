// The panel of survival under noise: how long many runs of the page's scene last.

import { valueAt } from '../../api/scene-fields.js';
import { readColumns, figureOf } from '../../charts/readable/server-figure.js';
import { fixed, number, quantity } from '../../dom/numbers.js';
import { angles, shownValue } from '../../dom/units.js';
import { html, useEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { QUIET_MS, TaskButtons, TaskTold, useTask } from '../ask.js';
import { Picture, Savings } from '../figures.js';
import { Term } from '../glossary.js';
import { Folded, Form, NO_SCENE, Numbers, Row, Table, sentence, words } from '../parts.js';
import { requestOf, useSettings, whole } from '../settings.js';
import { sizeWords } from '../verdict/facts.js';

/** @import { Ensemble } from 'contract' */

const QUANTILES = /** @type {const} */ (['q05', 'q25', 'q50', 'q75', 'q95']);
/** @type {Record<string, string>} */
const READINGS = { strike: 'It strikes early or late', plan: 'It carries out the plan for a wrong time' };
/** The last two are noise for a scene that has none. */
/** @type {Record<string, Setting>} */
const SETTINGS = {
  runs: whole('Runs', 200, 20_000),
  bounces: whole('Bounces', 400, 100_000, 'impacts'),
  'scene.noise.timing_sd': {
    key: 'timing_sd',
    label: words('σ_t'),
    usual: 0.01,
    unit: 'ms',
    scale: 1000,
    right: (value) => value > 0 && value <= 1,
    must: 'a number above 0 and up to 1000 ms',
  },
  'scene.noise.model': { key: 'model', label: 'A table that errs in time:', usual: 'strike', choices: READINGS },
};

/** A share in whole per cent; near all or none with a decimal, so that no share but 0 and 1 reads as such. @param {number} share */
const percent = (share) => {
  const near = Math.round(100 * share);
  return (near === 0 || near === 100) && share > 0 && share < 1 ? fixed(100 * share, 1) : fixed(near, 0);
};

/** The noise of a scene in words; '' where it has none. @param {Pick<PanelPage, 'fields' | 'scene'>} page */
function noiseOf({ fields, scene }) {
  const parts = fields
    .filter(({ field }) => /^noise\.\w+_sd$/.test(field) && valueAt(scene, field) > 0)
    .map(({ field, symbol, unit }) => `${symbol} = ${sizeWords(field, valueAt(scene, field), unit ?? '1')}`);
  const { timing_sd: timing = 0, model = 'strike' } = scene.noise ?? {};
  const reading = timing > 0 ? ` ${READINGS[model] ?? model}.` : '';
  return parts.length > 0 ? `Noise of the scene: ${parts.join(', ')}.${reading}` : '';
}

/**
 * @param {object} props
 * @param {PanelPage} props.page
 * @param {boolean} [props.open] somebody sees it
 * @param {(words: string) => void} [props.told] hears of the result in a line
 */
export function Survival({ page, open = true, told }) {
  const { values, field } = useSettings(page, 'survival', SETTINGS);
  const task = useTask('Running', 'runs');
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const under = useRef('');
  const own = noiseOf(page);
  const { runs, bounces } = values;
  const path = requestOf('v1/ensembles', page.query, own ? { runs, bounces } : values);
  const ask = async () => {
    if (!path) return task.say(NO_SCENE);
    under.current = path;
    const found = await task.ask(path);
    if (!found) return;
    const { survived } = found.end;
    const [all, lasting] = [number(found.end.runs, 6), `${number(found.end.bounces, 7)} bounces`];
    task.say(`${number(survived.runs, 6)} of ${all} runs outlast ${lasting}.`);
    told?.(`${percent(survived.share)} % of ${all} runs last ${lasting}`);
    show({ answer: found.end, figure: figureOf(found.pictures.survival), path });
  };
  useEffect(() => {
    if (!open || path === shown?.path) return;
    // Enter asks at once, and the change of its field a moment later.
    const timer = setTimeout(() => under.current !== path && void ask(), QUIET_MS);
    return () => clearTimeout(timer);
  }, [path, open, shown]);
  const sheet = useMemo(() => shown && html`<${Sheet} shown=${shown} take=${page.take} />`, [shown, angles()]);
  return html`<div class="study stack survival">
    <${Form} ask=${ask}>
      ${field('runs')}${field('bounces')}
      <p class="muted" id="survival-noise" hidden=${!own}>${words(own)}</p>
      <div class="row" id="survival-offer" hidden=${Boolean(own)}><p class="muted">The scene has no noise; this one is tried.</p>${field('scene.noise.timing_sd')}${field('scene.noise.model')}</div>
      <${TaskButtons} name="survival" task=${task} start="Run them all" quiet />
      <${TaskTold} name="survival" task=${task} />
    <//>
    ${shown && html`<div class=${`study-sheet stack survival-sheet ${shown.path === path ? '' : 'stale'}`}>${sheet}</div>`}
  </div>`;
}

/** @typedef {{answer: Ensemble, figure: SVGSVGElement, path: string}} Shown */

/** @param {{shown: Shown, take: (scene: Scene) => void}} props */
function Sheet({ shown: { answer, figure, path }, take }) {
  const { survived, bounces, counts, survival, quantiles } = answer;
  const ends = Object.entries(counts)
    .filter(([name, count]) => name !== 'completed' && count > 0)
    .map(([name, count]) => `${number(count, 6)} ${name.replaceAll('_', ' ')}`);
  const longest = answer.median_bounces === null ? `> ${number(bounces, 7)}` : number(answer.median_bounces, 7);
  const head = [
    'Bounce',
    html`<${Term} name="at-risk" words="at risk" />`,
    'ended',
    'going on',
    html`<${Term} name="wilson" words="95 % from" />`,
    'to',
    ...QUANTILES.map((name) => `|θ| ${Number(name.slice(1))} % / rad`),
  ];
  const read = (/** @type {SVGSVGElement} */ picture) =>
    readColumns(
      picture,
      survival.survival.map((_, at) => at + 1),
      (at) => wordsAt(answer, at + 1),
    );
  return html`
    <p class="answer" id="survival-headline"><strong class="large">${percent(survived.share)} %</strong> last ${number(bounces, 7)} bounces, ${percent(survived.lower)} to ${percent(survived.upper)} % <${Term} name="wilson" words="with 95 % confidence" />.</p>
    <${Picture} name="survival" figure=${figure} read=${read}
      label=${`Survival: ${number(survived.share)} of the runs outlast ${number(bounces, 7)} bounces`}
      hint="Above: the share of runs going on after each bounce. Below: |θ| of those that go on. With keys: left and right go from bounce to bounce, page up and page down by a tenth." />
    <div>
      <${Numbers} id="survival-numbers" rows=${[
        [html`<${Term} name="median" words="median" />`, longest, 'bounces of a run'],
        ['mean', `${survived.runs > 0 ? '≥ ' : ''}${number(answer.mean_bounces)}`, 'bounces of a run'],
        [html`<${Term} name="half-life" words="half-life" />`, number(answer.half_life), 'bounces, late in the runs'],
        ['ends', ends.join(', ') || 'none', 'of those that did not last'],
      ]} />
      <${Folded} title="Numbers">
        <${Table} label="Numbers: survival" head=${head}>
          ${quantiles.n.map((contact, index) => html`<${Row} cells=${cellsAt(survival, quantiles, contact, index)} />`)}
        <//>
      <//>
      <${Folded} title="How it was counted">${answer.notes.map((note) => html`<p class="muted">${sentence(note)}</p>`)}<//>
      <p class="actions" id="survival-links">
        <${Savings} id="survival" title="Survival under noise" path=${path} />
        <button type="button" id="survival-first" onClick=${() => take(answer.scene)}>Watch the first run</button>
      </p>
    </div>`;
}

/** @param {Ensemble['survival']} survival @param {Ensemble['quantiles']} quantiles @param {number} contact @param {number} index */
function cellsAt({ at_risk: risk, ended, survival, lower, upper }, quantiles, contact, index) {
  const at = contact - 1;
  const shares = [survival[at], lower[at], upper[at]].map((share) => number(share));
  const swings = QUANTILES.map((name) => {
    const angle = quantiles[name][index];
    return number(angle && shownValue(angle, 'rad'));
  });
  return [number(contact, 7), number(risk[at], 6), number(ended[at], 6), ...shares, ...swings];
}

/** @param {Ensemble} answer @param {number} contact */
function wordsAt({ survival, quantiles }, contact) {
  const at = contact - 1;
  const index = quantiles.n.findLastIndex((n) => n <= contact);
  const median = quantiles.n[index] === contact ? quantiles.q50[index] : null;
  return [
    `bounce ${number(contact, 7)}`,
    `going on ${number(survival.survival[at])} (${number(survival.lower[at])} to ${number(survival.upper[at])})`,
    `at risk ${number(survival.at_risk[at], 6)}`,
    median === null ? '' : `median |θ| ${quantity(median, 'rad')}`,
  ]
    .filter((part) => part)
    .join('   ');
}
