// The panel that catches the body of the page's scene, tells how, and catches, throws and juggles in the run under way.

import { Problem, wordsOf } from '../../api/client.js';
import { LatestRequest } from '../../api/latest-request.js';
import { parse } from '../../dom/typed-number.js';
import { UNITS, shownUnit } from '../../dom/units.js';
import { THROWN } from '../../physics/body.js';
import { html, render } from '../../vendor/preact/preact.js';
import { pictured } from '../figures.js';
import { ErrorLine, NO_SCENE, SharedField, words } from '../parts.js';
import { Sheet, Told } from './answer.js';
import { CatchFields, inUse, others, readCatch } from './settings.js';

/** Heights of throws in distances from contact point to centre of gravity, and the angle. */
const THROWS = { height: THROWN, theta: 0, low: 1.5, high: THROWN };
/** @typedef {keyof typeof THROWS} Name */
const NAMES = /** @type {Name[]} */ (Object.keys(THROWS));

/** @param {Name} name */
const unitOf = (name) => (name === 'theta' ? 'rad' : 'm');

/** The two fields of the map of its reach, with their ends. */
const REACH = {
  x: { parameter: 'release.theta', from: -1, to: 1 },
  y: { parameter: 'release.theta_dot', from: -8, to: 8 },
};

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new CatchPanel(root, page);

class CatchPanel {
  #root;
  #page;
  /** @type {import('./settings.js').CatchSettings} */
  #settings = {};
  /** @type {import('contract').ProblemError[]} */
  #errors = [];
  /** Typed values of throws, in SI units. @type {Partial<Record<Name, number>>} */
  #throws = {};
  /** @type {import('contract').ProblemError[]} */
  #refused = [];
  /** Words in place of those on the answer. */
  #told = 'After a release of this scene, the table brings the body to rest and keeps it upright in lasting contact.';
  /** The answer shown. @type {import('./answer.js').Answered | null} */
  #answered = null;
  #latest = new LatestRequest();

  /** @param {HTMLElement} root @param {import('../card.js').PanelPage} page */
  constructor(root, page) {
    this.#root = root;
    this.#page = page;
    root.classList.add('study');
    document.addEventListener(UNITS, () => this.#draw());
    page.guide?.watch({
      changed: () => this.#draw(),
      problem: ({ title, detail, errors }) => {
        this.#blame(errors);
        const rest = others(errors, this.#settings);
        this.#refused = errors.length > 0 ? rest : [{ pointer: '', detail: detail || title }];
        this.#draw();
      },
    });
    this.#draw();
  }

  #draw() {
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      void this.ask();
    };
    render(
      html`<form novalidate onSubmit=${submit}>
          <div class="study-act">
            <button type="submit" id="catch-start" class="primary">Catch</button>
            <div class="study-told" id="catch-told" role="status">
              ${this.#told ? html`<p>${words(this.#told)}</p>` : html`<${Told} ...${this.#answered} />`}
            </div>
          </div>
          <${CatchFields} id="catch" automatic settings=${this.#settings} errors=${this.#errors} changed=${(
            /** @type {import('./settings.js').CatchSettings} */ settings,
          ) => {
            this.#settings = settings;
            this.#errors = [];
            this.#voided('The settings have changed since; catch anew with them.');
            this.#page.changed();
          }} />
        </form>
        <div class=${`study-sheet ${this.#told ? 'stale' : ''}`} id="catch-sheet" hidden=${!this.#answered}>
          ${this.#answered && html`<${Sheet} ...${this.#answered} />`}
        </div>
        ${this.#page.guide && this.#live(this.#page.guide)}
        <p class="study-row">
          <button type="button" id="catch-reach" onClick=${() => this.#reach()}>Map its reach</button>
          <span>Which releases the table catches, over angle and spin: a catch in every cell.</span>
        </p>`,
      this.#root,
    );
  }

  /** The run under way: catch it, throw it, juggle it. @param {import('../card.js').Guide} guide */
  #live(guide) {
    const [live, held] = [guide.live(), guide.held()];
    const usual = (/** @type {Name} */ name) => Number((THROWS[name] * guide.length()).toPrecision(2));
    const value = (/** @type {Name} */ name) => this.#throws[name] ?? usual(name);
    const field = (
      /** @type {Name} */ name,
      /** @type {string} */ words,
      /** @type {string} */ after,
    ) => html`<label for=${`catch-${name}`}>${words}</label>
      <${SharedField}
        id=${`catch-${name}`}
        error="catch-live-error"
        unit=${unitOf(name)}
        value=${this.#throws[name]}
        hint=${String(usual(name))}
        changed=${(/** @type {number | undefined} */ typed) => {
          this.#throws = { ...this.#throws, [name]: typed };
          this.#refused = [];
          this.#page.changed();
          this.#draw();
        }}
      />
      <span class="unit">${after}</span>`;
    const act = (/** @type {() => void} */ send) => () => {
      this.#refused = [];
      this.#blame([]);
      send();
    };
    const catchIt = act(() => guide.catchIt(inUse(this.#settings)));
    const throwIt = act(() => guide.throwIt({ height: value('height'), theta: value('theta') }));
    const juggle = act(() => guide.juggle([value('low'), value('high')]));
    const words = held ? 'The table holds the body. A throw goes on from there.' : 'Acts from the next strike on.';
    return html`<fieldset class="catch-live">
      <legend>The run under way</legend>
      <p class="study-row">
        <button type="button" id="catch-run" disabled=${!live || held} onClick=${catchIt}>Catch this run</button>
        <span id="catch-live-told" role="status">${live || held ? words : 'No run is under way.'}</span>
      </p>
      <p class="study-row">
        <button type="button" id="catch-throw" disabled=${!live} onClick=${throwIt}>Throw</button>
        ${field('height', 'to', 'm')} ${field('theta', 'at an angle of', shownUnit('rad'))}
      </p>
      <p class="study-row">
        <button type="button" id="catch-juggle" disabled=${!live} onClick=${juggle}>Juggle</button>
        ${field('low', 'to', 'm')} ${field('high', 'and', 'm, in turn')}
      </p>
      <${ErrorLine} id="catch-live-error" errors=${this.#refused} />
    </fieldset>`;
  }

  /** The panel's part of the address. */
  query() {
    const own = Object.entries({ ...inUse(this.#settings), ...this.#throws });
    return new URLSearchParams(
      own.flatMap(([name, value]) => (value === undefined ? [] : [[`catch.${name}`, String(value)]])),
    );
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    const { settings, dropped } = readCatch(link, 'catch.');
    this.#settings = settings;
    this.#throws = {};
    for (const name of NAMES) {
      const text = link.get(`catch.${name}`);
      if (!text) continue;
      const value = parse(text, null);
      if (value === null) dropped.push(`${name} of the throw “${text.slice(0, 40)}”, which is not a number`);
      else this.#throws[name] = value;
    }
    this.#blame([]);
    return dropped;
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#voided('The scene has changed since; catch anew for it.');
  }

  /** Marks the shown answer as one to another request. @param {string} words */
  #voided(words) {
    this.#latest.cancel();
    if (this.#answered) this.#told = words;
    this.#draw();
  }

  /** @param {import('contract').ProblemError[]} errors on the settings */
  #blame(errors) {
    this.#errors = errors;
    this.#draw();
  }

  async ask() {
    this.#blame([]);
    const request = this.#page.query();
    for (const [name, value] of Object.entries(inUse(this.#settings))) request?.set(name, String(value));
    const signal = this.#latest.next();
    const path = `v1/catches?${request}`;
    try {
      if (!request) throw new Problem('', NO_SCENE, [], 0);
      const [answer, figure] = await pictured(path, signal);
      if (signal.aborted) return;
      this.#answered = { answer, figure, path };
      this.#told = '';
    } catch (error) {
      if (signal.aborted) return;
      this.#answered = null;
      this.#errors = error instanceof Problem ? error.errors : [];
      const words =
        this.#errors.length > 0
          ? others(this.#errors, this.#settings)
              .map(({ detail }) => detail)
              .join(' ')
          : wordsOf(error);
      this.#told = words || 'A setting is out of its range; it is marked.';
    }
    this.#draw();
  }

  /** Opens the map of the releases that the table catches. */
  #reach() {
    const link = new URLSearchParams([['map.quantity', 'caught']]);
    for (const [name, side] of Object.entries(REACH))
      for (const [key, value] of Object.entries(side)) link.set(`map.${name}.${key}`, String(value));
    for (const [name, value] of Object.entries(inUse(this.#settings))) link.set(`map.catch.${name}`, String(value));
    this.#page.open?.('map', link);
  }
}
