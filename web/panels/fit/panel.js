// The panel that fits unknown fields of the page's scene to measured impacts, and puts the fitted scene in its place.

import { pathOf, setAt } from '../../api/scene-fields.js';
import { wordsOf } from '../../api/client.js';
import { number } from '../../dom/numbers.js';
import { capitalized, inWords } from '../../dom/typeset.js';
import { angles } from '../../dom/units.js';
import { downloadJson } from '../../export/capture.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { TaskButtons, TaskTold, useTask } from '../long-request.js';
import { Columns } from '../measured/columns.js';
import { COLUMNS } from '../measured/quantities.js';
import { useMeasured } from '../measured/file.js';
import { FileButton, Form, NO_SCENE, words } from '../parts.js';
import {
  Correlations,
  Estimates,
  Facts,
  FitResiduals,
  Judgement,
  Notes,
  Rejected,
  VerdictOnIt,
  isTrusted,
  judgementOf,
  toldOf,
} from './answer.js';
import { Convergence, stepWords } from './convergence.js';
import { exampleOf } from './example.js';
import { Deviations, UnknownFields, readFit } from './fields.js';
import { useWhole } from '../settings.js';
import { Overlay } from './overlay.js';

/** @typedef {import('contract').FitRequest} Request */
/** @typedef {import('../settings.js').Page} Page */
/** @typedef {import('./fields.js').Faults} Faults */
/** @typedef {import('../measured/read.js').Measured} Measured */
/** The convergence of a fit. @typedef {{begun_ms: number, points: import('./convergence.js').Point[]}} Curve */
/** An answer with its convergence, and with what stood in the page when it was asked for. @typedef {import('./answer.js').Answer & Curve & {asked: Standing}} Shown */
/** The scene of the page, the settings of the fit, and the data. @typedef {{scene: string, rest: string}} Standing */

/** Most impacts that the server takes. */
const MOST_IMPACTS = 1000;
/** A fit that is shorter is not shown under way, ms. */
const FLASH_MS = 300;
const NO_DATA = 'There are no measured bounces yet: choose a file, or make an example.';

/** The values that are sent, with their count, by column. @param {Measured[]} impacts */
const countsOf = (impacts) =>
  new Map(
    COLUMNS.map(
      (column) => /** @type {const} */ ([column, impacts.filter((one) => Number.isFinite(one[column])).length]),
    ).filter(([, count]) => count > 0),
  );

/** @param {Page} page @param {Measured[]} impacts @param {boolean} numbered @param {ReturnType<typeof readFit>} settings @returns {Request} */
function requestOf(page, impacts, numbered, { unknown, given }) {
  const columns = [...countsOf(impacts).keys()];
  const values = columns.map((column) => [
    column,
    impacts.map((one) => (Number.isFinite(one[column]) ? one[column] : null)),
  ]);
  const scene = structuredClone(page.scene);
  for (const { field, value } of unknown) setAt(scene, field.field, value);
  return {
    scene,
    measured: { ...(numbered && { n: impacts.map(({ n }) => n) }), ...Object.fromEntries(values) },
    unknown: unknown.map(({ field }) => field.field),
    sd: Object.fromEntries(columns.filter((column) => column in given).map((column) => [column, given[column]])),
  };
}

/**
 * A refusal in words at the fields and columns that it names, the rest under `''`.
 * @param {import('../../api/client.js').Problem} problem
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

/**
 * @param {object} props
 * @param {Page} props.page
 * @param {(words: string, holds: boolean | null) => void} [props.told] hears of the result in a line; null for one that is neither good nor bad
 */
export function Fit({ page, told }) {
  const file = useMeasured();
  const { heads, reading } = file.content;
  const impacts = reading?.impacts.slice(0, MOST_IMPACTS) ?? [];
  const task = useTask('Fitting', stepWords);
  const settings = readFit(page);
  const { unknown, given, broken } = settings;
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
  return html`<div class="study fit" ref=${root}>
    <${Data} file=${file} fault=${faults.data} note=${faults.note} makeExample=${makeExample} />
    ${reading && html`<${Overlay} key=${file.files} page=${page} reading=${reading} fit=${shown && state?.inUse ? shown.fit : null} />`}
    <${Form} ask=${ask}>
      <div class="fit-settings">
        <${UnknownFields} page=${page} unknown=${unknown} faults=${faults} change=${page.part} />
        <${Deviations} counts=${countsOf(impacts)} given=${given} faults=${faults} change=${page.part} />
      </div>
      <div class="study-act">
        <${TaskButtons} name="fit" task=${task} start="Fit" about="fit-promise" />
        <p class="muted fit-promise" id="fit-promise">Sends ${reading ? `these ${number(impacts.length, 7)}` : 'the'} bounces and the scene to the server of this page. Until you press it, the data stay in this browser.</p>
        <${TaskTold} name="fit" task=${task} />
      </div>
    <//>
    <${Convergence} points=${live ? points : (shown?.points ?? [])} open=${live} />
    <div class=${`study-sheet fit-sheet ${state?.stale ? 'stale' : ''}`} id="fit-sheet" hidden=${!shown}>
      ${
        shown &&
        html`<div class="fit-head">
          <${Judgement} ...${shown} />
          <div class="fit-use">
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
  const inUse = now.scene === JSON.stringify(fit.scene);
  const changed =
    now.rest !== asked.rest ? 'data or the settings have' : now.scene !== asked.scene && !inUse ? 'scene has' : '';
  if (changed) {
    const words = `The ${changed} changed since; fit anew ${now.rest !== asked.rest ? 'with them' : 'for it'}.`;
    return { stale: true, offered: false, inUse: false, words, line: words, holds: null };
  }
  if (inUse && now.scene !== asked.scene) {
    const words = 'The fitted values are in use. The way back in your browser brings back those before.';
    return { stale: false, offered: false, inUse, words, line: 'the fitted values are in use', holds: true };
  }
  const isTold = fit.estimates.some(({ identifiable }) => identifiable);
  const words = !isTrusted(fit)
    ? 'Do not use the estimates: the scene stays as it is.'
    : isTold
      ? ''
      : 'The data tell none of the fields, so that the scene stays as it is.';
  return { stale: false, offered: words === '', inUse: false, words, line: judgementOf(fit), holds: isTrusted(fit) };
}

/** The answer below its judgement. @param {Shown} shown */
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

/** The file, how it was read, and an example. @param {{file: ReturnType<typeof useMeasured>, fault?: string, note?: string, makeExample: () => void}} props */
function Data({ file, fault, note, makeExample }) {
  const { reading } = file.content;
  const isLong = reading && reading.impacts.length > MOST_IMPACTS;
  const told = reading ? `${file.words}. ${file.about}` : file.words || NO_DATA;
  return html`<div class="fit-data">
    <p class="muted">Drop a CSV file anywhere on the page: t and any of θ, ẋ, ẏ, θ̇ and x just before each bounce, with units in the header, as in “t (ms)”.</p>
    <p class="buttons">
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
