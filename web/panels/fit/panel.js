// The panel that fits unknown fields of the page's scene to measured impacts, and puts the fitted scene in its place.

import { Problem, wordsOf } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { capitalized, inWords, marked } from '../../dom/typeset.js';
import { download } from '../../export/capture.js';
import { LongRequest } from '../long-request.js';
import { ColumnPicker } from '../measured/columns.js';
import { measured } from '../measured/file.js';
import { NO_SCENE, studyForm } from '../study.js';
import {
  correlations,
  estimates,
  facts,
  isTrusted,
  judged,
  judgementOf,
  notes,
  rejected,
  told,
  verdict,
} from './answer.js';
import { Convergence, stepWords } from './convergence.js';
import { COLUMNS, Deviations } from './deviations.js';
import { exampleOf } from './example.js';
import { UnknownFields } from './fields.js';
import { residualChart } from './residuals.js';
import { setAt } from '../../api/scene-fields.js';

/** @typedef {import('contract').Fit} Fit */
/** @typedef {import('contract').FitRequest} Request */
/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./answer.js').Asked} Asked */

/** Most impacts that the server takes. */
const MOST_IMPACTS = 1000;

/** The panel's parts of the address. */
const KEYS = /^fit\.(unknown|first\.[\w.]+|sd\.(t|x|theta|(x|y|theta)_dot))$/;

const NO_DATA = 'There are no measured bounces yet: choose a file, or make an example.';
const ABOUT =
  'Drop a CSV file anywhere on the page: t and any of θ, ẋ, ẏ, θ̇ and x just before each bounce, with units in the header, as in “t (ms)”.';

/** @param {Request} request with data */
const post = (request) => (/** @type {AbortSignal} */ signal) =>
  fetch('v1/fits?format=progress', {
    method: 'POST',
    signal,
    headers: { 'content-type': 'application/json' },
    body: JSON.stringify(request),
  });

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new FitPanel(root, page);

class FitPanel {
  #page;
  #unknown;
  #deviations;
  #columns = new ColumnPicker('fit', (picks) => measured.pick(picks));
  #data = h('p', { id: 'fit-data', role: 'status' });
  #remarks = h('ul', { class: 'measured-remarks' });
  #dataError = h('p', { class: 'error', id: 'fit-data-error' });
  #file = h('input', {
    type: 'file',
    id: 'fit-file',
    accept: '.csv,.tsv,.txt,text/csv,text/tab-separated-values',
    hidden: true,
    change: () => {
      const file = this.#file.files?.[0];
      if (file) this.#take(file, '');
      this.#file.value = '';
    },
  });
  #example = h(
    'button',
    { type: 'button', id: 'fit-example', click: () => void this.#makeExample() },
    'Make an example',
  );
  #task = new LongRequest(
    'fit',
    h('button', { type: 'submit', id: 'fit-start', class: 'primary', 'aria-describedby': 'fit-promise' }, 'Fit'),
    'Fitting',
    stepWords,
  );
  #convergence = new Convergence();
  #promise = h('p', { class: 'muted fit-promise', id: 'fit-promise' });
  #use = h(
    'button',
    { type: 'button', id: 'fit-use', class: 'primary', click: () => this.#useIt() },
    'Use these values',
  );
  #used = h('p', { id: 'fit-used', role: 'status' });
  #sheet = h('div', { class: 'study-sheet fit-sheet', id: 'fit-sheet', hidden: true });
  /** The newest answer, and what was asked. @type {{fit: Fit, asked: Asked, request: Request} | null} */
  #shown = null;
  /** The scene of the page when it was asked, and after it was replaced, as text. */
  #scenes = { asked: '', fitted: '' };
  #making = new AbortController();
  /** Counts changes of data and settings: an answer may come after one. */
  #changes = 0;
  /** Counts fits: one that was cancelled may end after the next has begun. */
  #asked = 0;

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    root.classList.add('study');
    const changed = () => {
      page.changed();
      this.#voided('The settings have changed since; fit anew with them.');
    };
    this.#unknown = new UnknownFields(page.fields, page.scene, changed);
    this.#deviations = new Deviations(changed);
    const form = studyForm(
      'fit',
      'Fit',
      () => void this.#fit(),
      [],
      [h('div', { class: 'fit-settings' }, this.#unknown.element, this.#deviations.element)],
    );
    // The settings come first here: nothing is to be asked for without them.
    const act = form.firstElementChild;
    act?.replaceChildren(this.#task.buttons, this.#promise, this.#task.told);
    if (act) form.append(act);
    root.append(
      h(
        'div',
        { class: 'fit-data' },
        h('p', { class: 'muted' }, ABOUT),
        h(
          'p',
          { class: 'buttons' },
          h('button', { type: 'button', id: 'fit-load', click: () => this.#file.click() }, 'Choose a file…'),
          this.#file,
          this.#example,
        ),
        this.#data,
        this.#remarks,
        this.#columns.element,
        this.#dataError,
      ),
      form,
      this.#convergence.element,
      this.#sheet,
    );
    measured.watch(() => {
      this.#voided('The data have changed since; fit anew with them.');
      this.#showData();
    });
    this.#showData();
  }

  /** The panel's part of the address. */
  query() {
    return new URLSearchParams([...this.#unknown.query(), ...this.#deviations.query()]);
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    const others = [...link.keys()].filter((key) => key.startsWith('fit.') && !KEYS.test(key));
    return [
      ...others.map((key) => `“${key.slice(0, 40)}”, which has no meaning here`),
      ...this.#unknown.restore(link),
      ...this.#deviations.restore(link),
    ];
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#unknown.show();
    if (!this.#shown) return;
    const scene = JSON.stringify(this.#page.scene());
    if (scene === this.#scenes.asked) this.#offer();
    else if (scene === this.#scenes.fitted) {
      this.#page.told?.('the fitted values are in use', true);
      this.#say('The fitted values are in use. The way back in your browser brings back those before.', true);
    } else this.#voided('The scene has changed since; fit anew for it.');
  }

  retell() {
    this.#unknown.show(true);
    this.#deviations.show(true);
    if (this.#shown) this.#draw();
  }

  /** @param {File} file @param {string} about */
  #take(file, about) {
    void measured.take(file, about);
  }

  async #makeExample() {
    const scene = this.#page.query();
    if (!scene) {
      this.#data.textContent = NO_SCENE;
      return;
    }
    this.#making.abort();
    this.#making = new AbortController();
    const { signal } = this.#making;
    try {
      const example = await exampleOf(scene, this.#unknown.chosen, signal);
      if (signal.aborted) return;
      if (example) this.#take(example.file, example.about);
      else
        this.#data.textContent =
          'The run of this scene ends too soon for an example. Choose one that keeps its balance.';
    } catch (error) {
      if (!signal.aborted) this.#data.replaceChildren(...marked(wordsOf(error)));
    }
  }

  /** Shows which data there are. */
  #showData() {
    const { name, reading, refusal, heads, about } = measured;
    const impacts = reading?.impacts ?? [];
    const sent = Math.min(impacts.length, MOST_IMPACTS);
    const columns = COLUMNS.filter((column) => reading?.columns.includes(column));
    this.#dataError.textContent = '';
    this.#data.textContent = reading
      ? `${name}: ${number(impacts.length, 7)} bounces. ${about}`
      : refusal
        ? `${name}: ${refusal}`
        : NO_DATA;
    const remarks = (reading?.remarks ?? []).filter((words) => !words.startsWith('Not used:'));
    if (sent < impacts.length)
      remarks.push(`A fit takes at most ${MOST_IMPACTS} bounces: the first ${MOST_IMPACTS} are used.`);
    this.#remarks.replaceChildren(...remarks.map((words) => h('li', {}, words)));
    const unused = reading?.remarks.find((words) => words.startsWith('Not used:'));
    this.#columns.show(heads, unused ?? '');
    if (!reading && heads.length > 0) this.#columns.element.open = true;
    this.#deviations.take(impacts.slice(0, MOST_IMPACTS));
    this.#promise.textContent =
      columns.length > 0
        ? `Sends these ${number(sent, 7)} bounces and the scene to the server of this page. Until you press it, the data stay in this browser.`
        : 'Sends the bounces and the scene to the server of this page. Until you press it, the data stay in this browser.';
  }

  /** The request; null where something is missing, which is marked. @returns {{request: Request, asked: Asked} | null} */
  #request() {
    this.#dataError.textContent = '';
    const given = this.#deviations.read();
    const chosen = this.#unknown.read();
    const { reading } = measured;
    if (!reading) {
      this.#dataError.textContent = NO_DATA;
      document.getElementById('fit-load')?.focus();
      return null;
    }
    if (!chosen) return null;
    if (!this.#page.query()) {
      this.#task.say(NO_SCENE);
      return null;
    }
    const impacts = reading.impacts.slice(0, MOST_IMPACTS);
    const values = COLUMNS.filter((column) => impacts.some((one) => Number.isFinite(one[column]))).map((column) => [
      column,
      impacts.map((one) => (Number.isFinite(one[column]) ? one[column] : null)),
    ]);
    /** @type {Scene} */
    const scene = structuredClone(this.#page.scene());
    for (const { path, value } of chosen) setAt(scene, path, value);
    return {
      request: {
        scene,
        measured: { ...(reading.numbered && { n: impacts.map(({ n }) => n) }), ...Object.fromEntries(values) },
        unknown: chosen.map(({ path }) => path),
        sd: given,
      },
      asked: {
        fields: this.#unknown.chosen.map(({ field }) => field),
        firsts: chosen.map(({ value }) => value),
        given,
        lines: reading.lines,
      },
    };
  }

  async #fit() {
    const question = this.#request();
    if (!question) return;
    const { request, asked } = question;
    const scene = JSON.stringify(this.#page.scene());
    const changes = this.#changes;
    const asking = ++this.#asked;
    this.#convergence.begin();
    const answer = await this.#task.during(post(request), {
      refused: (problem) => this.#blame(problem),
      heard: (step) => this.#convergence.hear(step),
    });
    if (asking === this.#asked) this.#convergence.end(answer !== null);
    if (!answer) return;
    /** @type {Fit} */
    const fit = answer.end;
    this.#shown = { fit, asked, request };
    this.#scenes = { asked: scene, fitted: '' };
    this.#task.say(told(fit, asked, this.#task.took));
    this.#draw();
    if (changes === this.#changes) this.sceneChanged();
    else this.#voided('The data or the settings have changed since; fit anew with them.');
  }

  /** Shows a refusal at the fields and columns that it names. @param {Problem} problem @returns {string} the rest in words */
  #blame(problem) {
    if (problem.errors.length === 0) return wordsOf(problem);
    const { reading } = measured;
    const named = (/** @type {number} */ row) =>
      `row ${row + 1}${reading ? `, line ${reading.lines[row]} of the file` : ''}`;
    const elsewhere = this.#deviations.blame(this.#unknown.blame(problem.errors), named);
    const others = elsewhere.filter(({ pointer }) => !pointer.startsWith('/measured'));
    const words = elsewhere
      .filter((error) => !others.includes(error))
      .map(({ detail }) => `${capitalized(inWords(detail))}.`);
    this.#dataError.textContent = words.join(' ');
    // Whoever asked should find the fault.
    const wrong = /** @type {HTMLElement | null} */ (document.querySelector('#fit [aria-invalid=true]'));
    wrong?.focus();
    return others.length > 0 ? others.map(({ detail }) => detail).join(' ') : 'There is no fit: the fault is marked.';
  }

  /** @param {string} words @param {boolean} used */
  #say(words, used) {
    this.#used.textContent = words;
    this.#use.hidden = used;
    this.#sheet.classList.remove('stale');
  }

  /** Offers the fitted scene, where it is another one. */
  #offer() {
    if (!this.#shown) return;
    const { fit } = this.#shown;
    this.#page.told?.(judgementOf(fit), isTrusted(fit));
    const isTold = fit.estimates.some(({ identifiable }) => identifiable);
    if (!isTrusted(fit)) this.#say('Do not use the estimates: the scene stays as it is.', true);
    else this.#say(isTold ? '' : 'The data tell none of the fields, so that the scene stays as it is.', !isTold);
  }

  /** Marks the answer as one to another question. @param {string} words */
  #voided(words) {
    this.#changes += 1;
    if (!this.#shown) return;
    this.#page.told?.(words, null);
    this.#say(words, true);
    this.#sheet.classList.add('stale');
  }

  /** Puts the fitted scene in the place of the typed one. */
  #useIt() {
    if (!this.#shown) return;
    const { fit } = this.#shown;
    this.#page.play(fit.scene, 'the fit');
    this.#scenes.fitted = JSON.stringify(this.#page.scene());
    this.sceneChanged();
  }

  #draw() {
    if (!this.#shown) return;
    const { fit, asked, request } = this.#shown;
    const save = (/** @type {string} */ words, /** @type {string} */ name, /** @type {unknown} */ content) =>
      h(
        'button',
        {
          type: 'button',
          click: () =>
            download(new Blob([`${JSON.stringify(content, null, 1)}\n`], { type: 'application/json' }), name),
        },
        words,
      );
    this.#sheet.replaceChildren(
      h('div', { class: 'fit-head' }, judged(fit, asked), h('div', { class: 'fit-use' }, this.#use, this.#used)),
      ...(isTrusted(fit)
        ? [
            h('div', { class: 'fit-column' }, estimates(fit, asked), ...correlations(fit, asked)),
            h('div', { class: 'fit-column' }, verdict(fit), ...notes(fit, asked)),
          ]
        : [h('div', { class: 'fit-wide' }, rejected(fit), ...notes(fit, asked))]),
      h('div', { class: 'fit-wide' }, residualChart(fit, asked.lines)),
      facts(fit, asked),
      h(
        'p',
        { class: 'actions fit-wide' },
        save('Save fit', 'equipoise-fit.json', fit),
        save('Save request', 'equipoise-fit-request.json', request),
      ),
    );
    this.#sheet.hidden = false;
  }
}
