// The panel of survival under noise: how long many runs of the page's scene last.

import { movedInRow } from '../../charts/readable/chart-reader.js';
import { FigureColumns, figureOf } from '../../charts/readable/server-figure.js';
import { fixed, number, quantity } from '../../dom/numbers.js';
import { angles, shownValue } from '../../dom/units.js';
import { html, useEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { alone } from '../alone.js';
import { TaskButtons, TaskTold, useLongRequest } from '../long-request.js';
import { Chart, Savings, Term } from '../figures.js';
import { Folded, Form, NO_SCENE, Numbers, Row, Table, sentence, words } from '../parts.js';
import { requestOf, useSettings, whole } from '../settings.js';

/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Ensemble} Ensemble */

/** Time without a change before it is asked, ms. */
const QUIET_MS = 400;
const QUANTILES = /** @type {const} */ (['q05', 'q25', 'q50', 'q75', 'q95']);
/** @type {Record<string, string>} */
const READINGS = { strike: 'It strikes early or late', plan: 'It carries out the plan for a wrong time' };
/** The last two are noise for a scene that has none. */
const SETTINGS = {
  runs: whole('Runs', 200, 20_000),
  impacts: whole('Bounces', 400, 100_000),
  timing: {
    key: 'timing_sd',
    label: words('σ_t'),
    usual: 0.01,
    unit: 'ms',
    scale: 1000,
    right: (/** @type {number} */ value) => value > 0 && value <= 1,
    must: 'a number above 0 and up to 1000 ms',
  },
  reading: { key: 'model', label: 'A table that errs in time:', usual: 'strike', choices: READINGS },
};

/** Errors in symbols, with unit and factor from that of the scene. */
const ERRORS = /** @type {const} */ ([
  ['timing_sd', 'σ_t', 'ms', 1000],
  ['angle_sd', 'σ_α', 'rad', 1],
  ['x_sd', 'σ_x', 'm', 1],
  ['x_dot_sd', 'σ_ẋ', 'm/s', 1],
  ['y_dot_sd', 'σ_ẏ', 'm/s', 1],
  ['theta_dot_sd', 'σ_θ̇', 'rad/s', 1],
  ['restitution_sd', 'σ_e', '1', 1],
]);

/** A share in whole per cent; near all or none with a decimal, so that no share but 0 and 1 reads as such. @param {number} share */
const percent = (share) => {
  const near = Math.round(100 * share);
  return (near === 0 || near === 100) && share > 0 && share < 1 ? fixed(100 * share, 1) : fixed(near, 0);
};

/** The noise of a scene in words; '' where it has none. @param {Scene} scene */
function noiseOf({ noise = {} }) {
  const parts = ERRORS.filter(([key]) => noise[key] > 0).map(
    ([key, symbol, unit, factor]) => `${symbol} = ${quantity(noise[key] * factor, unit)}`,
  );
  const reading = noise.timing_sd > 0 ? ` ${READINGS[noise.model ?? 'strike'] ?? noise.model}.` : '';
  return parts.length > 0 ? `Noise of the scene: ${parts.join(', ')}.${reading}` : '';
}

/**
 * @param {object} props
 * @param {import('../settings.js').Page} props.page
 * @param {boolean} [props.open] somebody sees it
 * @param {(words: string) => void} [props.told] hears of the result in a line
 */
export function Survival({ page, open = true, told }) {
  const { values, field } = useSettings(page, 'survival', SETTINGS);
  const task = useLongRequest('Running', 'runs');
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const under = useRef('');
  const own = noiseOf(page.scene);
  const tried = { 'scene.noise.timing_sd': values.timing, 'scene.noise.model': values.reading };
  const asked = { runs: values.runs, bounces: values.impacts, ...(!own && tried) };
  const path = requestOf('v1/ensembles', page.query, asked);
  const ask = async () => {
    if (!path) return task.say(NO_SCENE);
    // Enter asks at once, and the change of its field a moment later.
    if (task.active && under.current === path) return;
    under.current = path;
    const found = await task.ask(path);
    if (!found) return;
    const { survived, runs, bounces } = found.end;
    task.say(`${number(survived.runs, 6)} of ${number(runs, 6)} runs outlast ${number(bounces, 7)} bounces.`);
    told?.(`${percent(survived.share)} % of ${number(runs, 6)} runs last ${number(bounces, 7)} bounces`);
    show({ answer: found.end, figure: figureOf(found.pictures.survival), path });
  };
  useEffect(() => {
    if (!open || path === shown?.path) return;
    const timer = setTimeout(ask, QUIET_MS);
    return () => clearTimeout(timer);
  }, [path, open, shown]);
  const sheet = useMemo(() => shown && html`<${Sheet} shown=${shown} take=${page.take} />`, [shown, angles()]);
  return html`<div class="study survival">
    <${Form} ask=${ask}>
      ${field('runs')}${field('impacts')}
      <p class="muted" id="survival-noise" hidden=${!own}>${words(own)}</p>
      <div id="survival-offer" hidden=${Boolean(own)}><p class="muted">The scene has no noise; this one is tried.</p>${field('timing')}${field('reading')}</div>
      <${TaskButtons} name="survival" task=${task} start="Run them all" quiet />
      <${TaskTold} name="survival" task=${task} />
    <//>
    ${shown && html`<div class=${`study-sheet survival-sheet ${shown.path === path ? '' : 'stale'}`}>${sheet}</div>`}
  </div>`;
}

export const mount = alone('survival', Survival, SETTINGS);

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
  const plot = useMemo(() => new FigureColumns(figure), [figure]);
  const draw = (/** @type {HTMLElement} */ box) => {
    if (box.firstChild !== figure) box.replaceChildren(figure);
    return {
      nearest: (/** @type {PointerEvent} */ event) => plot.nearest(event),
      moved: (/** @type {string} */ key, /** @type {number | null} */ at) => movedInRow(key, at, 1, bounces),
      mark: (/** @type {number | null} */ contact) => plot.mark(contact),
      words: (/** @type {number} */ contact) => wordsAt(answer, contact),
    };
  };
  return html`
    <p class="answer" id="survival-headline"><strong class="large">${percent(survived.share)} %</strong> last ${number(bounces, 7)} bounces, ${percent(survived.lower)} to ${percent(survived.upper)} % <${Term} name="wilson" words="with 95 % confidence" />.</p>
    <${Chart} name="survival" kind="figure-box" draw=${draw} inputs=${[figure]}
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
