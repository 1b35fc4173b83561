// The panel that fits unknown fields of the page's scene to measured impacts, and puts the fitted scene in its place.

import { wordsOf } from '../../api/client.js';
import { pathOf, setAt } from '../../api/scene-fields.js';
import { fixed, number, quantity, unitAfter } from '../../dom/numbers.js';
import { capitalized, inWords } from '../../dom/typeset.js';
import { angles, shownFactor } from '../../dom/units.js';
import { downloadJson } from '../../export/capture.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { TaskButtons, TaskTold, useTask } from '../ask.js';
import { COLUMNS, Columns, QUANTITIES, useMeasured } from '../measured/read.js';
import { FileButton, Form, Headline, NO_SCENE, Numbers, Row, Scale, Table, sentence, sign, words } from '../parts.js';
import { useWhole } from '../settings.js';
import { verdictOf } from '../verdict/words.js';
import { Convergence, Overlay, Residuals, stepWords } from './charts.js';
import { exampleOf } from './example.js';
import WORDS from './words.json' with { type: 'json' };
import { Deviations, UnknownFields, readFit } from './fields.js';

/** @import { FitRequest as Request, Fit, FitEstimate as Estimate } from 'contract' */
/** @import { Faults } from './fields.js' */
/** @import { Measured, Column } from '../measured/read.js' */

/** The convergence of a fit. @typedef {{begun_ms: number, points: import('./charts.js').Point[]}} Curve */
/** An answer with its convergence, and with what stood in the page when it was asked for. @typedef {Answer & Curve & {asked: Standing}} Shown */
/** The scene of the page, the settings of the fit, and the data. @typedef {{scene: string, rest: string}} Standing */

/** Most impacts that the server takes. */
const MOST_IMPACTS = 1000;
/** A fit that is shorter is not shown under way, ms. */
const FLASH_MS = 300;
const NO_DATA = 'There are no measured bounces yet: choose a file, or make an example.';

/** The number of values of each column that has any. @param {Measured[]} impacts */
const countsOf = (impacts) =>
  new Map(
    COLUMNS.map(
      (column) => /** @type {const} */ ([column, impacts.filter((one) => Number.isFinite(one[column])).length]),
    ).filter(([, count]) => count > 0),
  );

/** @param {PanelPage} page @param {Measured[]} impacts @param {boolean} numbered @param {ReturnType<typeof readFit>} settings @returns {Request} */
function requestOf(page, impacts, numbered, { unknown, given }) {
  const counts = countsOf(impacts);
  /** @type {(keyof Measured)[]} */
  const columns = [...counts.keys(), ...(numbered ? /** @type {const} */ (['n']) : [])];
  const scene = structuredClone(page.scene);
  for (const { field, value } of unknown) setAt(scene, field.field, value);
  return {
    scene,
    // JSON has `null` for what is not a number.
    measured: /** @type {any} */ (
      Object.fromEntries(columns.map((column) => [column, impacts.map((one) => one[column])]))
    ),
    unknown: unknown.map(({ field }) => field.field),
    sd: Object.fromEntries(Object.entries(given).filter(([column]) => counts.has(/** @type {Column} */ (column)))),
  };
}

/**
 * A refusal in words at the fields and columns that it names, the rest under `''`.
 * @param {Problem} problem
 * @param {Request} request
 * @param {number[]} lines of the file
 */
function faultsOf(problem, { unknown, measured }, lines) {
  /** @type {Record<string, string[]>} */
  const told = {};
  const tell = (/** @type {string} */ place, /** @type {string} */ said) => {
    told[place] = [...(told[place] ?? []), said];
  };
  for (const { pointer, detail } of problem.errors) {
    const [, index] = /^\/unknown\/(\d+)/.exec(pointer) ?? [];
    const [, column = '', row] = /^\/(?:measured|sd)\/(\w+)(?:\/(\d+))?/.exec(pointer) ?? [];
    const path = index ? unknown[Number(index)] : pathOf(pointer);
    if (unknown.includes(path)) tell(path, detail);
    else if (pointer === '/unknown') tell('unknown', detail);
    else if (column !== 'n' && column in measured)
      tell(
        column,
        row === undefined ? detail : `row ${Number(row) + 1}, line ${lines[Number(row)]} of the file: ${detail}`,
      );
    else if (pointer.startsWith('/measured')) tell('data', `${capitalized(inWords(detail))}.`);
    else tell('', detail);
  }
  const shortened = (/** @type {string} */ place, /** @type {string[]} */ [first, ...more]) =>
    more.length > 0 && place in measured ? `${first} And ${number(more.length)} more.` : [first, ...more].join(' ');
  return Object.fromEntries(Object.entries(told).map(([place, all]) => [place, shortened(place, all)]));
}

/** @param {{page: PanelPage, told?: (words: string, holds: boolean | null) => void}} props `told` hears of the result in a line; null for one that is neither good nor bad */
export function Fit({ page, told }) {
  const file = useMeasured();
  const { heads, reading } = file.content;
  const impacts = reading?.impacts.slice(0, MOST_IMPACTS) ?? [];
  const task = useTask('Fitting', stepWords);
  const settings = readFit(page);
  const { unknown, broken } = settings;
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const [faults, find] = useState(/** @type {Faults} */ ({}));
  const root = useRef(/** @type {HTMLElement | null} */ (null));
  const curve = useRef(/** @type {Curve} */ ({ begun_ms: 0, points: [] }));
  useWhole(page, 'fit', broken);
  useEffect(() => find({}), [reading]);
  useLayoutEffect(() => {
    // Whoever asked should find the fault.
    const place = faults.data === NO_DATA ? '#fit-load' : faults.unknown ? '.fit-unknown input' : '[aria-invalid=true]';
    const wrong = Object.keys(faults).length > 0 ? root.current?.querySelector(place) : null;
    /** @type {HTMLElement | null | undefined} */ (wrong)?.focus();
  }, [faults]);

  const own = [...page.link].filter(([part]) => part.startsWith('fit.'));
  /** @type {Standing} */
  const now = { scene: JSON.stringify(page.scene), rest: JSON.stringify([own, file.files, heads]) };

  const ask = async () => {
    /** @type {Faults} */
    const missing = {};
    for (const { field, value } of unknown)
      if (value === null) missing[field.field] = 'It has no value in the scene: give a first guess.';
    if (unknown.length === 0) missing.unknown = 'Choose at least one field.';
    if (!reading) missing.data = NO_DATA;
    find(missing);
    if (!reading || Object.keys(missing).length > 0) return;
    if (!page.query) return task.say(NO_SCENE);
    const { lines, numbered } = reading;
    const request = requestOf(page, impacts, numbered, settings);
    /** @type {Curve} */
    const line = { begun_ms: performance.now(), points: [] };
    curve.current = line;
    const answer = await task.ask('v1/fits', {
      body: request,
      refused: (problem) => {
        const { '': rest, ...places } = faultsOf(problem, request, lines);
        find(places);
        return rest ?? (problem.errors.length > 0 ? 'There is no fit: the fault is marked.' : wordsOf(problem));
      },
      heard: (step) => {
        if (step.residual !== null && step.residual > 0) line.points.push(step);
      },
    });
    if (!answer) return;
    const found = { fit: answer.end, request, unknown, lines, ...line, asked: now };
    show(found);
    task.say(toldOf(found, task.took));
  };

  const makeExample = async () => {
    if (!page.query) return find({ note: NO_SCENE });
    try {
      const example = await exampleOf(page.query, unknown);
      if (example) await file.take(example.file, example.about);
      else find({ note: 'The run of this scene ends too soon for an example. Choose one that keeps its balance.' });
    } catch (error) {
      find({ note: wordsOf(error) });
    }
  };

  const state = shown && stateOf(shown, now);
  useEffect(() => {
    if (state) told?.(state.line, state.holds);
  }, [state?.line, shown]);
  const { points, begun_ms } = curve.current;
  const live = task.active && points.length > 0 && performance.now() - begun_ms > FLASH_MS;
  const sheet = useMemo(() => shown && html`<${Sheet} ...${shown} />`, [shown, angles()]);
  return html`<div class="study stack fit" ref=${root}>
    <${Data} file=${file} fault=${faults.data} note=${faults.note} makeExample=${makeExample} />
    ${reading && html`<${Overlay} key=${file.files} page=${page} reading=${reading} fit=${shown && state?.inUse ? shown.fit : null} />`}
    <${Form} ask=${ask}>
      <div class="fit-settings">
        <${UnknownFields} page=${page} settings=${settings} faults=${faults} />
        <${Deviations} counts=${countsOf(impacts)} settings=${settings} faults=${faults} />
      </div>
      <div class="row">
        <${TaskButtons} name="fit" task=${task} start="Fit" about="fit-promise" />
        <p class="muted fit-promise" id="fit-promise">Sends ${reading ? `these ${number(impacts.length, 7)}` : 'the'} bounces and the scene to the server of this page. Until you press it, the data stay in this browser.</p>
        <${TaskTold} name="fit" task=${task} />
      </div>
    <//>
    <${Convergence} points=${live ? points : (shown?.points ?? [])} open=${live} />
    <div class=${`study-sheet stack fit-sheet ${state?.stale ? 'stale' : ''}`} id="fit-sheet" hidden=${!shown}>
      ${
        shown &&
        html`<div class="fit-head row">
          <${Judgement} ...${shown} />
          <div class="fit-use row">
            ${state?.offered && html`<button type="button" id="fit-use" class="primary" onClick=${() => page.take(shown.fit.scene)}>Use these values</button>`}
            <p id="fit-used" role="status">${state?.words}</p>
          </div>
        </div>`
      }
      ${sheet}
    </div>
  </div>`;
}

/** The worth of an answer for the state of the page now. @param {Shown} shown @param {Standing} now */
function stateOf({ fit, asked }, now) {
  const state = { stale: false, offered: false, inUse: false };
  const inUse = now.scene === JSON.stringify(fit.scene);
  const isOtherScene = now.scene !== asked.scene;
  if (now.rest !== asked.rest || (isOtherScene && !inUse)) {
    const [what, anew] = now.rest !== asked.rest ? ['data or the settings have', 'with them'] : ['scene has', 'for it'];
    const words = `The ${what} changed since; fit anew ${anew}.`;
    return { ...state, stale: true, words, line: words, holds: null };
  }
  if (isOtherScene) {
    const words = 'The fitted values are in use. The way back in your browser brings back those before.';
    return { ...state, inUse, words, line: 'the fitted values are in use', holds: true };
  }
  const isTold = fit.estimates.some(({ identifiable }) => identifiable);
  const nothing = isTold ? '' : 'The data tell none of the fields, so that the scene stays as it is.';
  const words = isTrusted(fit) ? nothing : 'Do not use the estimates: the scene stays as it is.';
  return { ...state, offered: words === '', words, line: judgementOf(fit), holds: isTrusted(fit) };
}

/** The file, how it was read, and an example. @param {{file: ReturnType<typeof useMeasured>, fault?: string, note?: string, makeExample: () => void}} props */
function Data({ file, fault, note, makeExample }) {
  const { reading } = file.content;
  const isLong = reading && reading.impacts.length > MOST_IMPACTS;
  const told = reading ? `${file.words}. ${file.about}` : file.words || NO_DATA;
  return html`<div class="fit-data">
    <p class="muted">Drop a CSV file anywhere on the page: t and any of θ, ẋ, ẏ, θ̇ and x just before each bounce, with units in the header, as in “t (ms)”.</p>
    <p class="row">
      <${FileButton} id="fit-load" field="fit-file" accept=".csv,.tsv,.txt,text/csv,text/tab-separated-values" taken=${(/** @type {File} */ one) => void file.take(one)}>Choose a file…<//>
      <button type="button" id="fit-example" onClick=${makeExample}>Make an example</button>
    </p>
    <p id="fit-data" role="status">${note ? words(note) : told}</p>
    <ul class="measured-remarks">
      ${reading?.remarks.map((one) => html`<li>${one}</li>`)}
      ${isLong && html`<li>A fit takes at most ${MOST_IMPACTS} bounces: the first ${MOST_IMPACTS} are used.</li>`}
    </ul>
    <${Columns} file=${file} />
    <p class="error" id="fit-data-error" role="status">${fault}</p>
  </div>`;
}

/** A fit with its request, the unknown fields with their first values, and the lines of the file. @typedef {{fit: Fit, request: import('contract').FitRequest, unknown: import('./fields.js').Unknown[], lines: number[]}} Answer */

// The answer of a fit in words, bars and tables: its judgement, estimates, correlation, notes, verdict and margins.

/** Judgements of a fit, with remedies for those that the data reject; `untested` are deviations taken from its own residuals, which are as large as they are. @satisfies {Record<Fit['quality']['kind'], {tone: string, words: string, remedies: string[]}>} */
const QUALITIES = WORDS.qualities;

/** The judgement of a fit in a line. @param {Fit} fit */
const judgementOf = ({ quality: { kind } }) => QUALITIES[kind].words;

/** True if intervals and margins of the fit are to be trusted. @param {Fit} fit */
const isTrusted = ({ quality: { kind } }) => QUALITIES[kind].tone === 'stable';

/** Margins in words: what lies between the scene and an end of its stable range. @type {Record<string, {letter: string, title: string}>} */
const MARGINS = WORDS.margins;

/** All margins of a fit, each with its words. @param {Fit['stability']} stability */
function marginsOf({ margins, spectral_margin: spectral }) {
  const ends = margins.flatMap((margin) =>
    /** @type {const} */ (['below', 'above']).flatMap((side) => {
      const { margin: value = 0, sd = null, least, most } = margin[side] ?? {};
      return least == null || most == null ? [] : { ...MARGINS[`${margin.field} ${side}`], value, sd, least, most };
    }),
  );
  return spectral ? [...ends, { ...MARGINS.spectral_margin, ...spectral }] : ends;
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

/** Numbers in a unit, with the digits that a deviation leaves them. @param {number} deviation @param {string} unit */
const roundedBy = (deviation, unit) => (/** @type {number} */ value) =>
  fixed(value * shownFactor(unit), decimalsOf(deviation * shownFactor(unit)));

/** A value with the digits that its standard deviation leaves it. @param {{value: number, sd: number | null, unit: string}} estimate */
function valueWords({ value, sd, unit }) {
  if (sd === null) return quantity(value, unit, 6);
  const rounded = roundedBy(sd, unit);
  return `${rounded(value)} ± ${rounded(sd)}${unitAfter(unit)}`;
}

/** The ends of an interval, with the digits that tell them apart. @param {[number, number]} ends @param {string} unit */
const between = (ends, unit) => ends.map(roundedBy((ends[1] - ends[0]) / 2, unit)).join(' to ') + unitAfter(unit);

/** A judgement in its colour, and what follows from it. @param {{tone: Tone, words: string, id?: string, children: unknown}} props */
const Judged = ({ tone, words, id, children }) =>
  html`<div class="fit-judged" id=${id}><${Headline} result=${{ tone, words }} />${children}</div>`;

/** The judgement and its reason. @param {Answer} answer */
function Judgement({ fit: { quality }, request: { sd } }) {
  const isUntested = quality.kind === 'good' && Object.keys(sd ?? {}).length === 0;
  const { tone, words } = QUALITIES[isUntested ? 'untested' : quality.kind];
  return html`<${Judged} tone=${tone} words=${words}><p class="muted">${said(quality.detail)}</p><//>`;
}

/** A part of the answer with its title. @param {{id: string, title: string, children: unknown}} props */
const Section = ({ id, title, children }) =>
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
      <p class="fit-ends muted row"><span>${of}: ${between(interval, told.unit)}</span><span><span class="scale-mark beside key" aria-hidden="true" /> ${besideWords}</span></p>
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
const Estimates = ({ fit, unknown }) =>
  html`<${Section} id="fit-estimates" title="Estimates">
    <ul class="fit-estimates">${fit.estimates.map((estimate, index) => html`<${EstimateRow} estimate=${estimate} first=${unknown[index]} />`)}</ul>
  <//>`;

/** Correlations at which two fields are told together, not each. */
const STRONG = 0.95;

/** Correlations of the estimates that the data tell; none with fewer than two. @param {Answer} answer */
function Correlations({ fit: { estimates, correlation }, unknown }) {
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
const Rejected = ({ fit: { quality } }) => {
  const { remedies } = QUALITIES[quality.kind];
  return html`<${Section} id="fit-rejected" title="No values to use"><ul>${remedies.map((words) => html`<li>${words}</li>`)}</ul><//>`;
};

/** Impacts that were left out, missed or doubled, by name. @param {Answer} answer */
const Notes = ({ fit: { notes }, lines }) =>
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
function VerdictOnIt({ fit: { stability } }) {
  const margins = marginsOf(stability);
  const { tone, words } = verdictOf(stability);
  return html`<${Section} id="fit-stability" title="Verdict on the fitted scene">
    <${Judged} tone=${tone} words=${words} id="fit-verdict"><p id="fit-holds">${regionWords(stability)}</p><//>
    ${
      margins.length > 0 &&
      html`<ul class="fit-estimates" id="fit-margins">
        ${margins.map(
          ({ letter, title, value, sd, least, most }) =>
            html`<${Measure} letter=${letter} title=${title} told=${{ value, sd, unit: '1' }} interval=${[least, most]} of="in the region"
              beside=${0} besideWords="0, the edge" room=${[0, least, most]} good=${least > 0} />`,
        )}
      </ul>`
    }
  <//>`;
}

/** Measured less fitted; outliers stand out. @param {Answer} answer */
function FitResiduals({ fit: { residuals, sd }, lines }) {
  const measured = COLUMNS.filter((column) => sd[column] !== null);
  const rows = residuals.n.map((n, index) => {
    const values = measured.map((column) => [column, residuals[column][index] ?? NaN]);
    const line = lines[residuals.row[index] - 1];
    return { n, line, outlier: residuals.outlier[index], ...Object.fromEntries(values) };
  });
  const within = measured.map(
    (column) => `${QUANTITIES[column].symbol} within about ${quantity(sd[column], QUANTITIES[column].unit, 2)}`,
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
function Facts({ fit, request: { sd: given } }) {
  const { chi_squared: chi, degrees_of_freedom: freedom, windows, iterations, sd, residuals } = fit;
  const deviations = COLUMNS.filter((column) => sd[column] !== null).map((column) => [
    sign(`σ_${QUANTITIES[column].symbol}`),
    quantity(sd[column], QUANTITIES[column].unit, 3),
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

/** The answer below its judgement. @param {Answer} shown */
const Sheet = (shown) => html`
  ${
    isTrusted(shown.fit)
      ? html`<div class="fit-column"><${Estimates} ...${shown} /><${Correlations} ...${shown} /></div>
        <div class="fit-column"><${VerdictOnIt} ...${shown} /><${Notes} ...${shown} /></div>`
      : html`<div class="fit-wide"><${Rejected} ...${shown} /><${Notes} ...${shown} /></div>`
  }
  <div class="fit-wide"><${FitResiduals} ...${shown} /></div>
  <${Facts} ...${shown} />
  <p class="actions fit-wide">
    <button type="button" onClick=${() => downloadJson(shown.fit, 'equipoise-fit.json')}>Save fit</button>
    <button type="button" onClick=${() => downloadJson(shown.request, 'equipoise-fit-request.json')}>Save request</button>
  </p>`;

/** The answer in a sentence, for those who do not see the sheet. @param {Answer} answer @param {number} seconds */
function toldOf({ fit, unknown }, seconds) {
  const judgement = judgementOf(fit);
  if (!isTrusted(fit)) return `${judgement}: do not use the estimates. Fitted in ${number(seconds, 2)} s.`;
  const values = fit.estimates.map((estimate, index) => {
    const { title } = unknown[index].field;
    return estimate.identifiable ? `${title} ${valueWords(estimate)}` : `${title} is not told`;
  });
  return `Fitted in ${number(seconds, 2)} s: ${values.join('; ')}. ${judgement}.`;
}
