// The answer of a fit in words, bars and tables: its judgement, estimates, correlation, notes, verdict and margins.

import { fixed, number, quantity, unitAfter } from '../../dom/numbers.js';
import { shownFactor } from '../../dom/units.js';
import { html } from '../../vendor/preact/preact.js';
import { COLUMNS, QUANTITIES } from '../measured/quantities.js';
import { Residuals } from '../measured/residuals.js';
import { Headline, Numbers, Row, Scale, Table, sentence, sign } from '../parts.js';
import { verdictOf } from '../verdict/words.js';

/** @typedef {import('contract').Fit} Fit */
/** @typedef {import('contract').FitEstimate} Estimate */
/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('../parts.js').Tone} Tone */
/** A fit with its request, the unknown fields with their first values, and the lines of the file. @typedef {{fit: Fit, request: import('contract').FitRequest, unknown: import('./fields.js').Unknown[], lines: number[]}} Answer */

/** Judgements of a fit. @type {Record<Fit['quality']['kind'], [Tone, string]>} */
const QUALITIES = {
  good: ['stable', 'The model explains the data'],
  deviations_too_large: ['stable', 'The model explains the data, and the given deviations are too large'],
  not_random: ['beyond', 'The residuals are not random'],
  not_followed: ['unstable', 'The model explains short stretches only'],
  not_explained: ['unstable', 'The model does not explain the data'],
  not_converged: ['unstable', 'No best fit was found'],
};
/** Judgement of a fit whose deviations are taken from its own residuals: those are as large as they are. @type {[Tone, string]} */
const UNTESTED = ['beyond', 'The fit follows the data; given deviations would test the model'];

/** Remedies for a fit that the data reject, by its kind. @type {Partial<Record<Fit['quality']['kind'], string[]>>} */
const REMEDIES = {
  not_random: [
    'The residuals have a shape: look below where they begin to lean.',
    'Add a field that the rig may differ in, such as friction, an angle bias or a drag.',
  ],
  not_followed: [
    'Errors of the rig grow from bounce to bounce: choose a stretch of fewer bounces, or add the noise of the table to the values.',
    'Add a field that the rig may differ in, such as an angle bias.',
  ],
  not_explained: [
    'Add a field that the rig may differ in, such as restitution, friction or an angle bias.',
    'See whether columns and units are right, and whether the standard deviations given are not too small.',
  ],
  not_converged: ['Begin at values nearer to those of the rig.', 'Ask for fewer unknown fields at once.'],
};

/** The judgement of a fit in a line. @param {Fit} fit */
export const judgementOf = ({ quality: { kind } }) => QUALITIES[kind][1];

/** True if intervals and margins of the fit are to be trusted. @param {Fit} fit */
export const isTrusted = ({ quality: { kind } }) => QUALITIES[kind][0] === 'stable';

/** Margins in words: what lies between the scene and an end of its stable range. @type {Record<string, [string, string]>} */
const MARGINS = {
  'table.tilt_gain below': ['κ', 'Tilt gain above its lower end'],
  'table.tilt_gain above': ['κ', 'Tilt gain below its critical value'],
  'table.energy_gain below': ['κ_E', 'Energy gain above its lower end'],
  'table.energy_gain above': ['κ_E', 'Energy gain below its upper end'],
  'table.feedback below': ['K', 'State feedback above its lower end, as a factor'],
  'table.feedback above': ['K', 'State feedback below its upper end, as a factor'],
  spectral_margin: ['1 − |λ|', 'Closed loop inside the unit circle'],
};

/** All margins of a fit, each with its words. @param {Fit['stability']} stability */
function marginsOf({ margins, spectral_margin: spectral }) {
  const ends = margins.flatMap((margin) =>
    /** @type {const} */ (['below', 'above']).flatMap((side) => {
      const { margin: value = 0, sd = null, least, most } = margin[side] ?? {};
      return least == null || most == null ? [] : { words: MARGINS[`${margin.field} ${side}`], value, sd, least, most };
    }),
  );
  return spectral ? [...ends, { words: MARGINS.spectral_margin, ...spectral }] : ends;
}

/** Names in the server's sentences that have a symbol. @type {Record<string, string>} */
const LETTERS = { chi_squared: 'χ²', theta: 'θ', x_dot: 'ẋ', y_dot: 'ẏ', theta_dot: 'θ̇' };

/** A sentence of the server with symbols, and with the line of the file beside a row. @param {string} words @param {number[]} [lines] */
const said = (words, lines = []) =>
  sentence(
    words
      .replace(/(?<![\w.])(?:chi_squared|theta_dot|theta|x_dot|y_dot)(?![\w.])/g, (name) => LETTERS[name])
      .replace(/\brow (\d+)/g, (whole, n) => (lines[n - 1] ? `${whole} (line ${lines[n - 1]} of the file)` : whole)),
  );

/** Most decimals of a number that people read. */
const MOST_DECIMALS = 12;

/** Decimals that show two digits of a deviation. @param {number} deviation in the unit that is shown */
const decimalsOf = (deviation) =>
  Math.max(0, Math.min(MOST_DECIMALS, 1 - Math.floor(Math.log10(deviation || Number.MIN_VALUE))));

/** A value with the digits that its standard deviation leaves it. @param {{value: number, sd: number | null, unit: string}} estimate */
function valueWords({ value, sd, unit }) {
  if (sd === null) return quantity(value, unit, 6);
  const factor = shownFactor(unit);
  const decimals = decimalsOf(sd * factor);
  return `${fixed(value * factor, decimals)} ± ${fixed(sd * factor, decimals)}${unitAfter(unit)}`;
}

/** The ends of an interval, with the digits that tell them apart. @param {[number, number]} ends @param {string} unit */
function between([low, high], unit) {
  const factor = shownFactor(unit);
  const decimals = decimalsOf(((high - low) / 2) * factor);
  return `${fixed(low * factor, decimals)} to ${fixed(high * factor, decimals)}${unitAfter(unit)}`;
}

/** A judgement in its colour, and what follows from it. @param {{tone: Tone, words: string, id?: string, children: unknown}} props */
const Judged = ({ tone, words, id, children }) =>
  html`<div class="fit-judged" id=${id}><${Headline} result=${{ tone, words }} />${children}</div>`;

/** The judgement and its reason. @param {Answer} answer */
export function Judgement({ fit: { quality }, request: { sd } }) {
  const [tone, words] =
    quality.kind === 'good' && Object.keys(sd ?? {}).length === 0 ? UNTESTED : QUALITIES[quality.kind];
  return html`<${Judged} tone=${tone} words=${words}><p class="muted">${said(quality.detail)}</p><//>`;
}

/** A part of the answer with its title. @param {{id: string, title: string, children: unknown}} props */
export const Section = ({ id, title, children }) =>
  html`<section id=${id} aria-labelledby=${`${id}-title`}><h3 id=${`${id}-title`}>${title}</h3>${children}</section>`;

/** Room at both ends of a scale, as a share of it. */
const ROOM = 0.06;

/**
 * A number in a list, with its interval as a bar and in words, beside a value that it is compared with.
 * @param {object} props
 * @param {string | null} props.letter
 * @param {string} props.title
 * @param {{value: number, sd: number | null, unit: string}} props.told
 * @param {[number, number]} props.interval
 * @param {string} props.of what the interval is
 * @param {number} props.beside
 * @param {string} props.besideWords
 * @param {number[]} props.room values that the scale reaches to
 * @param {boolean} [props.good]
 * @param {unknown} [props.children]
 */
function Measure({ letter, title, told, interval, of, beside, besideWords, room, good = true, children }) {
  const [least, most] = [Math.min(...room), Math.max(...room)];
  const more = (most - least || Math.abs(most) || 1) * ROOM;
  const [low, high] = [least - more, most + more];
  // Beyond the scale it is an arrow at its end.
  const kind = beside < low ? 'before' : beside > high ? 'beyond' : 'within';
  const marks = [
    [beside, `beside ${kind}`],
    [told.value, ''],
  ];
  return html`<li class="fit-estimate">
    <span class="fit-name">${letter && sign(letter)} ${title}</span>
    <span class="fit-number">${valueWords(told)}</span>
    <div class="fit-bar">
      <${Scale} low=${low} high=${high} bars=${[[...interval, good ? 'interval' : 'caution']]} marks=${marks} />
      <p class="fit-ends muted"><span>${of}: ${between(interval, told.unit)}</span><span><span class="scale-mark beside key" aria-hidden="true" /> ${besideWords}</span></p>
    </div>
    ${children}
  </li>`;
}

/** @param {{estimate: Estimate, first: import('./fields.js').Unknown}} props */
function EstimateRow({ estimate, first: { field, value: first } }) {
  const { interval, unit, identifiable, detail } = estimate;
  const { symbol, title } = field;
  const begun = `first value ${quantity(first, unit, 5)}`;
  if (!identifiable || !interval)
    return html`<li class="fit-estimate untold">
      <span class="fit-name">${symbol && sign(symbol)} ${title}</span>
      <span class="fit-number">not told by the data</span>
      <p class="fit-detail">${detail && said(detail)} It keeps its ${begun}.</p>
    </li>`;
  const [low, high] = interval;
  const wide = (high - low) / 2;
  return html`<${Measure} letter=${symbol} title=${title} told=${estimate} interval=${interval} of="95 %" beside=${first} besideWords=${begun} room=${[low - wide, high + wide]}>
    ${detail && html`<p class="fit-detail muted">${said(detail)}</p>`}
  <//>`;
}

/** Estimates with bars of their intervals. @param {Answer} answer */
export const Estimates = ({ fit, unknown }) =>
  html`<${Section} id="fit-estimates" title="Estimates">
    <ul class="fit-estimates">${fit.estimates.map((estimate, index) => html`<${EstimateRow} estimate=${estimate} first=${unknown[index]} />`)}</ul>
  <//>`;

/** Correlations at which two fields are told together, not each. */
const STRONG = 0.95;

/** Correlations of the estimates that the data tell; none with fewer than two. @param {Answer} answer */
export function Correlations({ fit: { estimates, correlation }, unknown }) {
  const told = estimates.flatMap(({ identifiable }, index) => (identifiable ? [index] : []));
  if (told.length < 2) return null;
  const letter = (/** @type {number} */ index) => {
    const { symbol, title } = unknown[index].field;
    return symbol ? sign(symbol) : title;
  };
  const cell = (/** @type {number} */ one, /** @type {number} */ other) => {
    const value = correlation[one][other] ?? 0;
    const words = one === other ? '1' : number(value, Math.abs(value) > 0.999 ? 6 : 3);
    return Math.abs(value) >= STRONG && one !== other ? html`<strong>${words}</strong>` : words;
  };
  const strong = told
    .flatMap((one, place) => told.slice(place + 1).map((other) => [one, other]))
    .filter(([one, other]) => Math.abs(correlation[one][other] ?? 0) >= STRONG);
  return html`<${Section} id="fit-correlation" title="Correlation">
    <${Table} label="Correlation of the estimates" kind="correlation" head=${[html`<span class="unseen">field</span>`, ...told.map(letter)]}>
      ${told.map((one) => html`<${Row} cells=${[letter(one), ...told.map((other) => cell(one, other))]} />`)}
    <//>
    ${strong.map(([one, other]) => html`<p class="muted small">${letter(one)} and ${letter(other)} act nearly alike on these data: their combination is told well, each alone is not. Measure one of them by itself if you can.</p>`)}
  <//>`;
}

/** The fault of a fit that the data reject, in place of its estimates. @param {Answer} answer */
export const Rejected = ({ fit: { quality } }) =>
  html`<${Section} id="fit-rejected" title="No values to use"><ul>${REMEDIES[quality.kind]?.map((words) => html`<li>${words}</li>`)}</ul><//>`;

/** Impacts that were left out, missed or doubled, by name. @param {Answer} answer */
export const Notes = ({ fit: { notes }, lines }) =>
  notes.length > 0 &&
  html`<${Section} id="fit-notes" title="Notes"><ul class="fit-notes">${notes.map((note) => html`<li>${said(note, lines)}</li>`)}</ul><//>`;

/** Sentence on the confidence region. @param {Fit['stability']} stability */
function regionWords(stability) {
  const { holds } = stability;
  if (holds) return 'Every scene at the ends of the 95 % region of the estimates is stable.';
  if (holds === false)
    return 'Not every scene in the 95 % region of the estimates is stable: the data leave open which yours is.';
  if (marginsOf(stability).length === 0) return 'There is no bounce in place, and so no margins.';
  return 'Nothing is said about the region of the estimates: a field is not told.';
}

/** The verdict on the fitted scene, with its margins over the region. @param {Answer} answer */
export function VerdictOnIt({ fit: { stability } }) {
  const margins = marginsOf(stability);
  const { tone, words } = verdictOf(stability);
  return html`<${Section} id="fit-stability" title="Verdict on the fitted scene">
    <${Judged} tone=${tone} words=${words} id="fit-verdict"><p id="fit-holds">${regionWords(stability)}</p><//>
    ${
      margins.length > 0 &&
      html`<ul class="fit-estimates" id="fit-margins">
        ${margins.map(
          ({ words: [letter, title], value, sd, least, most }) =>
            html`<${Measure} letter=${letter} title=${title} told=${{ value, sd, unit: '1' }} interval=${[least, most]} of="in the region"
              beside=${0} besideWords="0, the edge" room=${[0, least, most]} good=${least > 0} />`,
        )}
      </ul>`
    }
  <//>`;
}

/** Measured less fitted; outliers stand out. @param {Answer} answer */
export function FitResiduals({ fit: { residuals, sd }, lines }) {
  const measured = COLUMNS.filter((column) => sd[column] !== null);
  const rows = residuals.n.map((n, index) => {
    const values = measured.map((column) => [column, residuals[column][index] ?? NaN]);
    const line = lines[residuals.row[index] - 1];
    return { n, line, outlier: residuals.outlier[index], ...Object.fromEntries(values) };
  });
  const within = measured.map(
    (column) => `${QUANTITIES[column][0]} within about ${quantity(sd[column], QUANTITIES[column][1], 2)}`,
  );
  const outliers = rows.filter(({ outlier }) => outlier).length;
  return html`<${Section} id="fit-residuals" title="Residuals: measured less fitted">
    <${Residuals} name="fit-residuals" rows=${rows} quantities=${measured}
      bands=${Object.fromEntries(measured.map((column) => [column, 2 * (sd[column] ?? 0)]))}
      label=${`Residuals of ${rows.length} bounces: ${within.join(', ')}; ${outliers} with an outlier.`}
      hint="The band is two standard deviations wide to each side; rings are values left out. " />
  <//>`;
}

/** χ², windows and deviations. @param {Answer} answer */
export function Facts({ fit, request: { sd: given } }) {
  const { chi_squared: chi, degrees_of_freedom: freedom, windows, iterations, sd, residuals } = fit;
  const deviations = COLUMNS.filter((column) => sd[column] !== null).map((column) => [
    sign(`σ_${QUANTITIES[column][0]}`),
    quantity(sd[column], QUANTITIES[column][1], 3),
    column in (given ?? {}) ? 'as given' : 'estimated from the residuals',
  ]);
  return html`<${Numbers} id="fit-facts" kind="fit-wide" rows=${[
    ['χ²', number(chi), `at ${number(freedom, 6)} degrees of freedom`],
    ...deviations,
    ['bounces', number(residuals.n.length, 6), 'that take part'],
    ['windows', number(windows), 'of bounces, each with its own first state'],
    ['iterations', number(iterations, 6), 'of the search'],
  ]} />`;
}

/** The answer in a sentence, for those who do not see the sheet. @param {Answer} answer @param {number} seconds */
export function toldOf({ fit, unknown }, seconds) {
  const judgement = judgementOf(fit);
  if (!isTrusted(fit)) return `${judgement}: do not use the estimates. Fitted in ${number(seconds, 2)} s.`;
  const values = fit.estimates.map((estimate, index) => {
    const { title } = unknown[index].field;
    return estimate.identifiable ? `${title} ${valueWords(estimate)}` : `${title} is not told`;
  });
  return `Fitted in ${number(seconds, 2)} s: ${values.join('; ')}. ${judgement}.`;
}
