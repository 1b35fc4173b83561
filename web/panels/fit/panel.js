// The panel that fits unknown fields of the page's scene to measured impacts, and puts the fitted scene in its place.

import { pathOf, setAt } from '../../api/scene-fields.js';
import { wordsOf } from '../../api/client.js';
import { number } from '../../dom/numbers.js';
import { capitalized, inWords } from '../../dom/typeset.js';
import { angles } from '../../dom/units.js';
import { download } from '../../export/capture.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { alone } from '../alone.js';
import { TaskButtons, TaskTold, useLongRequest } from '../long-request.js';
import { Columns } from '../measured/columns.js';
import { COLUMNS } from '../measured/quantities.js';
import { useMeasured } from '../measured/file.js';
import { Form, NO_SCENE, words } from '../parts.js';
import {
  Correlations,
  Estimates,
  Facts,
  Judgement,
  Notes,
  Rejected,
  VerdictOnIt,
  isTrusted,
  judgementOf,
  toldOf,
} from './answer.js';
import { Convergence, ResidualChart, stepWords } from './charts.js';
import { exampleOf } from './example.js';
import { Deviations, UnknownFields, readFit } from './fields.js';
import { Overlay } from './overlay.js';

/** @typedef {import('contract').FitRequest} Request */
/** @typedef {import('../settings.js').Page} Page */
/** @typedef {import('./fields.js').Faults} Faults */
/** @typedef {import('../measured/read.js').Reading} Reading */
/** An answer with its request, and with what stood in the page then. @typedef {import('./answer.js').Answer & {request: Request, asked: Standing}} Shown */
/** The convergence of the newest fit, and of the one that is shown. @typedef {{begun_ms: number, points: import('./charts.js').Point[], kept: import('./charts.js').Point[]}} Curve */
/** The scene of the page, the settings of the fit, and the data. @typedef {{scene: string, rest: string}} Standing */

/** Most impacts that the server takes. */
const MOST_IMPACTS = 1000;
/** A fit that is shorter is not shown under way, ms. */
const FLASH_MS = 300;
const NO_DATA = 'There are no measured bounces yet: choose a file, or make an example.';

/** Counts of the measured values that are sent, by column. @param {Reading | null} reading */
function countsOf(reading) {
  const impacts = reading?.impacts.slice(0, MOST_IMPACTS) ?? [];
  const counts = COLUMNS.map((column) => impacts.filter((one) => Number.isFinite(one[column])).length);
  return new Map(COLUMNS.flatMap((column, place) => (counts[place] > 0 ? [[column, counts[place]]] : [])));
}

/** @param {Page} page @param {Reading} reading @param {ReturnType<typeof readFit>} settings @returns {Request} */
function requestOf(page, reading, { unknown, given }) {
  const impacts = reading.impacts.slice(0, MOST_IMPACTS);
  const columns = [...countsOf(reading).keys()];
  const values = columns.map((column) => [
    column,
    impacts.map((one) => (Number.isFinite(one[column]) ? one[column] : null)),
  ]);
  const scene = structuredClone(page.scene);
  for (const { field, value } of unknown) setAt(scene, field.field, value);
  return {
    scene,
    measured: { ...(reading.numbered && { n: impacts.map(({ n }) => n) }), ...Object.fromEntries(values) },
    unknown: unknown.map(({ field }) => field.field),
    sd: Object.fromEntries(Object.entries(given).filter(([column]) => columns.some((one) => one === column))),
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

/** @param {string} name @param {unknown} content */
const save = (name, content) =>
  download(new Blob([`${JSON.stringify(content, null, 1)}\n`], { type: 'application/json' }), name);

/**
 * @param {object} props
 * @param {Page} props.page
 * @param {(words: string, holds: boolean | null) => void} [props.told] hears of the result in a line; null for one that is neither good nor bad
 */
export function Fit({ page, told }) {
  const file = useMeasured();
  const { reading } = file;
  const task = useLongRequest('Fitting', stepWords);
  const settings = readFit(page);
  const { unknown, given, broken } = settings;
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const [faults, find] = useState(/** @type {Faults} */ ({}));
  const root = useRef(/** @type {HTMLElement | null} */ (null));
  const curve = useRef(/** @type {Curve} */ ({ begun_ms: 0, points: [], kept: [] }));
  useEffect(() => {
    if (broken.length > 0) page.drop('fit', broken);
  }, [page.link]);
  useEffect(() => find({}), [reading]);
  useLayoutEffect(() => {
    // Whoever asked should find the fault.
    const place = faults.data === NO_DATA ? '#fit-load' : faults.unknown ? '.fit-unknown input' : '[aria-invalid=true]';
    const wrong = Object.keys(faults).length > 0 ? root.current?.querySelector(place) : null;
    /** @type {HTMLElement | null | undefined} */ (wrong)?.focus();
  }, [faults]);

  const own = [...page.link].filter(([part]) => part.startsWith('fit.'));
  /** @type {Standing} */
  const now = { scene: JSON.stringify(page.scene), rest: JSON.stringify([own, file.files, file.heads]) };

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
    const request = requestOf(page, reading, settings);
    const { lines } = reading;
    /** @type {Curve} */
    const line = { begun_ms: performance.now(), points: [], kept: curve.current.kept };
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
    line.kept = line.points;
    const sd = /** @type {Record<string, number>} */ (request.sd);
    const found = { fit: answer.end, unknown, given: sd, lines };
    show({ ...found, request, asked: now });
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
  const { points, kept, begun_ms } = curve.current;
  const live = task.active && points.length > 0 && performance.now() - begun_ms > FLASH_MS;
  const sheet = useMemo(() => shown && html`<${Sheet} ...${shown} />`, [shown, angles()]);
  const { fields, link, scene } = page;
  const sent = Math.min(reading?.impacts.length ?? 0, MOST_IMPACTS);
  return html`<div class="study fit" ref=${root}>
    <${Data} file=${file} fault=${faults.data} note=${faults.note} makeExample=${makeExample} />
    ${reading && html`<${Overlay} key=${file.files} page=${page} reading=${reading} fit=${shown && state?.inUse ? shown.fit : null} />`}
    <${Form} ask=${ask}>
      <div class="fit-settings">
        <${UnknownFields} page=${{ fields, link, scene }} unknown=${unknown} faults=${faults} change=${page.part} />
        <${Deviations} counts=${countsOf(reading)} given=${given} faults=${faults} change=${page.part} />
      </div>
      <div class="study-act">
        <${TaskButtons} name="fit" task=${task} start="Fit" about="fit-promise" />
        <p class="muted fit-promise" id="fit-promise">Sends ${sent > 0 ? `these ${number(sent, 7)}` : 'the'} bounces and the scene to the server of this page. Until you press it, the data stay in this browser.</p>
        <${TaskTold} name="fit" task=${task} />
      </div>
    <//>
    <${Convergence} points=${live ? points : kept} open=${live} />
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

export const mount = alone('fit', Fit, (page) => readFit(page).broken);

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
  <div class="fit-wide"><${ResidualChart} ...${shown} /></div>
  <${Facts} ...${shown} />
  <p class="actions fit-wide">
    <button type="button" onClick=${() => save('equipoise-fit.json', shown.fit)}>Save fit</button>
    <button type="button" onClick=${() => save('equipoise-fit-request.json', shown.request)}>Save request</button>
  </p>`;

/** The file, how it was read, and an example. @param {{file: ReturnType<typeof useMeasured>, fault?: string, note?: string, makeExample: () => void}} props */
function Data({ file, fault, note, makeExample }) {
  const input = useRef(/** @type {HTMLInputElement | null} */ (null));
  const { name, reading, refusal, about } = file;
  const count = reading?.impacts.length ?? 0;
  const remarks = [...(reading?.remarks ?? [])];
  if (count > MOST_IMPACTS)
    remarks.push(`A fit takes at most ${MOST_IMPACTS} bounces: the first ${MOST_IMPACTS} are used.`);
  const take = (/** @type {Event} */ event) => {
    const { files } = /** @type {HTMLInputElement} */ (event.currentTarget);
    if (files?.[0]) void file.take(files[0]);
    /** @type {HTMLInputElement} */ (event.currentTarget).value = '';
  };
  const told = reading ? `${name}: ${number(count, 7)} bounces. ${about}` : refusal ? `${name}: ${refusal}` : NO_DATA;
  return html`<div class="fit-data">
    <p class="muted">Drop a CSV file anywhere on the page: t and any of θ, ẋ, ẏ, θ̇ and x just before each bounce, with units in the header, as in “t (ms)”.</p>
    <p class="buttons">
      <button type="button" id="fit-load" onClick=${() => input.current?.click()}>Choose a file…</button>
      <input type="file" id="fit-file" accept=".csv,.tsv,.txt,text/csv,text/tab-separated-values" hidden ref=${input} onChange=${take} />
      <button type="button" id="fit-example" onClick=${makeExample}>Make an example</button>
    </p>
    <p id="fit-data" role="status">${note ? words(note) : told}</p>
    <ul class="measured-remarks">${remarks.map((one) => html`<li>${one}</li>`)}</ul>
    <${Columns} file=${file} />
    <p class="error" id="fit-data-error" role="status">${fault}</p>
  </div>`;
}
