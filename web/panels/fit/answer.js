// The answer of a fit in words, bars and tables: its judgement, estimates, correlation, notes, verdict and margins.

import { h } from '../../dom/elements.js';
import { fixed, number, quantity, unitAfter } from '../../dom/numbers.js';
import { entries, row, table } from '../../dom/tables.js';
import { capitalized, prose, symbol } from '../../dom/typeset.js';
import { shownFactor } from '../../dom/units.js';
import { SYMBOLS } from '../measured/compare.js';
import { verdictOf } from '../verdict/words.js';
import { COLUMNS } from './deviations.js';
import { around, intervalBar } from './interval-bar.js';

/** @typedef {import('contract').Fit} Fit */
/** @typedef {import('contract').FitEstimate} Estimate */
/** @typedef {import('../../api/scene-fields.js').Field} Field */

/** A question and what was given for it. @typedef {{fields: Field[], firsts: number[], given: Record<string, number>, lines: number[]}} Asked */

/** Judgements of a fit. @type {Record<Fit['quality']['kind'], [keyof typeof SIGNS, string]>} */
const QUALITIES = {
  good: ['stable', 'The model explains the data'],
  deviations_too_large: ['stable', 'The model explains the data, and the given deviations are too large'],
  not_random: ['beyond', 'The residuals are not random'],
  not_followed: ['unstable', 'The model explains short stretches only'],
  not_explained: ['unstable', 'The model does not explain the data'],
  not_converged: ['unstable', 'No best fit was found'],
};

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

/** The fault of a fit that the data reject, in place of its estimates. @param {Fit} fit */
export const rejected = ({ quality: { kind } }) =>
  h(
    'section',
    { id: 'fit-rejected', 'aria-labelledby': 'fit-rejected-title' },
    h('h3', { id: 'fit-rejected-title' }, 'No values to use'),
    h('ul', {}, ...(REMEDIES[kind] ?? []).map((words) => h('li', {}, words))),
  );

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

/**
 * A sentence of the server with symbols, and with the line of the file beside a row.
 * @param {string} words
 * @param {number[]} [lines]
 */
function sentence(words, lines = []) {
  const plain = words
    .replace(/(?<![\w.])(?:chi_squared|theta_dot|theta|x_dot|y_dot)(?![\w.])/g, (name) => LETTERS[name])
    .replace(/\brow (\d+)/g, (whole, n) => (lines[n - 1] ? `${whole} (line ${lines[n - 1]} of the file)` : whole));
  // A symbol has no capital at the beginning.
  return [...prose(/^[a-z]/.test(plain) ? capitalized(plain) : plain), '.'];
}

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

/** The ends of an interval, with the digits that tell them apart. @param {number} low @param {number} high @param {string} unit */
function between(low, high, unit) {
  const factor = shownFactor(unit);
  const decimals = decimalsOf(((high - low) / 2) * factor);
  return `${fixed(low * factor, decimals)} to ${fixed(high * factor, decimals)}${unitAfter(unit)}`;
}

/** Signs of the tones, which show them without colour. */
const SIGNS = { stable: '●', beyond: '◆', unstable: '▲' };

/** @param {keyof typeof SIGNS} tone @param {string} words */
const headline = (tone, words) =>
  h('p', { class: 'headline' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, SIGNS[tone]), ` ${words}`);

/** Judgement of a fit whose deviations are taken from its own residuals: those are as large as they are. @type {[keyof typeof SIGNS, string]} */
const UNTESTED = ['beyond', 'The fit follows the data; given deviations would test the model'];

/** The headline and the reason. @param {Fit} fit @param {Asked} asked */
export function judged({ quality: { kind, detail } }, { given }) {
  const [tone, words] = kind === 'good' && Object.keys(given).length === 0 ? UNTESTED : QUALITIES[kind];
  return h(
    'div',
    { class: `fit-judged ${tone}` },
    headline(tone, words),
    h('p', { class: 'muted' }, ...sentence(detail)),
  );
}

/** @param {Estimate} estimate @param {Field} field @param {number} first */
function estimateRow(estimate, field, first) {
  const { interval, unit, identifiable, detail } = estimate;
  const head = h('span', { class: 'fit-name' }, field.symbol && symbol(field.symbol), ` ${field.title}`);
  const begun = `first value ${quantity(first, unit, 5)}`;
  if (!identifiable || !interval)
    return h(
      'li',
      { class: 'fit-estimate untold' },
      head,
      h('span', { class: 'fit-number' }, 'not told by the data'),
      h('p', { class: 'fit-detail' }, ...(detail ? sentence(detail) : []), ` It keeps its ${begun}.`),
    );
  const [low, high] = interval;
  const wide = (high - low) / 2;
  const range = around([low - wide, high + wide]);
  return h(
    'li',
    { class: 'fit-estimate' },
    head,
    h('span', { class: 'fit-number' }, valueWords(estimate)),
    h(
      'div',
      { class: 'fit-bar' },
      intervalBar(range, { value: estimate.value, interval, beside: first }),
      h(
        'p',
        { class: 'fit-ends muted' },
        h('span', {}, `95 %: ${between(low, high, unit)}`),
        h('span', {}, h('span', { class: 'fit-beside key', 'aria-hidden': 'true' }), ` ${begun}`),
      ),
    ),
    detail && h('p', { class: 'fit-detail muted' }, ...sentence(detail)),
  );
}

/** Estimates with bars of their intervals. @param {Fit} fit @param {Asked} asked */
export const estimates = (fit, { fields, firsts }) =>
  h(
    'section',
    { 'aria-labelledby': 'fit-estimates-title' },
    h('h3', { id: 'fit-estimates-title' }, 'Estimates'),
    h(
      'ul',
      { class: 'fit-estimates', id: 'fit-estimates' },
      ...fit.estimates.map((estimate, index) => estimateRow(estimate, fields[index], firsts[index])),
    ),
  );

/** Correlations at which two fields are told together, not each. */
const STRONG = 0.95;

/** Correlations of the estimates that the data tell; empty with fewer than two. @param {Fit} fit @param {Asked} asked */
export function correlations({ estimates: all, correlation }, { fields }) {
  const told = all.flatMap(({ identifiable }, index) => (identifiable ? [index] : []));
  if (told.length < 2) return [];
  const sign = (/** @type {number} */ index) =>
    fields[index].symbol ? symbol(fields[index].symbol) : fields[index].title;
  const pairs = told.flatMap((one, place) => told.slice(place + 1).map((other) => [one, other]));
  const strong = pairs.filter(([one, other]) => Math.abs(correlation[one][other] ?? 0) >= STRONG);
  return [
    h(
      'section',
      { 'aria-labelledby': 'fit-correlation-title' },
      h('h3', { id: 'fit-correlation-title' }, 'Correlation'),
      table(
        'Correlation of the estimates',
        [h('span', { class: 'unseen' }, 'field'), ...told.map(sign)],
        h(
          'tbody',
          {},
          ...told.map((one) =>
            row(
              sign(one),
              told.map((other) => {
                const value = correlation[one][other] ?? 0;
                const words = one === other ? '1' : number(value, Math.abs(value) > 0.999 ? 6 : 3);
                return Math.abs(value) >= STRONG && one !== other ? h('strong', {}, words) : words;
              }),
            ),
          ),
        ),
        'correlation',
      ),
      ...strong.map(([one, other]) =>
        h(
          'p',
          { class: 'muted small' },
          sign(one),
          ' and ',
          sign(other),
          ' act nearly alike on these data: their combination is told well, each alone is not. Measure one of them by itself if you can.',
        ),
      ),
    ),
  ];
}

/** Impacts that were left out, missed or doubled, by name. @param {Fit} fit @param {Asked} asked */
export const notes = ({ notes: all }, { lines }) =>
  all.length === 0
    ? []
    : [
        h(
          'section',
          { 'aria-labelledby': 'fit-notes-title' },
          h('h3', { id: 'fit-notes-title' }, 'Notes'),
          h('ul', { class: 'fit-notes', id: 'fit-notes' }, ...all.map((note) => h('li', {}, ...sentence(note, lines)))),
        ),
      ];

/** Sentence on the confidence region. @param {Fit} fit */
function regionWords(fit) {
  const { holds } = fit.stability;
  if (holds) return 'Every scene at the ends of the 95 % region of the estimates is stable.';
  if (holds === false)
    return 'Not every scene in the 95 % region of the estimates is stable: the data leave open which yours is.';
  if (marginsOf(fit.stability).length === 0) return 'There is no bounce in place, and so no margins.';
  return 'Nothing is said about the region of the estimates: a field is not told.';
}

/** The verdict on the fitted scene, with its margins over the region. @param {Fit} fit */
export function verdict(fit) {
  const title = h('h3', { id: 'fit-verdict-title' }, 'Verdict on the fitted scene');
  const margins = marginsOf(fit.stability);
  const { tone, words } = verdictOf(fit.stability);
  return h(
    'section',
    { 'aria-labelledby': title.id },
    title,
    h(
      'div',
      { class: `fit-judged ${tone}`, id: 'fit-verdict' },
      headline(tone, words),
      h('p', { id: 'fit-holds' }, regionWords(fit)),
    ),
    margins.length > 0 &&
      h(
        'ul',
        { class: 'fit-estimates', id: 'fit-margins' },
        ...margins.map(({ words: [letter, title], value, sd, least, most }) => {
          return h(
            'li',
            { class: 'fit-estimate' },
            h('span', { class: 'fit-name' }, symbol(letter), ` ${title}`),
            h('span', { class: 'fit-number' }, valueWords({ value, sd, unit: '1' })),
            h(
              'div',
              { class: 'fit-bar' },
              intervalBar(around([0, least, most]), { value, interval: [least, most], beside: 0, good: least > 0 }),
              h(
                'p',
                { class: 'fit-ends muted' },
                h('span', {}, `in the region: ${between(least, most, '1')}`),
                h('span', {}, h('span', { class: 'fit-beside key', 'aria-hidden': 'true' }), ' 0, the edge'),
              ),
            ),
          );
        }),
      ),
  );
}

/** χ², windows and deviations. @param {Fit} fit @param {Asked} asked */
export function facts(
  { chi_squared: chi, degrees_of_freedom: freedom, windows, iterations, sd, residuals },
  { given },
) {
  const deviations = COLUMNS.filter((column) => sd[column] !== null).map(
    (column) =>
      /** @type {[Node, string, string]} */ ([
        symbol(`σ_${SYMBOLS[column][0]}`),
        quantity(sd[column], SYMBOLS[column][1], 3),
        column in given ? 'as given' : 'estimated from the residuals',
      ]),
  );
  return h(
    'dl',
    { class: 'numbers fit-wide', id: 'fit-facts' },
    ...entries([
      ['χ²', number(chi), `at ${number(freedom, 6)} degrees of freedom`],
      ...deviations,
      ['bounces', number(residuals.n.length, 6), 'that take part'],
      ['windows', number(windows), 'of bounces, each with its own first state'],
      ['iterations', number(iterations, 6), 'of the search'],
    ]),
  );
}

/** The answer in a sentence, for those who do not see the sheet. @param {Fit} fit @param {Asked} asked @param {number} seconds */
export function told(fit, { fields }, seconds) {
  const [, judgement] = QUALITIES[fit.quality.kind];
  if (!isTrusted(fit)) return `${judgement}: do not use the estimates. Fitted in ${number(seconds, 2)} s.`;
  const values = fit.estimates.map((estimate, index) =>
    estimate.identifiable ? `${fields[index].title} ${valueWords(estimate)}` : `${fields[index].title} is not told`,
  );
  return `Fitted in ${number(seconds, 2)} s: ${values.join('; ')}. ${judgement}.`;
}
