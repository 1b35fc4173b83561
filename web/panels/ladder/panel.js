// The panel of the model that the page's scene needs: a row for each level, with what it changes.

import { MOST_IMPACTS } from '../../api/client.js';
import { number, quantity } from '../../dom/numbers.js';
import { inWords } from '../../dom/typeset.js';
import { html } from '../../vendor/preact/preact.js';
import { Answered, useAnswer } from '../ask.js';
import { Savings } from '../figures.js';
import { COLUMNS, QUANTITIES } from '../measured/read.js';
import { Row, Table, sentence, words } from '../parts.js';
import { requestOf, useSettings, whole } from '../settings.js';

/** @import { Ladder } from 'contract' */
/** @typedef {Ladder['rungs'][number]} Rung */
const SETTINGS = {
  bounces: whole('Bounces', 100, MOST_IMPACTS, 'impacts'),
  tolerance: {
    label: 'Difference that matters',
    usual: 0.001,
    unit: 'm/s',
    right: (/** @type {number} */ value) => value > 0 && value <= 10,
    must: 'a number above 0 and up to 10 m/s',
  },
};
const HEAD = ['Model', 'asked for by', 'ns/bounce', 'it ends', 'against the one below', 'most in the state', 'needed'];

/** @param {string} name */
const spaced = (name) => name.replaceAll('_', ' ');

/** @param {{page: PanelPage}} props */
export function LadderOf({ page }) {
  const { values, field } = useSettings(page, 'ladder', SETTINGS);
  const asked = useAnswer(requestOf('v1/ladder', page.query, values));
  return html`<div class="study stack">
    <div class="study-settings row">${field('bounces')}${field('tolerance')}</div>
    <${Answered} asked=${asked}>
      ${(/** @type {Ladder} */ answer) => html`<${Rungs} answer=${answer} path=${asked.of} fields=${page.fields} />`}
    <//>
  </div>`;
}

/** @param {{answer: Ladder, path: string, fields: PanelPage['fields']}} props */
function Rungs({ answer: { rungs, enough, reason }, path, fields }) {
  const title = (/** @type {string} */ name) => fields.find(({ field }) => field === name)?.title ?? inWords(name);
  return html`<p role="status"><strong>Enough for this scene: ${spaced(enough)}.</strong> ${sentence(reason)}</p>
    <${Table} label="Models, from the simplest up" head=${HEAD} kind="rungs">
      ${rungs.map((rung) => html`<${Row} key=${rung.name} kind=${rung.name === enough ? 'enough' : ''} cells=${cellsOf(rung, enough, title)} />`)}
    <//>
    <p class="actions" id="ladder-links"><${Savings} id="ladder" title="Which model does it need" path=${path} formats=${['csv', 'arrow', 'json']} /></p>`;
}

/** @param {Rung} rung @param {string} enough @param {(path: string) => string} title */
function cellsOf({ name, forced, outcome, change, needed, reason, cost_ns_per_bounce: cost }, enough, title) {
  const state = change?.state;
  const most = state?.difference == null ? '–' : quantity(state.difference, 'm/s', 3);
  const note = (/** @type {unknown} */ said) => html`<span class="note">${said}</span>`;
  return [
    html`${spaced(name)}${name === enough && html` <span class="chip">enough</span>`}`,
    forced ? html`${title(forced.field)}${note(words(forced.detail.replace(/\s+/g, ' ')))}` : '–',
    number(cost),
    outcome ? `${spaced(outcome.kind)}, ${number(outcome.bounces)}` : '–',
    change ? changeWords(change, note) : reason ? note(words(reason)) : '–',
    state?.difference == null || state.impact === null ? most : `${most} at ${number(state.impact)}`,
    needed === null ? '–' : needed ? 'needed' : 'not needed',
  ];
}

/** @param {NonNullable<Rung['change']>} change @param {(said: string) => unknown} note */
function changeWords(change, note) {
  const ends = change.same_outcome ? '' : 'ends otherwise';
  const changed = COLUMNS.filter((name) => (change[name].difference ?? 0) > 0);
  if (changed.length === 0) return ends || 'the same in every number';
  const differences = changed.map((name) => {
    const { symbol, unit } = QUANTITIES[name];
    return `Δ${symbol} ${quantity(change[name].difference, unit, 2)}`;
  });
  return html`${ends}${note(differences.join(', '))}`;
}
