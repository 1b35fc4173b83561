// The stability map as a control: its point is the scene, and a drag of it drops the scene anew. It refines itself, and one can look closer.

import { MapControls } from './controls.js';
import { MapPicture } from './picture.js';
import { CLASSES, expected } from './classes.js';
import { MapWords, percent } from './words.js';
import { Problem } from '../../api/client.js';
import { Refinement } from './refinement.js';
import { UNITS } from '../../dom/units.js';
import { playedAt } from '../../api/scene-fields.js';
import { actions } from '../../export/save-actions.js';
import { QUANTITIES, isOfCatches, readSettings, requestQuery, rowsOf, settingsQuery, usualSides } from './settings.js';
import { h } from '../../dom/elements.js';
import { NO_SCENE } from '../study.js';
import { debounce } from '../../dom/debounce.js';
import { listen } from './pointer.js';
import { unbroken } from '../../dom/numbers.js';

/** @typedef {import('./grid.js').Grid} Grid */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./picture.js').Cell} Cell */

/** @typedef {import('../card.js').PanelPage} PanelPage */

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page, link) => new MapPanel(root, page, link);

class MapPanel {
  #page;
  /** @type {Settings} */
  #settings;
  /** The sides that the scene usually has. */
  #usual;
  #controls;
  #picture;
  #words;
  #refinement;
  #box = h('div', {
    class: 'map-box',
    id: 'map-box',
    tabindex: 0,
    role: 'application',
    'aria-roledescription': 'map',
    'aria-label': 'Stability map',
    'aria-describedby': 'map-hint',
  });
  #readout = h('output', { class: 'readout', id: 'map-readout', 'aria-live': 'off' });
  // Spoken when keys move the cursor; a pointer’s way over the map is not.
  #spoken = h('p', { class: 'unseen', role: 'status' });
  #notice = h('p', { class: 'error', id: 'map-notice' });
  #legend = h('p', { class: 'map-legend' });
  #links = h('p', { class: 'actions', id: 'map-links' });
  #sampled = h('details', { toggle: () => this.#tabulate() }, h('summary', {}, 'Numbers'));
  /** The drawn cells. @type {Grid | null} */
  #grid = null;
  /** The settings asked for last, with the finest columns wanted. @type {Settings} */
  #target;
  /** The request made last, whatever became of it. */
  #asked = '';
  /** Views before this one. @type {Pick<Settings, 'x' | 'y'>[]} */
  #views = [];
  #near = true;

  /**
   * @param {HTMLElement} root
   * @param {PanelPage} page
   * @param {URLSearchParams} link
   */
  constructor(root, page, link) {
    this.#page = page;
    this.#usual = usualSides(page.scene());
    this.#settings = readSettings(link, page.fields, this.#usual).settings;
    this.#target = this.#settings;
    this.#words = new MapWords(page.fields);
    this.#refinement = new Refinement({
      show: (pass) => this.#show(pass),
      row: () => this.#picture.redraw(),
      busy: (progress) => this.#busy(progress),
      whole: (grid, refused) => this.#finish(grid, refused),
      waits: ({ columns }) =>
        this.#controls.say([`${columns} × ${rowsOf(columns)} cells take a while: Compute asks for them.`], 'stale'),
      failed: (error, pass) => this.#fail(error, pass),
      wanted: () => this.#near,
    });
    this.#controls = new MapControls(page.fields, this.#settings, {
      changed: (settings) => this.#set(settings),
      compute: () => void this.#ask(),
      cancel: () => this.#cancel(),
      back: () => this.#back(),
    });
    root.append(
      this.#notice,
      this.#box,
      this.#readout,
      this.#spoken,
      this.#legend,
      h(
        'details',
        { class: 'map-options', id: 'map-options' },
        h('summary', {}, 'Axes, colours, numbers'),
        this.#controls.element,
        h(
          'p',
          { class: 'muted', id: 'map-hint' },
          'Drag the point: the body drops from there. With Shift, drag a rectangle to look closer; Escape goes back. With keys: arrows move the point, with Shift ten cells, + looks closer.',
        ),
        this.#sampled,
        this.#links,
      ),
    );
    this.#picture = new MapPicture(this.#box, this.#settings, this.#words.axes(this.#settings));
    listen(this.#box, this.#picture, {
      point: (cell) => {
        this.#picture.cursor = cell;
        this.#picture.point();
        this.#read(cell);
      },
      drag: (values, turn) => this.#drag(values, turn),
      step: (columns, rows) => this.#step(columns, rows),
      select: (from, to) => this.#closer(from, to),
      place: () => this.#cellOfScene(),
    });
    root.addEventListener('keydown', (event) => {
      // In a list it closes the list.
      if (event.key === 'Escape' && !event.defaultPrevented && !(event.target instanceof HTMLSelectElement))
        if (this.#leave()) event.preventDefault();
    });
    document.addEventListener(UNITS, () => {
      this.#tabulate();
      this.#read(this.#picture.cursor);
    });
    new IntersectionObserver(
      (entries) => {
        const { isIntersecting, boundingClientRect } = entries[entries.length - 1];
        this.#near = isIntersecting;
        if (isIntersecting) this.#refresh();
        else if (boundingClientRect.width === 0) this.#leaveOff();
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  /** Stops the work while the map's tab is closed; opening the tab goes on with it. */
  #leaveOff() {
    if (!this.#refinement.active) return;
    this.#refinement.cancel();
    this.#asked = '';
  }

  /** The map’s part of the page’s address. */
  query() {
    return settingsQuery(this.#settings, this.#usual);
  }

  /** Names what it drops in its own place. @param {URLSearchParams} link @returns {string[]} */
  restore(link) {
    this.#usual = usualSides(this.#page.scene());
    const { settings, dropped } = readSettings(link, this.#page.fields, this.#usual);
    this.#settings = settings;
    this.#views = [];
    this.#controls.show(settings);
    this.#controls.canGoBack(false);
    this.#mark();
    this.#refresh();
    this.#notice.textContent =
      dropped.length > 0 ? `The map of this link was not whole. Dropped: ${dropped.join('; ')}.` : '';
    return [];
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#suit();
    this.#mark();
    this.#refreshSoon();
  }

  /** Takes the usual sides of another scene, unless somebody has chosen others. */
  #suit() {
    const usual = usualSides(this.#page.scene());
    const own = JSON.stringify([this.#settings.x, this.#settings.y]);
    const before = JSON.stringify([this.#usual.x, this.#usual.y]);
    if (own === before && before !== JSON.stringify([usual.x, usual.y])) {
      this.#settings = { ...this.#settings, ...structuredClone(usual) };
      this.#controls.show(this.#settings);
    }
    this.#usual = usual;
  }

  #refreshSoon = debounce(300, () => this.#refresh());

  /** Asks if what there is answers another request. */
  #refresh() {
    const request = this.#request();
    if (this.#near && String(request) !== this.#asked) void this.#ask(this.#asked !== '');
  }

  #request() {
    const scene = this.#page.query();
    return scene && requestQuery(this.#settings, scene);
  }

  async #ask(unasked = false) {
    const scene = this.#page.query();
    this.#asked = String(this.#request());
    if (!scene) {
      this.#refinement.cancel();
      return this.#controls.say([NO_SCENE], 'wrong');
    }
    this.#controls.say([]);
    const settings = structuredClone(this.#settings);
    this.#target = settings;
    const seen = await this.#refinement.ask(settings, scene, unasked);
    // It goes on when it is seen again.
    if (!seen) this.#asked = '';
  }

  /** @param {{arrived: number, rows: number, columns: number} | null} progress */
  #busy(progress) {
    this.#controls.busy(progress);
    this.#box.setAttribute('aria-busy', String(progress !== null));
  }

  /** @param {unknown} error @param {{arrived: number, rows: number}} pass */
  #fail(error, { arrived, rows }) {
    const problem = error instanceof Problem ? error : null;
    const elsewhere = this.#controls.blame(problem?.errors ?? []);
    const words = problem
      ? problem.errors.length === 0
        ? problem.message
        : elsewhere.join(' ')
      : 'The server does not answer.';
    const there = arrived > 0 ? `${words} ${arrived} of ${rows} rows are there.` : words;
    this.#controls.say([there || 'There is no such map; see what is marked.'], 'wrong');
  }

  #cancel() {
    if (!this.#refinement.active) return;
    this.#refinement.cancel();
    this.#controls.say(['Cancelled.'], 'stale');
  }

  /** @param {import('./refinement.js').Pass} pass */
  #show({ grid, request, under }) {
    this.#grid = grid;
    this.#picture.show(this.#target, this.#words.axes(grid.settings), grid, under);
    this.#mark();
    this.#links.replaceChildren(
      ...actions({
        id: 'map',
        title: 'Stability map',
        path: `v1/regions?${request}`,
        formats: ['svg', 'png', 'csv', 'arrow', 'json'],
      }),
    );
    this.#explain();
    if (!this.#picture.cursor) this.#read(null);
  }

  /** Explains colours and lines. */
  #explain() {
    const grid = this.#grid;
    if (!grid) return;
    const swatch = (/** @type {string} */ kind, /** @type {string} */ words) =>
      h('span', {}, h('span', { class: `swatch ${kind}`, 'aria-hidden': 'true' }), words);
    const has = (/** @type {number} */ residue) => grid.limitCurves.some((segment) => segment.residue === residue);
    const shares = new Map(grid.shares());
    const kinds = new Set([...expected(grid.settings.quantity), ...shares.keys()]);
    const classes = grid.classes
      ? [...kinds].map((kind) => {
          const share = shares.get(kind);
          return swatch(kind, share === undefined ? CLASSES[kind].name : `${CLASSES[kind].name} ${percent(share)}`);
        })
      : [];
    const others = [
      (has(1) || has(0)) && swatch('limit', 'limit for small angles'),
      grid.lacks && swatch('none', lacking(grid.settings.quantity)),
    ];
    this.#legend.replaceChildren(...classes, ...others.filter((one) => one !== false));
  }

  /** @param {Grid} grid whole @param {Problem | null} refused */
  #finish(grid, refused) {
    this.#picture.redraw();
    this.#explain();
    this.#controls.count({ arrived: grid.arrived, rows: grid.rows, columns: grid.columns });
    const why = refused ? ` Finer than that the server refuses: ${refused.message}.` : '';
    this.#controls.say([`${this.#words.told(grid)}${why}`]);
    this.#box.setAttribute('aria-label', this.#words.label(grid));
    this.#read(this.#picture.cursor);
    this.#tabulate();
  }

  /** The table of some cells, while it is open. */
  #tabulate() {
    if (!this.#grid?.counts || !(/** @type {HTMLDetailsElement} */ (this.#sampled).open)) return;
    this.#sampled.lastElementChild?.matches('.table-box') && this.#sampled.lastElementChild.remove();
    this.#sampled.append(this.#words.table(this.#grid));
  }

  #mark() {
    const scene = this.#page.scene();
    const { x, y } = this.#grid?.settings ?? this.#settings;
    const [across, upwards] = [x, y].map(({ parameter }) => {
      const field = this.#words.field(parameter);
      return field && playedAt(scene, field);
    });
    this.#picture.mark(typeof across === 'number' && typeof upwards === 'number' ? { x: across, y: upwards } : null);
    if (!this.#picture.cursor) this.#read(null);
  }

  /** @returns {Cell | null} */
  #cellOfScene() {
    return this.#picture.cellOfMark();
  }

  /** Shows the values of the pointed cell, or of the scene’s own where none is pointed at. @param {Cell | null} pointed */
  #read(pointed) {
    const grid = this.#grid;
    const cell = pointed ?? this.#cellOfScene();
    const words = !grid ? '' : !cell ? 'The scene lies outside of this map' : this.#words.cell(grid, cell);
    this.#readout.textContent = unbroken(words);
  }

  /** Drops the scene with the values of a place: those of its cell on a finest map, so that the run is the cell’s own. @param {{x: number, y: number}} values @param {import('../card.js').Turn} turn */
  #drag(values, turn) {
    const { x, y, columns } = this.#target;
    const grid = this.#grid;
    /** @type {Record<string, number>} */
    const dropped = {};
    if (grid?.columns === columns) {
      const cell = grid.cellAround(values.x, values.y);
      dropped[x.parameter] = grid.x(cell.column);
      dropped[y.parameter] = grid.y(cell.row);
    } else {
      for (const [side, value, count] of /** @type {const} */ ([
        [x, values.x, columns],
        [y, values.y, rowsOf(columns)],
      ])) {
        const field = this.#words.field(side.parameter);
        const decimals = Math.min(15, Math.max(0, Math.ceil(-Math.log10((side.to - side.from) / count))));
        const kept = Math.min(side.to, Math.max(side.from, Number(value.toFixed(decimals))));
        dropped[side.parameter] = Math.min(field?.maximum ?? Infinity, Math.max(field?.minimum ?? -Infinity, kept));
      }
    }
    this.#page.drop?.(dropped, turn);
    if (turn === 'first' || turn === 'more') return;
    if (!this.#page.drop) this.#page.launch(dropped);
    const cell = this.#cellOfScene();
    if (this.#grid && cell) this.#spoken.textContent = this.#words.cell(this.#grid, cell);
    if (isOfCatches(this.#settings.quantity)) this.#controls.say(this.#catchIt(this.#settings));
  }

  /** Moves the scene by cells. @param {number} columns @param {number} rows */
  #step(columns, rows) {
    const grid = this.#grid;
    const cell = this.#cellOfScene();
    if (!grid || !cell) return;
    const within = (/** @type {number} */ value, /** @type {number} */ count) =>
      Math.min(count - 1, Math.max(0, value));
    const values = {
      x: grid.x(within(cell.column + columns, grid.columns)),
      y: grid.y(within(cell.row + rows, grid.rows)),
    };
    this.#drag(values, 'once');
  }

  /** Goes on in the tab Catch with the settings of a map of catches. @param {Settings} settings */
  #catchIt({ quantity, catch: chosen }) {
    const { open } = this.#page;
    if (!isOfCatches(quantity) || !open) return [];
    const part = Object.entries({ strategy: 'bounce_down', ...chosen }).map(([name, value]) => [
      `catch.${name}`,
      value,
    ]);
    const click = () => open('catch', new URLSearchParams(part));
    return [h('button', { type: 'button', id: 'map-catch', click }, 'Catch it')];
  }

  /** @param {Settings} settings by the controls */
  #set(settings) {
    const before = this.#settings;
    const same = settings.x.parameter === before.x.parameter && settings.y.parameter === before.y.parameter;
    const moved = JSON.stringify([settings.x, settings.y]) !== JSON.stringify([before.x, before.y]);
    if (!same) this.#views = [];
    else if (moved) this.#views.push({ x: before.x, y: before.y });
    this.#settings = settings;
    this.#turned();
  }

  #turned() {
    this.#controls.canGoBack(this.#views.length > 0);
    this.#page.changed();
    void this.#ask();
  }

  /** @param {{x: number, y: number}} low @param {{x: number, y: number}} high */
  #closer(low, high) {
    if (!this.#grid) return;
    const { x, y } = this.#grid.settings;
    const settings = { ...this.#settings, x: this.#part(x, low.x, high.x), y: this.#part(y, low.y, high.y) };
    for (const { from, to } of [settings.x, settings.y]) {
      if (to - from <= Math.max(Math.abs(from), Math.abs(to)) * 1e-9)
        return this.#controls.say(['This is as close as it goes.']);
    }
    this.#views.push({ x, y });
    this.#settings = settings;
    this.#controls.show(settings);
    this.#turned();
  }

  /**
   * Part of a side, with ends as round as the picture is fine and within what the field may be.
   * @param {import('./settings.js').Side} side
   * @param {number} low
   * @param {number} high
   */
  #part({ parameter }, low, high) {
    const field = this.#words.field(parameter);
    const decimals = Math.min(15, Math.max(0, 3 - Math.floor(Math.log10(high - low))));
    const [from, to] = [low, high].map((value) =>
      Math.min(field?.maximum ?? Infinity, Math.max(field?.minimum ?? -Infinity, Number(value.toFixed(decimals)))),
    );
    return { parameter, from, to };
  }

  /** Cancels, or goes back. @returns {boolean} whether there was something to leave */
  #leave() {
    const some = this.#views.length > 0 || this.#refinement.active;
    this.#back();
    return some;
  }

  #back() {
    const view = this.#views.pop();
    if (!view) return this.#cancel();
    this.#settings = { ...this.#settings, ...view };
    this.#controls.show(this.#settings);
    this.#turned();
  }
}

/** The reason for a cell without a value. @param {string} quantity */
const lacking = (quantity) =>
  quantity === 'rest_time'
    ? 'not at rest, or no such scene'
    : QUANTITIES[quantity].runs || isOfCatches(quantity)
      ? 'no such scene'
      : 'no fixed point';
