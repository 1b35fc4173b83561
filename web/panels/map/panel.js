// The stability map as a control: its point is the scene, and a drag of it drops the scene anew. It refines itself, and one can look closer.

import { Problem, wordsOf } from '../../api/client.js';
import { playedAt } from '../../api/scene-fields.js';
import { unbroken } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';
import { html, useEffect, useLayoutEffect, useMemo, useRef, useState } from '../../vendor/preact/preact.js';
import { QUIET_MS, useTask } from '../ask.js';
import { inUse, namesOf } from '../catch/settings.js';
import { Savings } from '../figures.js';
import { Form, NO_SCENE, useKeptFocus, useNear } from '../parts.js';
import { refusalOf, useWhole } from '../settings.js';
import { refine } from './grid.js';
import { MapPicture } from './picture.js';
import {
  MapControls,
  halfCell,
  isOfCatches,
  kept,
  rangesOf,
  readMap,
  requestQuery,
  rowsOf,
  sideParts,
} from './settings.js';
import { Legend, Sample, cellWords, decimalsOf, labelOf, mapWords, sceneWords } from './words.js';

/** @typedef {{x: number, y: number}} Values of the two fields */
/** The drawn cells, the request for them, that for the whole map, and the settings with the finest columns wanted. @typedef {{grid: Grid, request: URLSearchParams, whole: string, settings: MapSettings}} Shown */

const HINT =
  'Drag the point: the body drops from there. With Shift, drag a rectangle to look closer; Escape goes back. With keys: arrows move the point, with Shift ten cells, + looks closer.';

/** The rows that have arrived. @param {{done: number, of: number, columns: number}} progress */
const rowWords = ({ done, of, columns }) => `${done} / ${of} rows of ${columns} × ${of}`;

/** Part of a side, with ends as round as the picture is fine and within what the field may be. @param {Side} side @param {number} low @param {number} high @returns {Side} */
function partOf({ field }, low, high) {
  const decimals = decimalsOf((high - low) / 1000);
  const [from, to] = [low, high].map((end) => kept(Number(end.toFixed(decimals)), field));
  return { field, from, to };
}

/** @param {Interval} range @param {number} value */
const shareOf = ({ low, high }, value) => (value - low) / (high - low);

/** @param {Interval} range @param {number} share */
const valueAt = ({ low, high }, share) => low + share * (high - low);

/** The low end of a half of the map around a share of it. @param {number} share */
const halfAround = (share) => Math.min(0.5, Math.max(0, share - 0.25));

/** @param {number} share */
const percent = (share) => `${(100 * share).toFixed(3)}%`;

/** The middle and the size of a rectangle in the frame. @param {Rectangle} rectangle */
const styleOf = ({ low, high }) => ({
  left: percent((low.x + high.x) / 2),
  bottom: percent((low.y + high.y) / 2),
  width: percent(high.x - low.x),
  height: percent(high.y - low.y),
});

/**
 * Asks for a map when its settings or the scene have changed, as long as it is in sight.
 * @param {PanelPage} page
 * @param {MapSettings} settings
 * @param {boolean} near
 */
function useMap({ query, link }, settings, near) {
  const task = useTask('Computing', rowWords);
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const [errors, blame] = useState(/** @type {ProblemError[]} */ ([]));
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
    const own = (/** @type {Grid} */ grid, /** @type {URLSearchParams} */ of) =>
      show({ grid, request: of, whole: request, settings });
    const how = { unasked, heard: task.hear, show: own };
    const found = await task.run((signal) => refine(settings, query, { signal, ...how }), failed);
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
  return { task, shown, isOld: shown !== null && shown.whole !== request, errors, ask };
}

/** @param {{page: PanelPage}} props */
export function StabilityMap({ page }) {
  const map = readMap(page);
  const { settings, usual, broken } = map;
  useWhole(page, 'map', broken);
  const [place, near] = useNear();
  const { task, shown, isOld, errors, ask } = useMap(page, settings, near);
  const grid = shown?.grid ?? null;
  const [cells, frame] = [useRef(/** @type {any} */ (null)), useRef(/** @type {HTMLElement | null} */ (null))];
  const picture = useRef(/** @type {MapPicture | null} */ (null));
  const [spoken, speak] = useState('');
  const [pointed, point] = useState(/** @type {Place | null} */ (null));
  const [sampled, sample] = useState(false);
  /** True where the scene of a map of catches may go on in the tab Catch. */
  const [offered, offer] = useState(false);
  /** Views before this one. */
  const views = useRef(/** @type {Sides[]} */ ([]));
  /** The values of the last drop. */
  const dropped = useRef(/** @type {Record<string, number>} */ ({}));

  useLayoutEffect(() => {
    picture.current = new MapPicture(cells.current, settings);
  }, []);
  useLayoutEffect(() => {
    if (shown) picture.current?.show(shown.settings, shown.grid);
  }, [shown]);
  useLayoutEffect(() => picture.current?.redraw(), [task.count, task.active]);
  useEffect(() => offer(false), [task.words]);
  useKeptFocus(place);

  const { x, y } = grid?.settings ?? settings;
  const drawn = shown?.settings ?? settings;
  const ranges = rangesOf(drawn);
  const valuesAt = (/** @type {Place} */ at) => ({ x: valueAt(ranges.x, at.x), y: valueAt(ranges.y, at.y) });
  const placeOf = (/** @type {Values} */ values) => ({
    x: shareOf(ranges.x, values.x),
    y: shareOf(ranges.y, values.y),
  });
  /** The cell at a place, if there is one. */
  const cellAt = (/** @type {Place | null} */ at) =>
    grid && at && isInside(at) ? grid.cellAround(valuesAt(at)) : null;
  /** @param {import('./words.js').Cell} cell */
  const boxOf = ({ column, row }) => {
    const at = /** @type {Grid} */ (grid);
    const [dx, dy] = [halfCell(x, at.columns), halfCell(y, at.rows)];
    const low = placeOf({ x: at.x(column) - dx, y: at.y(row) - dy });
    return { low, high: placeOf({ x: at.x(column) + dx, y: at.y(row) + dy }) };
  };
  const [across, upwards] = [x, y].map(({ field }) => playedAt(page.scene, field));
  /** The place of the scene, which may be outside. */
  const mark = typeof across === 'number' && typeof upwards === 'number' ? placeOf({ x: across, y: upwards }) : null;
  const turn = (/** @type {Sides} */ sides) => page.part(sideParts(sides, usual));
  const look = (/** @type {Rectangle} */ rectangle) => {
    if (!grid) return;
    const [low, high] = [valuesAt(rectangle.low), valuesAt(rectangle.high)];
    const sides = { x: partOf(x, low.x, high.x), y: partOf(y, low.y, high.y) };
    const isPoint = (/** @type {Side} */ { from, to }) => to - from <= Math.max(Math.abs(from), Math.abs(to)) * 1e-9;
    if (isPoint(sides.x) || isPoint(sides.y)) return task.say('This is as close as it goes.');
    views.current.push({ x, y });
    turn(sides);
  };
  /** Drops the scene with the values of a place: those of its cell on a finest map, so that the run is the cell’s own. */
  const drag = (/** @type {Values} */ values, /** @type {boolean} */ first) => {
    const { columns } = drawn;
    const cell = grid?.columns === columns ? grid.cellAround(values) : null;
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
    if (!grid) return;
    if (!page.dropWith) page.launch?.(dropped.current);
    const { [x.field.field]: atX, [y.field.field]: atY } = dropped.current;
    const cell = cellAt(placeOf({ x: atX, y: atY }));
    if (cell) speak(cellWords(grid, cell));
    offer(isOfCatches(settings.quantity) && page.open !== undefined);
  };
  const { selection, ...listeners } = usePointer(frame, {
    point,
    drag: (at, first) => grid && drag(valuesAt(at), first),
    rest,
    step: (columns, rows) => {
      const cell = cellAt(mark);
      if (!grid || !cell) return;
      const within = (/** @type {number} */ value, /** @type {number} */ count) =>
        Math.min(count - 1, Math.max(0, value));
      const to = { x: within(cell.column + columns, grid.columns), y: within(cell.row + rows, grid.rows) };
      drag({ x: grid.x(to.x), y: grid.y(to.y) }, true);
      rest();
    },
    look,
    closer: () => {
      const { columns, rows } = grid ?? { columns: 2, rows: 2 };
      const { column, row } = cellAt(mark) ?? { column: columns >> 1, row: rows >> 1 };
      const low = { x: halfAround((column + 0.5) / columns), y: halfAround((row + 0.5) / rows) };
      look({ low, high: { x: low.x + 0.5, y: low.y + 0.5 } });
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
  const { words, active, count, progress, ended } = task;
  const cursor = cellAt(pointed);
  const own = mark && cellAt(mark);
  /** The cell at the pointer, else the scene in its own. */
  const read = () => {
    if (!grid) return '';
    if (isOld) return active ? 'Computing…' : '';
    if (cursor) return cellWords(grid, cursor);
    return own
      ? sceneWords(grid, own, { x: Number(across), y: Number(upwards) })
      : 'The scene lies outside of this map';
  };
  return html`<div class=${`stability-map ${isOld ? 'old' : ''}`} ref=${place} onKeyDown=${leave}>
    <div class="map-box" id="map-box" tabindex="0" role="application" aria-roledescription="map"
      aria-label=${grid ? labelOf(grid) : 'Stability map'} aria-describedby="map-hint" aria-busy=${String(active)}
      ...${listeners}>
      <div class="map-cells" ref=${cells} />
      <div class="map-frame" ref=${frame} aria-hidden="true">
        ${cursor && !selection && html`<span class="map-cursor" style=${styleOf(boxOf(cursor))} />`}
        ${selection && html`<span class="map-cursor selection" style=${styleOf(selection)} />`}
        ${mark && html`<span class="map-point" style=${{ left: percent(mark.x), bottom: percent(mark.y) }} />`}
      </div>
    </div>
    <output class="readout" id="map-readout" aria-live="off">${unbroken(read())}</output>
    <p class="unseen" id="map-spoken" role="status">${spoken}</p>
    <p class="map-legend row">${grid && html`<${Legend} grid=${grid} />`}</p>
    <details class="map-options" id="map-options">
      <summary>Axes, colours, numbers</summary>
      <${Form} kind="map-controls" ask=${ask}>
        ${controls}
        <div class="map-go">
          <p class="row">
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

// Pointer and keys: drag the point of the scene, select a rectangle with Shift, look closer.

/** A place as shares of the frame around the cells, from its lower left corner. @typedef {{x: number, y: number}} Place */
/** Two corners, the lower left one first. @typedef {{low: Place, high: Place}} Rectangle */

/**
 * @typedef {object} PointerActions
 * @property {(place: Place | null) => void} point at a place, without a press
 * @property {(place: Place, first: boolean) => void} drag the scene there
 * @property {() => void} rest the drag has ended
 * @property {(columns: number, rows: number) => void} step moves the scene by so many cells
 * @property {(rectangle: Rectangle) => void} look at a part of the map
 * @property {() => void} closer looks at half of the map around the scene
 */

/** A rectangle thinner than this is none, px. */
const THINNEST = 8;

const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @param {number} share */
const within = (share) => Math.min(1, Math.max(0, share));

/** True for a place in the frame. @param {Place} place */
const isInside = ({ x, y }) => x >= 0 && x < 1 && y >= 0 && y < 1;

/** Listeners for the box of a map, and what is selected in it. @param {{current: HTMLElement | null}} frame around the cells @param {PointerActions} actions */
function usePointer(frame, actions) {
  const pressed = useRef(/** @type {Place & {id: number, selects: boolean} | null} */ (null));
  const [selection, select] = useState(/** @type {Rectangle | null} */ (null));
  const size = () => /** @type {HTMLElement} */ (frame.current).getBoundingClientRect();
  const placeOf = (/** @type {PointerEvent} */ { clientX, clientY }) => {
    const { left, bottom, width, height } = size();
    return { x: (clientX - left) / width, y: (bottom - clientY) / height };
  };
  const release = (/** @type {{currentTarget: HTMLElement}} */ { currentTarget: box }) => {
    const { id = -1 } = pressed.current ?? {};
    if (box.hasPointerCapture(id)) box.releasePointerCapture(id);
    pressed.current = null;
    select(null);
  };
  /** @typedef {PointerEvent & {currentTarget: HTMLElement}} Pointed */
  return {
    selection,
    onPointerDown: (/** @type {Pointed} */ event) => {
      const { currentTarget: box, button, isPrimary, pointerId: id, shiftKey: selects } = event;
      const at = placeOf(event);
      if (button !== 0 || !isPrimary || !isInside(at)) return;
      pressed.current = { ...at, id, selects };
      box.setPointerCapture(id);
      actions.point(null);
      if (!selects) actions.drag(at, true);
    },
    onPointerMove: (/** @type {Pointed} */ event) => {
      const at = placeOf(event);
      if (!pressed.current) return actions.point(isInside(at) ? at : null);
      const { x, y, selects } = pressed.current;
      const to = { x: within(at.x), y: within(at.y) };
      if (!selects) return actions.drag(to, false);
      select({
        low: { x: Math.min(x, to.x), y: Math.min(y, to.y) },
        high: { x: Math.max(x, to.x), y: Math.max(y, to.y) },
      });
    },
    onPointerUp: (/** @type {Pointed} */ event) => {
      if (!pressed.current) return;
      const { selects } = pressed.current;
      release(event);
      if (!selects) return actions.rest();
      if (!selection) return;
      const { low, high } = selection;
      const { width, height } = size();
      if ((high.x - low.x) * width >= THINNEST && (high.y - low.y) * height >= THINNEST) actions.look(selection);
    },
    onPointerCancel: release,
    onPointerLeave: () => {
      if (!pressed.current) actions.point(null);
    },
    onKeyDown: (/** @type {KeyboardEvent & {currentTarget: HTMLElement}} */ event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const far = event.shiftKey ? 10 : 1;
      const step = STEPS[/** @type {keyof typeof STEPS} */ (event.key)];
      if (step) actions.step(far * step[0], far * step[1]);
      else if (event.key === '+' || event.key === '=') actions.closer();
      else if (event.key === 'Escape' && pressed.current) release(event);
      else return;
      event.preventDefault();
      event.stopPropagation();
    },
  };
}
