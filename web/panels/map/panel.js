// The stability map as a control: its point is the scene, and a drag of it drops the scene anew. It refines itself, and one can look closer.

import { Problem, wordsOf } from '../../api/client.js';
import { playedAt } from '../../api/scene-fields.js';
import { unbroken } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { inUse, namesOf } from '../catch/settings.js';
import { Savings } from '../figures.js';
import { useTask } from '../long-request.js';
import { Form, NO_SCENE, useKeptFocus, useNear } from '../parts.js';
import { refusalOf, useWhole } from '../settings.js';
import { MapControls } from './controls.js';
import { MapPicture } from './picture.js';
import { usePointer } from './pointer.js';
import { refine } from './refinement.js';
import { isOfCatches, kept, readMap, requestQuery, rowsOf, sideParts } from './settings.js';
import { Legend, Sample, cellWords, decimalsOf, labelOf, mapWords } from './words.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {import('./settings.js').Sides} Sides */
/** @typedef {{x: number, y: number}} Values of the two fields */
/** The drawn cells, the request for them, and the settings with the finest columns wanted. @typedef {{grid: Grid, request: URLSearchParams, settings: Settings}} Shown */

const HINT =
  'Drag the point: the body drops from there. With Shift, drag a rectangle to look closer; Escape goes back. With keys: arrows move the point, with Shift ten cells, + looks closer.';

/** Time without a change of the scene before it is asked, ms. */
const QUIET_MS = 300;

/** The rows that have arrived. @param {{done: number, of: number, columns: number}} progress */
const rowWords = ({ done, of, columns }) => `${done} / ${of} rows of ${columns} × ${of}`;

/** Part of a side, with ends as round as the picture is fine and within what the field may be. @param {Side} side @param {number} low @param {number} high @returns {Side} */
function partOf({ field }, low, high) {
  const decimals = decimalsOf((high - low) / 1000);
  const [from, to] = [low, high].map((end) => kept(Number(end.toFixed(decimals)), field));
  return { field, from, to };
}

/** Half of a range around a share of it. @param {import('../../charts/axes.js').Range} range @param {number} share */
function halfOf({ low, high }, share) {
  const from = Math.min(0.5, Math.max(0, share - 0.25));
  return [from, from + 0.5].map((end) => low + (high - low) * end);
}

/**
 * Asks for a map when its settings or the scene have changed, as long as it is in sight.
 * @param {import('../settings.js').Page} page
 * @param {Settings} settings
 * @param {boolean} near
 */
function useMap({ query, link }, settings, near) {
  const task = useTask('Computing', rowWords);
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const [errors, blame] = useState(/** @type {import('contract').ProblemError[]} */ ([]));
  /** The request made last, and the parts of the address then. */
  const asked = useRef(/** @type {{request: string, parts: string} | null} */ (null));
  const request = query ? String(requestQuery(settings, query)) : '';
  const parts = String([...link].filter(([part]) => part.startsWith('map.')));
  const failed = (/** @type {unknown} */ error) => {
    const words =
      error instanceof Problem
        ? refusalOf(error, ['x', 'y', 'bounces', ...namesOf(settings, 'catch.')])
        : wordsOf(error);
    if (error instanceof Problem) blame(error.errors);
    const { done = 0, of } = task.progress ?? {};
    return done > 0 ? `${words} ${done} of ${of} rows are there.` : words;
  };
  const ask = async (unasked = false) => {
    asked.current = { request, parts };
    blame([]);
    if (!query) return task.stop(NO_SCENE);
    const heard = (/** @type {Parameters<typeof rowWords>[0]} */ progress) => task.hear(progress);
    const found = await task.run(
      (signal) =>
        refine(settings, query, {
          signal,
          unasked,
          heard,
          show: (grid, own) => show({ grid, request: own, settings }),
        }),
      failed,
    );
    if (!found) return;
    const { grid, refused, waits } = found;
    if (waits)
      return task.stop(`${waits.columns} × ${rowsOf(waits.columns)} cells take a while: Compute asks for them.`);
    const why = refused ? ` Finer than that the server refuses: ${refused.message}.` : '';
    if (grid) task.say(mapWords(grid) + why);
  };
  useLayoutEffect(() => {
    if (!near) {
      // It goes on when it is seen again.
      if (!task.active) return;
      asked.current = null;
      return task.stop('');
    }
    if (asked.current?.request === request) return;
    const byHand = asked.current?.parts !== parts;
    const timer = setTimeout(() => void ask(!byHand), byHand ? 0 : QUIET_MS);
    return () => clearTimeout(timer);
  }, [near, request, parts]);
  return { task, shown, errors, ask };
}

/** @param {{page: import('../settings.js').Page}} props */
export function StabilityMap({ page }) {
  const map = readMap(page);
  const { settings, usual, broken } = map;
  useWhole(page, 'map', broken);
  const [place, near] = useNear();
  const { task, shown, errors, ask } = useMap(page, settings, near);
  const grid = shown?.grid ?? null;
  const box = useRef(/** @type {any} */ (null));
  const drawn = useRef(/** @type {MapPicture | null} */ (null));
  const picture = () => /** @type {MapPicture} */ (drawn.current);
  const [spoken, speak] = useState('');
  const [, again] = useState({});
  const [sampled, sample] = useState(false);
  /** True where the scene of a map of catches may go on in the tab Catch. */
  const [offered, offer] = useState(false);
  /** Views before this one. */
  const views = useRef(/** @type {Sides[]} */ ([]));
  /** The values of the last drop. */
  const dropped = useRef(/** @type {Record<string, number>} */ ({}));

  const { x, y } = grid?.settings ?? settings;
  const [across, upwards] = [x, y].map(({ field }) => playedAt(page.scene, field));
  const mark = typeof across === 'number' && typeof upwards === 'number' ? { x: across, y: upwards } : null;
  useLayoutEffect(() => {
    drawn.current = new MapPicture(box.current, settings);
  }, []);
  useLayoutEffect(() => {
    if (shown) picture().show(shown.settings, shown.grid);
  }, [shown]);
  useLayoutEffect(() => {
    picture().mark(mark);
  }, [across, upwards, shown]);
  useLayoutEffect(() => picture().redraw(), [task.count, task.active]);
  useEffect(() => offer(false), [task.words]);
  useKeptFocus(place);

  const now = useRef(mark);
  now.current = mark;
  /** The cell of the scene, if it is on the map. */
  const ownCell = () => now.current && picture().cellOf(now.current);
  const turn = (/** @type {Sides} */ sides) => page.part(sideParts(sides, usual));
  const look = (/** @type {Values} */ low, /** @type {Values} */ high) => {
    if (!grid) return;
    const sides = { x: partOf(x, low.x, high.x), y: partOf(y, low.y, high.y) };
    const isPoint = (/** @type {Side} */ { from, to }) => to - from <= Math.max(Math.abs(from), Math.abs(to)) * 1e-9;
    if (isPoint(sides.x) || isPoint(sides.y)) return task.say('This is as close as it goes.');
    views.current.push({ x, y });
    turn(sides);
  };
  /** Drops the scene with the values of a place: those of its cell on a finest map, so that the run is the cell’s own. */
  const drag = (/** @type {Values} */ values, /** @type {boolean} */ first) => {
    const { columns } = shown?.settings ?? settings;
    const cell = grid?.columns === columns ? grid.cellAround(values.x, values.y) : null;
    const rounded = (
      /** @type {Side} */ { field, from, to },
      /** @type {number} */ value,
      /** @type {number} */ count,
    ) => kept(Math.min(to, Math.max(from, Number(value.toFixed(decimalsOf((to - from) / count))))), field);
    dropped.current = {
      [x.field.field]: grid && cell ? grid.x(cell.column) : rounded(x, values.x, columns),
      [y.field.field]: grid && cell ? grid.y(cell.row) : rounded(y, values.y, rowsOf(columns)),
    };
    page.dropWith?.(dropped.current, first);
  };
  /** The scene stays where it was dropped: its cell is spoken, which a pointer’s way over the map is not. */
  const rest = () => {
    if (!page.dropWith) page.launch?.(dropped.current);
    const cell = ownCell();
    if (grid && cell) speak(cellWords(grid, cell));
    offer(isOfCatches(settings.quantity) && page.open !== undefined);
  };
  const listeners = usePointer(picture, {
    point: (cell) => {
      picture().point(cell);
      again({});
    },
    drag,
    rest,
    step: (columns, rows) => {
      const cell = ownCell();
      if (!grid || !cell) return;
      const within = (/** @type {number} */ value, /** @type {number} */ count) =>
        Math.min(count - 1, Math.max(0, value));
      const to = { x: within(cell.column + columns, grid.columns), y: within(cell.row + rows, grid.rows) };
      drag({ x: grid.x(to.x), y: grid.y(to.y) }, true);
      rest();
    },
    select: look,
    // Half of the map around the scene.
    closer: () => {
      const { frame } = picture();
      const { columns, rows } = grid ?? { columns: 2, rows: 2 };
      const { column, row } = ownCell() ?? { column: columns >> 1, row: rows >> 1 };
      const [left, right] = halfOf(frame.x, (column + 0.5) / columns);
      const [bottom, top] = halfOf(frame.y, (row + 0.5) / rows);
      look({ x: left, y: bottom }, { x: right, y: top });
    },
  });
  const cancel = () => task.stop('Cancelled.');
  /** To the view before, or cancels. */
  const back = () => {
    const view = views.current.pop();
    if (view) turn(view);
    else if (task.active) cancel();
  };
  const leave = (/** @type {KeyboardEvent} */ event) => {
    // In a list it closes the list.
    if (event.key !== 'Escape' || event.defaultPrevented || event.target instanceof HTMLSelectElement) return;
    if (views.current.length === 0 && !task.active) return;
    event.preventDefault();
    back();
  };
  /** Sides by the controls. */
  const set = (/** @type {Sides} */ sides) => {
    if (sides.x.field !== settings.x.field || sides.y.field !== settings.y.field) views.current = [];
    else views.current.push({ x: settings.x, y: settings.y });
    turn(sides);
  };
  const goOn = () => {
    const part = Object.entries(inUse(settings, 'catch.')).map(([name, value]) => [`catch.${name}`, String(value)]);
    page.open?.('catch', new URLSearchParams(part));
  };
  const controls = useMemo(
    () => html`<${MapControls} page=${page} map=${map} errors=${errors} turn=${set} />`,
    [page.fields, JSON.stringify([settings, usual]), errors, angles()],
  );
  const cell = drawn.current && (picture().cursor ?? ownCell());
  const read = !grid ? '' : !cell ? 'The scene lies outside of this map' : cellWords(grid, cell);
  const { words, active, count, progress, ended } = task;
  return html`<div class="stability-map" ref=${place} onKeyDown=${leave}>
    <div
      class="map-box"
      id="map-box"
      tabindex="0"
      role="application"
      aria-roledescription="map"
      aria-label=${grid ? labelOf(grid) : 'Stability map'}
      aria-describedby="map-hint"
      aria-busy=${String(active)}
      ref=${box}
      ...${listeners}
    />
    <output class="readout" id="map-readout" aria-live="off">${unbroken(read)}</output>
    <p class="unseen" id="map-spoken" role="status">${spoken}</p>
    <p class="map-legend">${grid && html`<${Legend} grid=${grid} />`}</p>
    <details class="map-options" id="map-options">
      <summary>Axes, colours, numbers</summary>
      <${Form} kind="map-controls" ask=${ask}>
        ${controls}
        <div class="map-go">
          <p class="buttons">
            <button type="submit" id="map-compute" class=${['', 'answered'].includes(ended) ? '' : 'attention'}>Compute</button>
            <button type="button" id="map-cancel" disabled=${!active} onClick=${cancel}>Cancel</button>
            <button type="button" id="map-back" disabled=${views.current.length === 0} onClick=${back}>Back</button>
          </p>
          <p class="map-progress">
            <progress id="map-progress" aria-label="Rows of the map" max=${progress?.of} value=${progress?.done} hidden=${!active} />
            <span class="muted">${count}</span>
          </p>
          <p class=${`map-told ${ended === 'failed' ? 'error' : ''}`} id="map-told" role="status">
            ${offered ? html`<button type="button" id="map-catch" onClick=${goOn}>Catch it</button>` : words}
          </p>
        </div>
      <//>
      <p class="muted" id="map-hint">${HINT}</p>
      <details onToggle=${(/** @type {{currentTarget: HTMLDetailsElement}} */ event) => sample(event.currentTarget.open)}>
        <summary>Numbers</summary>
        ${sampled && grid?.counts && html`<${Sample} grid=${grid} />`}
      </details>
      <p class="actions" id="map-links">${shown && html`<${Savings} id="map" title="Stability map" path=${`v1/regions?${shown.request}`} />`}</p>
    </details>
  </div>`;
}
