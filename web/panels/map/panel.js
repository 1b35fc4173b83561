// The stability map as a control: its point is the scene, and a drag of it drops the scene anew. It refines itself, and one can look closer.

import { Problem, wordsOf } from '../../api/client.js';
import { playedAt } from '../../api/scene-fields.js';
import { invalidate } from '../../charts/surface.js';
import { debounce } from '../../dom/debounce.js';
import { byId } from '../../dom/elements.js';
import { unbroken } from '../../dom/numbers.js';
import { inWords } from '../../dom/typeset.js';
import { UNITS } from '../../dom/units.js';
import { actions } from '../../export/save-actions.js';
import { html, render } from '../../vendor/preact/preact.js';
import { inUse } from '../catch/settings.js';
import { NO_SCENE, Nodes } from '../parts.js';
import { MapControls, Progress, elsewhere } from './controls.js';
import { MapPicture } from './picture.js';
import { listen } from './pointer.js';
import { Refinement } from './refinement.js';
import {
  isOfCatches,
  kept,
  readSettings,
  requestQuery,
  rowsOf,
  sameSides,
  settingsQuery,
  usualSides,
} from './settings.js';
import { Legend, MapWords, decimalsOf } from './words.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {import('./picture.js').Cell} Cell */
/** @typedef {import('../card.js').PanelPage} PanelPage */

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page, link) => new MapPanel(root, page, link);

const HINT =
  'Drag the point: the body drops from there. With Shift, drag a rectangle to look closer; Escape goes back. With keys: arrows move the point, with Shift ten cells, + looks closer.';

class MapPanel {
  #root;
  #page;
  /** @type {Settings} */
  #settings;
  /** The sides that the scene usually has. */
  #usual;
  #picture;
  #words;
  #refinement;
  /** The drawn cells. @type {Grid | null} */
  #grid = null;
  /** The settings asked for last, with the finest columns wanted. @type {Settings} */
  #target;
  /** The request made last, whatever became of it. */
  #asked = '';
  /** Views before this one. @type {import('./settings.js').Sides[]} */
  #views = [];
  #near = true;
  /** The values of the last drop. @type {Record<string, number>} */
  #dropped = {};
  #notice = '';
  /** On the answer; `said` has nothing to do. @type {{words: string, manner: 'said' | 'wrong' | 'stale'}} */
  #told = { words: '', manner: 'said' };
  /** @type {import('contract').ProblemError[]} */
  #errors = [];
  /** @type {import('./refinement.js').Progress | null} */
  #progress = null;
  #busy = false;
  /** Actions that save the map. @type {Node[]} */
  #links = [];
  #label = 'Stability map';
  /** The table of some cells is open. */
  #sampled = false;
  #catchOffered = false;
  /** The controls as they were drawn last. @type {unknown} */
  #controls = null;

  /** @param {HTMLElement} root @param {PanelPage} page @param {URLSearchParams} link */
  constructor(root, page, link) {
    this.#root = root;
    this.#page = page;
    this.#usual = usualSides(page.scene());
    this.#settings = readSettings(link, page.fields, this.#usual).settings;
    this.#target = this.#settings;
    this.#words = new MapWords(page.fields);
    this.#refinement = new Refinement({
      show: (pass) => this.#show(pass),
      row: () => {
        this.#picture.redraw();
        invalidate(this);
      },
      busy: (progress) => {
        this.#busy = progress !== null;
        this.#progress = progress ?? this.#progress;
        if (this.#busy) invalidate(this);
        else this.draw();
      },
      whole: (grid, refused) => this.#finish(grid, refused),
      waits: ({ columns }) =>
        this.#say(`${columns} × ${rowsOf(columns)} cells take a while: Compute asks for them.`, 'stale'),
      failed: (error, pass) => this.#fail(error, pass),
      wanted: () => this.#near,
    });
    this.draw();
    const box = byId('map-box');
    this.#picture = new MapPicture(box, this.#settings, this.#axes(this.#settings));
    listen(box, this.#picture, {
      point: (cell) => {
        this.#picture.point(cell);
        this.#read();
      },
      drag: (values, first) => this.#drag(values, first),
      rest: () => this.#rest(),
      step: (columns, rows) => this.#step(columns, rows),
      select: (from, to) => this.#look(from, to),
      closer: () => this.#closer(),
    });
    root.addEventListener('keydown', (event) => {
      // In a list it closes the list.
      if (event.key !== 'Escape' || event.defaultPrevented || event.target instanceof HTMLSelectElement) return;
      if (this.#views.length === 0 && !this.#refinement.active) return;
      event.preventDefault();
      this.#back();
    });
    document.addEventListener(UNITS, () => {
      this.#controls = null;
      this.draw();
      this.#read();
    });
    new IntersectionObserver(
      (entries) => {
        const { isIntersecting, boundingClientRect } = entries[entries.length - 1];
        this.#near = isIntersecting;
        if (isIntersecting) this.#refresh();
        // Its tab is closed; opening it goes on with the work.
        else if (boundingClientRect.width === 0 && this.#refinement.active) {
          this.#refinement.cancel();
          this.#asked = '';
        }
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  /** Draws all but the picture. */
  draw() {
    const focused = document.activeElement;
    const [grid, progress, { words, manner }] = [this.#grid, this.#progress, this.#told];
    this.#controls ??= html`<${MapControls}
      fields=${this.#page.fields}
      settings=${this.#settings}
      errors=${this.#errors}
      changed=${(/** @type {Settings} */ settings) => this.#set(settings)}
    />`;
    const offer = html`<button type="button" id="map-catch" onClick=${() => this.#catch()}>Catch it</button>`;
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      void this.#ask();
    };
    render(
      html`<p class="error" id="map-notice">${this.#notice}</p>
        <div
          class="map-box"
          id="map-box"
          tabindex="0"
          role="application"
          aria-roledescription="map"
          aria-label=${this.#label}
          aria-describedby="map-hint"
          aria-busy=${String(this.#busy)}
        />
        <output class="readout" id="map-readout" aria-live="off" />
        <p class="unseen" id="map-spoken" role="status" />
        <p class="map-legend">${grid && html`<${Legend} grid=${grid} />`}</p>
        <details class="map-options" id="map-options">
          <summary>Axes, colours, numbers</summary>
          <form class="map-controls" novalidate onSubmit=${submit}>
            ${this.#controls}
            <div class="map-go">
              <p class="buttons">
                <button type="submit" id="map-compute" class=${manner === 'said' ? '' : 'attention'}>Compute</button>
                <button type="button" id="map-cancel" disabled=${!this.#busy} onClick=${() => this.#cancel()}>
                  Cancel
                </button>
                <button type="button" id="map-back" disabled=${this.#views.length === 0} onClick=${() => this.#back()}>
                  Back
                </button>
              </p>
              <${Progress} progress=${progress} busy=${this.#busy} />
              <p class=${`map-told ${manner === 'wrong' ? 'error' : ''}`} id="map-told" role="status">
                ${this.#catchOffered ? offer : words}
              </p>
            </div>
          </form>
          <p class="muted" id="map-hint">${HINT}</p>
          <details onToggle=${(/** @type {{currentTarget: HTMLDetailsElement}} */ event) => {
            this.#sampled = event.currentTarget.open;
            this.draw();
          }}>
            <summary>Numbers</summary>
            ${this.#sampled && grid?.counts && this.#words.table(grid)}
          </details>
          <${Nodes} tag="p" class="actions" id="map-links" nodes=${this.#links} />
        </details>`,
      this.#root,
    );
    // A disabled button loses the focus.
    if (focused instanceof HTMLButtonElement && focused.disabled && this.#root.contains(focused))
      byId('map-compute').focus();
    return false;
  }

  /** @param {string} words @param {'said' | 'wrong' | 'stale'} [manner] */
  #say(words, manner = 'said') {
    this.#told = { words, manner };
    this.#catchOffered = false;
    this.draw();
  }

  /** Takes other settings, and what was wrong with those before is void. @param {Settings} settings */
  #take(settings) {
    this.#settings = settings;
    this.#blame([]);
  }

  /** @param {import('contract').ProblemError[]} errors */
  #blame(errors) {
    this.#errors = errors;
    this.#controls = null;
    this.draw();
  }

  /** @param {Settings} settings */
  #axes({ x, y }) {
    return { x: this.#words.axis(x), y: this.#words.axis(y) };
  }

  /** The map’s part of the page’s address. */
  query() {
    return settingsQuery(this.#settings, this.#usual);
  }

  /** Names what it drops in its own place. @param {URLSearchParams} link @returns {string[]} */
  restore(link) {
    this.#usual = usualSides(this.#page.scene());
    const { settings, dropped } = readSettings(link, this.#page.fields, this.#usual);
    this.#views = [];
    this.#notice = dropped.length > 0 ? `The map of this link was not whole. Dropped: ${dropped.join('; ')}.` : '';
    this.#take(settings);
    this.#mark();
    this.#refresh();
    return [];
  }

  /** The scene of the page is another one. Its usual sides take the place of those before, unless somebody has chosen others. */
  sceneChanged() {
    const usual = usualSides(this.#page.scene());
    const own = !sameSides(this.#settings, this.#usual);
    const same = sameSides(usual, this.#usual);
    this.#usual = usual;
    if (!own && !same) this.#take({ ...this.#settings, ...usual });
    this.#mark();
    this.#refreshSoon();
  }

  #refreshSoon = debounce(300, () => this.#refresh());

  /** Asks if what there is answers another request. */
  #refresh() {
    if (this.#near && this.#request() !== this.#asked) void this.#ask(this.#asked !== '');
  }

  #request() {
    const scene = this.#page.query();
    return scene ? String(requestQuery(this.#settings, scene)) : 'none';
  }

  async #ask(unasked = false) {
    const scene = this.#page.query();
    this.#asked = this.#request();
    if (!scene) {
      this.#refinement.cancel();
      return this.#say(NO_SCENE, 'wrong');
    }
    this.#say('');
    this.#target = this.#settings;
    // It goes on when it is seen again.
    if (!(await this.#refinement.ask(this.#target, scene, unasked))) this.#asked = '';
  }

  /** @param {unknown} error @param {import('./refinement.js').Progress} pass */
  #fail(error, { arrived, rows }) {
    const errors = error instanceof Problem ? error.errors : [];
    const words =
      errors.length > 0
        ? elsewhere(errors, this.#settings)
            .map(({ detail }) => inWords(detail))
            .join(' ')
        : wordsOf(error);
    const there = arrived > 0 ? `${words} ${arrived} of ${rows} rows are there.` : words;
    this.#say(there || 'There is no such map; see what is marked.', 'wrong');
    this.#blame(errors);
  }

  #cancel() {
    if (!this.#refinement.active) return;
    this.#refinement.cancel();
    this.#say('Cancelled.', 'stale');
  }

  /** @param {import('./refinement.js').Pass} pass */
  #show({ grid, request }) {
    this.#grid = grid;
    this.#picture.show(this.#target, this.#axes(grid.settings), grid);
    const formats = ['svg', 'png', 'csv', 'arrow', 'json'];
    this.#links = actions({ id: 'map', title: 'Stability map', path: `v1/regions?${request}`, formats });
    this.draw();
    this.#mark();
  }

  /** @param {Grid} grid whole @param {Problem | null} refused */
  #finish(grid, refused) {
    this.#picture.redraw();
    this.#progress = { arrived: grid.arrived, rows: grid.rows, columns: grid.columns };
    this.#label = this.#words.label(grid);
    const why = refused ? ` Finer than that the server refuses: ${refused.message}.` : '';
    this.#say(this.#words.told(grid) + why);
    this.#read();
  }

  #mark() {
    const scene = this.#page.scene();
    const { x, y } = this.#grid?.settings ?? this.#settings;
    const [across, upwards] = [x, y].map(({ parameter }) => {
      const field = this.#words.field(parameter);
      return field && playedAt(scene, field);
    });
    this.#picture.mark(typeof across === 'number' && typeof upwards === 'number' ? { x: across, y: upwards } : null);
    if (!this.#picture.cursor) this.#read();
  }

  /** Shows the values of the pointed cell, or of the scene’s own where none is pointed at. */
  #read() {
    const grid = this.#grid;
    const cell = this.#picture.cursor ?? this.#picture.cellOfMark();
    const words = !grid ? '' : !cell ? 'The scene lies outside of this map' : this.#words.cell(grid, cell);
    byId('map-readout').textContent = unbroken(words);
  }

  /** Drops the scene with the values of a place: those of its cell on a finest map, so that the run is the cell’s own. @param {{x: number, y: number}} values @param {boolean} first of a drag */
  #drag(values, first) {
    const { x, y, columns } = this.#target;
    const cell = this.#grid?.columns === columns ? this.#grid.cellAround(values.x, values.y) : null;
    /** @param {Side} side @param {number} value @param {number} count */
    const rounded = (side, value, count) => {
      const near = Number(value.toFixed(decimalsOf((side.to - side.from) / count)));
      return kept(Math.min(side.to, Math.max(side.from, near)), this.#words.field(side.parameter));
    };
    this.#dropped = {
      [x.parameter]: cell ? (this.#grid?.x(cell.column) ?? 0) : rounded(x, values.x, columns),
      [y.parameter]: cell ? (this.#grid?.y(cell.row) ?? 0) : rounded(y, values.y, rowsOf(columns)),
    };
    this.#page.drop?.(this.#dropped, first);
  }

  /** The scene stays where it was dropped: its cell is spoken, which a pointer’s way over the map is not. */
  #rest() {
    if (!this.#page.drop) this.#page.launch(this.#dropped);
    const cell = this.#picture.cellOfMark();
    if (this.#grid && cell) byId('map-spoken').textContent = this.#words.cell(this.#grid, cell);
    this.#catchOffered = isOfCatches(this.#settings.quantity) && this.#page.open !== undefined;
    this.draw();
  }

  /** Moves the scene by cells. @param {number} columns @param {number} rows */
  #step(columns, rows) {
    const grid = this.#grid;
    const cell = this.#picture.cellOfMark();
    if (!grid || !cell) return;
    const within = (/** @type {number} */ value, /** @type {number} */ count) =>
      Math.min(count - 1, Math.max(0, value));
    const x = grid.x(within(cell.column + columns, grid.columns));
    this.#drag({ x, y: grid.y(within(cell.row + rows, grid.rows)) }, true);
    this.#rest();
  }

  /** Goes on in the tab Catch with the settings of a map of catches. */
  #catch() {
    const part = Object.entries(inUse(this.#settings.catch)).map(([name, value]) => [`catch.${name}`, String(value)]);
    this.#page.open?.('catch', new URLSearchParams(part));
  }

  /** @param {Settings} settings by the controls */
  #set(settings) {
    const before = this.#settings;
    if (settings.x.parameter !== before.x.parameter || settings.y.parameter !== before.y.parameter) this.#views = [];
    else if (!sameSides(settings, before)) this.#views.push({ x: before.x, y: before.y });
    this.#turn(settings);
  }

  /** @param {Settings} settings */
  #turn(settings) {
    this.#take(settings);
    this.#page.changed();
    void this.#ask();
  }

  /** Looks at half of the map around the scene. */
  #closer() {
    const { x, y } = this.#picture.frame;
    const { columns, rows } = this.#grid ?? { columns: 2, rows: 2 };
    const { column, row } = this.#picture.cellOfMark() ?? { column: columns >> 1, row: rows >> 1 };
    /** @param {import('../../charts/axes.js').Range} range @param {number} share */
    const half = ({ low, high }, share) => {
      const from = Math.min(0.5, Math.max(0, share - 0.25));
      return [from, from + 0.5].map((end) => low + (high - low) * end);
    };
    const [[left, right], [bottom, top]] = [half(x, (column + 0.5) / columns), half(y, (row + 0.5) / rows)];
    this.#look({ x: left, y: bottom }, { x: right, y: top });
  }

  /** @param {{x: number, y: number}} low @param {{x: number, y: number}} high */
  #look(low, high) {
    if (!this.#grid) return;
    const { x, y } = this.#grid.settings;
    const settings = { ...this.#settings, x: this.#part(x, low.x, high.x), y: this.#part(y, low.y, high.y) };
    const isPoint = (/** @type {Side} */ { from, to }) => to - from <= Math.max(Math.abs(from), Math.abs(to)) * 1e-9;
    if (isPoint(settings.x) || isPoint(settings.y)) return this.#say('This is as close as it goes.');
    this.#views.push({ x, y });
    this.#turn(settings);
  }

  /** Part of a side, with ends as round as the picture is fine and within what the field may be. @param {Side} side @param {number} low @param {number} high */
  #part({ parameter }, low, high) {
    const decimals = decimalsOf((high - low) / 1000);
    const [from, to] = [low, high].map((end) => kept(Number(end.toFixed(decimals)), this.#words.field(parameter)));
    return { parameter, from, to };
  }

  /** To the view before, or cancels. */
  #back() {
    const view = this.#views.pop();
    if (view) this.#turn({ ...this.#settings, ...view });
    else this.#cancel();
  }
}
