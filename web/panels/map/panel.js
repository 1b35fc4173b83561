// The panel of the stability map: asks for it, draws it as it arrives, lets one run any point of it or look closer.

import { MapControls } from './controls.js';
import { Grid } from './grid.js';
import { MapPicture } from './picture.js';
import { Problem, get, problemOf } from '../../api/client.js';
import { playedAt } from '../../api/scene-fields.js';
import { actions } from '../../export/save-actions.js';
import { QUANTITIES, outlineQuery, readSettings, requestQuery, rowsOf, settingsQuery } from './settings.js';
import { h } from '../../dom/elements.js';
import { debounce } from '../../dom/debounce.js';
import { lines } from '../../api/ndjson.js';
import { listen } from './pointer.js';
import { number, quantity as withUnit, unbroken } from '../../dom/numbers.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {import('./picture.js').Cell} Cell */

/** @typedef {import('../card.js').PanelPage} PanelPage */

/** A map of more bounces than this waits until somebody asks for it: about a second of one core. */
const UNASKED_BOUNCES = 1e8;
/** Answers kept, to go back without asking again. */
const KEPT = 8;

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page, link) => new MapPanel(root, page, link);

class MapPanel {
  #page;
  /** @type {Settings} */
  #settings;
  #controls;
  #picture;
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
  /** The drawn cells. @type {Grid | null} */
  #grid = null;
  /** The request made last, whatever became of it. */
  #asked = '';
  /** @type {Map<string, Grid>} */
  #kept = new Map();
  /** Views before this one. @type {Pick<Settings, 'x' | 'y'>[]} */
  #views = [];
  /** @type {AbortController | null} */
  #asking = null;
  #near = true;

  /**
   * @param {HTMLElement} root
   * @param {PanelPage} page
   * @param {URLSearchParams} link
   */
  constructor(root, page, link) {
    this.#page = page;
    this.#settings = readSettings(link, page.fields).settings;
    this.#controls = new MapControls(page.fields, this.#settings, {
      changed: (settings) => this.#set(settings),
      compute: () => void this.#ask(),
      cancel: () => this.#cancel(),
      back: () => this.#back(),
    });
    root.append(
      this.#notice,
      this.#controls.element,
      h(
        'div',
        { class: 'map-sheet' },
        this.#box,
        this.#readout,
        this.#spoken,
        this.#legend,
        h(
          'p',
          { class: 'muted small', id: 'map-hint' },
          'Click a point to run it; drag a rectangle to look closer, Escape goes back. With keys: arrows move, Enter runs, + looks closer.',
        ),
        this.#links,
      ),
    );
    this.#picture = new MapPicture(this.#box, this.#settings, this.#names(this.#settings));
    listen(this.#box, this.#picture, {
      point: (cell, byKey) => this.#read(cell, byKey),
      take: (cell) => this.#launch(cell),
      select: (from, to) => this.#closer(from, to),
      begin: () => this.#cellOfScene() ?? { column: this.#picture.columns >> 1, row: this.#picture.rows >> 1 },
    });
    root.addEventListener('keydown', (event) => {
      // In a list it closes the list.
      if (event.key === 'Escape' && !event.defaultPrevented && !(event.target instanceof HTMLSelectElement))
        this.#back();
    });
    new IntersectionObserver(
      (entries) => {
        this.#near = entries.some(({ isIntersecting }) => isIntersecting);
        if (this.#near) this.#refresh();
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  /** The map’s part of the page’s address. */
  query() {
    return settingsQuery(this.#settings);
  }

  /** Names what it drops in its own place. @param {URLSearchParams} link @returns {string[]} */
  restore(link) {
    const { settings, dropped } = readSettings(link, this.#page.fields);
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
    this.#mark();
    this.#refreshSoon();
  }

  #refreshSoon = debounce(300, () => this.#refresh());

  /** Asks if what there is answers another request. */
  #refresh() {
    const request = this.#request();
    if (!this.#near || String(request) === this.#asked) return;
    const { columns, impacts, quantity } = this.#settings;
    const bounces = QUANTITIES[quantity].runs ? columns * rowsOf(columns) * impacts : 0;
    if (request && bounces > UNASKED_BOUNCES && this.#asked !== '')
      this.#controls.say(['The scene has changed since.'], 'stale');
    else void this.#ask();
  }

  #request() {
    const scene = this.#page.query();
    return scene && requestQuery(this.#settings, scene);
  }

  async #ask() {
    this.#asking?.abort();
    this.#asking = null;
    this.#controls.busy(null);
    const request = this.#request();
    this.#asked = String(request);
    if (!request)
      return this.#controls.say(['A parameter of the scene is not a number; it is marked among them.'], 'wrong');
    const kept = this.#kept.get(this.#asked);
    if (kept) return this.#finish(kept, request);
    const asking = new AbortController();
    this.#asking = asking;
    const { signal } = asking;
    const settings = structuredClone(this.#settings);
    const rows = rowsOf(settings.columns);
    let arrived = 0;
    this.#controls.busy({ arrived, rows });
    this.#controls.say([]);
    try {
      const grid = new Grid(settings, await get(`v1/regions?${outlineQuery(request)}`, signal));
      const response = await fetch(`v1/regions?${request}&format=ndjson`, { signal });
      if (!response.ok || !response.body) throw await problemOf(response);
      for await (const line of lines(response.body)) {
        if (signal.aborted) return;
        grid.take(line);
        ({ arrived } = grid);
        // The cells of before stay until there are new ones.
        if (this.#grid !== grid) this.#show(grid, request);
        this.#picture.redraw();
        this.#controls.busy({ arrived, rows });
      }
      if (!grid.counts) throw new Problem('', 'The answer was cut off.', [], 0);
      this.#kept.set(String(request), grid);
      for (const key of this.#kept.keys()) if (this.#kept.size > KEPT) this.#kept.delete(key);
      this.#finish(grid, request);
    } catch (error) {
      if (signal.aborted) return;
      const problem = error instanceof Problem ? error : null;
      const elsewhere = this.#controls.blame(problem?.errors ?? []);
      const words = problem
        ? problem.errors.length === 0
          ? problem.message
          : elsewhere.join(' ')
        : 'The server does not answer.';
      this.#controls.say(
        [
          arrived > 0
            ? `${words} ${arrived} of ${rows} rows are there.`
            : words || 'There is no such map; see what is marked.',
        ],
        'wrong',
      );
    } finally {
      if (this.#asking === asking) {
        this.#asking = null;
        this.#controls.busy(null);
      }
    }
  }

  #cancel() {
    if (!this.#asking) return;
    this.#asking.abort();
    this.#asking = null;
    this.#controls.busy(null);
    this.#controls.say(['Cancelled.'], 'stale');
  }

  /** @param {Grid} grid @param {URLSearchParams} request */
  #show(grid, request) {
    this.#grid = grid;
    this.#picture.show(grid.settings, this.#names(grid.settings), grid);
    this.#mark();
    this.#links.replaceChildren(
      ...actions({
        id: 'map',
        title: 'Stability map',
        path: `v1/regions?${request}`,
        formats: ['svg', 'png', 'csv', 'json'],
      }),
    );
    const swatch = (/** @type {string} */ kind, /** @type {string} */ words) =>
      h('span', {}, h('span', { class: `swatch ${kind}`, 'aria-hidden': 'true' }), words);
    const has = (/** @type {number} */ residue) => grid.boundary.some((segment) => segment.residue === residue);
    this.#legend.replaceChildren(
      ...[
        swatch('scene', 'the scene'),
        has(1) && swatch('whole', 'linear boundary, R = 1'),
        has(0) && swatch('broken', 'linear boundary, R = 0'),
        grid.lacks && swatch('none', QUANTITIES[grid.settings.quantity].runs ? 'no such scene' : 'no fixed point'),
      ].filter((one) => one !== false),
    );
  }

  /** @param {Grid} grid whole @param {URLSearchParams} request */
  #finish(grid, request) {
    this.#show(grid, request);
    const total = grid.columns * grid.rows;
    const { quantity, x, y } = grid.settings;
    const counts = Object.entries(grid.counts ?? {})
      .filter(([, count]) => count > 0)
      .sort(([, a], [, b]) => b - a)
      .map(([name, count]) => `${number(count, 7)} ${name === 'none' ? 'no such scene' : name.replaceAll('_', ' ')}`);
    const { low, high } = grid.scale;
    this.#controls.count({ arrived: grid.arrived, rows: grid.rows });
    this.#controls.say([
      QUANTITIES[quantity].runs
        ? `${number(total, 7)} cells: ${counts.join(', ')}.`
        : `${number(total, 7)} cells, from ${number(low)} to ${number(high)}.`,
    ]);
    this.#box.setAttribute(
      'aria-label',
      `Stability map. ${QUANTITIES[quantity].title} over ${this.#title(x.parameter)} from ${number(x.from)} to ${number(x.to)} and ${this.#title(y.parameter)} from ${number(y.from)} to ${number(y.to)}.`,
    );
    this.#read(this.#picture.cursor, false);
  }

  /** @param {string} path */
  #field(path) {
    return this.#page.fields.find((field) => field.path === path);
  }

  /** @param {string} path */
  #title(path) {
    return this.#field(path)?.title.toLowerCase() ?? path;
  }

  /** A symbol that can be printed in one line, else the title. @param {string} path */
  #symbol(path) {
    const symbol = this.#field(path)?.symbol;
    return symbol && !symbol.includes('_') ? symbol : this.#title(path);
  }

  /** @param {Settings} settings */
  #names({ x, y }) {
    const [across, upwards] = [x, y].map(({ parameter }) => {
      const field = this.#field(parameter);
      const symbol = this.#symbol(parameter);
      const title = this.#title(parameter);
      return `${symbol === title ? title : `${title} ${symbol}`}${field?.unit && field.unit !== '1' ? ` (${field.unit})` : ''}`;
    });
    return { x: across, y: upwards };
  }

  #mark() {
    const scene = this.#page.scene();
    const { x, y } = this.#grid?.settings ?? this.#settings;
    const [across, upwards] = [x, y].map(({ parameter }) => {
      const field = this.#field(parameter);
      return field && playedAt(scene, field);
    });
    this.#picture.mark(typeof across === 'number' && typeof upwards === 'number' ? { x: across, y: upwards } : null);
    if (!this.#picture.cursor) this.#read(null, false);
  }

  /** @returns {Cell | null} */
  #cellOfScene() {
    return this.#picture.cellOfMark();
  }

  /** Shows the values of the pointed cell, or of the scene’s own where none is pointed at. @param {Cell | null} pointed @param {boolean} byKey */
  #read(pointed, byKey) {
    const grid = this.#grid;
    const cell = pointed ?? this.#cellOfScene();
    const words = !grid
      ? ''
      : !cell
        ? 'The scene lies outside of this map'
        : `${pointed ? '' : 'The scene’s cell:   '}${this.#words(grid, cell)}`;
    this.#readout.textContent = unbroken(words);
    if (byKey) this.#spoken.textContent = words;
  }

  /** @param {Grid} grid @param {Cell} cell */
  #words(grid, { column, row }) {
    const { x, y, quantity, impacts } = grid.settings;
    const place = [
      [x, grid.x(column)],
      [y, grid.y(row)],
    ]
      .map(([side, value]) => {
        const { parameter, from, to } = /** @type {import('./settings.js').Side} */ (side);
        // Enough digits to tell neighbours apart.
        const digits = Math.max(
          4,
          Math.ceil(Math.log10((Math.max(Math.abs(from), Math.abs(to)) * grid.columns) / (to - from))) + 1,
        );
        return `${this.#symbol(parameter)} ${withUnit(Number(value), this.#field(parameter)?.unit ?? '', digits)}`;
      })
      .join('   ');
    if (!grid.has(row)) return `${place}   not computed yet`;
    const value = grid.values[row * grid.columns + column];
    const outcome = grid.names[grid.outcomes[row * grid.columns + column]]?.replaceAll('_', ' ');
    if (Number.isNaN(value)) return `${place}   ${QUANTITIES[quantity].runs ? 'no such scene' : 'no fixed point'}`;
    if (quantity === 'survival')
      return `${place}   ${number(value, 7)} of ${number(impacts, 7)} contacts survived   ${outcome}`;
    if (quantity === 'max_theta') return `${place}   largest |θ| ${withUnit(value, 'rad')}   ${outcome}`;
    return `${place}   ${quantity === 'residue' ? `R ${number(value)}` : `max |λ| ${number(value, 6)}`}`;
  }

  /** @param {Cell} cell */
  #launch({ column, row }) {
    const grid = this.#grid;
    if (!grid?.has(row)) return;
    if (QUANTITIES[grid.settings.quantity].runs && Number.isNaN(grid.values[row * grid.columns + column]))
      return this.#controls.say(['There is no such scene to run.'], 'said');
    const { x, y } = grid.settings;
    this.#page.launch({ [x.parameter]: grid.x(column), [y.parameter]: grid.y(row) });
    const [across, upwards] = [
      [x, grid.x(column)],
      [y, grid.y(row)],
    ].map(([side, value]) => {
      const { parameter } = /** @type {import('./settings.js').Side} */ (side);
      return `${this.#title(parameter)} ${withUnit(Number(value), this.#field(parameter)?.unit ?? '')}`;
    });
    this.#controls.say([
      `Released with ${across}, ${upwards}. `,
      h(
        'button',
        {
          type: 'button',
          id: 'map-run',
          click: () => document.querySelector('#run-state')?.scrollIntoView({ block: 'start' }),
        },
        'Show the run',
      ),
    ]);
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
    const field = this.#field(parameter);
    const decimals = Math.min(15, Math.max(0, 3 - Math.floor(Math.log10(high - low))));
    const [from, to] = [low, high].map((value) =>
      Math.min(field?.maximum ?? Infinity, Math.max(field?.minimum ?? -Infinity, Number(value.toFixed(decimals)))),
    );
    return { parameter, from, to };
  }

  #back() {
    const view = this.#views.pop();
    if (!view) return this.#cancel();
    this.#settings = { ...this.#settings, ...view };
    this.#controls.show(this.#settings);
    this.#turned();
  }
}
