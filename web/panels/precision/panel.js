// The panel of speed against accuracy: every method on the page's scene. It measures on request only, since that keeps a core busy.

import { ChartReader } from '../../charts/readable/chart-reader.js';
import { FigurePoints, figureOf } from '../../charts/readable/server-figure.js';
import { row, table } from '../../dom/tables.js';
import { LongRequest } from '../long-request.js';
import { actions } from '../../export/save-actions.js';
import { h } from '../../dom/elements.js';
import { marked } from '../../dom/typeset.js';
import { numberInput, wholeNumber } from '../../dom/number-input.js';
import { number, quantity } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { svg } from '../../charts/svg.js';

/** @typedef {import('contract').Precision} Precision */
/** @typedef {import('contract').PrecisionPoint} Point */

const USUAL_IMPACTS = 100;
const MOST_IMPACTS = 1000;
const MUST = `a whole number from 1 to ${MOST_IMPACTS}`;

/** @param {number | null} impacts */
const isRight = (impacts) => impacts !== null && Number.isInteger(impacts) && impacts >= 1 && impacts <= MOST_IMPACTS;

/**
 * The axes across. Steps of different methods are different work, so that no point beats another by them.
 * @type {Record<string, {title: string, hasFront: boolean}>}
 */
const AXES = {
  time: { title: 'Clock time', hasFront: true },
  evaluations: { title: 'Evaluations', hasFront: true },
  steps: { title: 'Steps', hasFront: false },
};

/** @param {Point} point @param {number | null} count */
const each = ({ outcome: { bounces } }, count) => (bounces > 0 && count !== null ? count / bounces : null);

/** @param {Point} point */
const setting = ({ setting: told }) => (told ? `${told.name} ${quantity(told.value, told.unit, 2)}` : '');

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new PrecisionPanel(root, page);

class PrecisionPanel {
  #query;
  #error = h('p', { class: 'error', id: 'precision-error' });
  #impacts = numberInput({ id: 'precision-impacts', inputmode: 'numeric' }, this.#error, {
    unit: null,
    fault: wholeNumber(1, MOST_IMPACTS, 'Contacts'),
  });
  #axis = h(
    'select',
    { id: 'precision-axis', change: () => this.#draw() },
    ...Object.entries(AXES).map(([value, { title }]) => h('option', { value }, title)),
  );
  #task = new LongRequest(
    'precision',
    h('button', { type: 'submit', id: 'precision-measure', class: 'primary' }, 'Measure'),
    'Measuring',
    'parts',
  );
  #methods = h('ul', { class: 'methods', 'aria-label': 'Methods' });
  #reader = new ChartReader('precision', 'Speed against accuracy');
  #body = h('tbody');
  #links = h('p', { class: 'actions', id: 'precision-links' });
  #notes = h('div');
  #front = h('span');
  #sheet;
  /** @type {FigurePoints | null} */
  #plot = null;
  /** @type {{answer: Precision, pictures: Record<string, string>, request: URLSearchParams} | null} */
  #shown = null;
  /** Points that the chart has. @type {Point[]} */
  #drawn = [];

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, { query, changed }) {
    this.#query = query;
    const head = [
      'Method',
      'Setting',
      'ns/bounce',
      'quartiles',
      'steps',
      'evaluations',
      'error / m or m/s',
      'best',
      'outcome',
    ];
    this.#sheet = h(
      'div',
      { class: 'precision-sheet', hidden: true },
      this.#reader.box,
      this.#reader.readout,
      this.#reader.spoken,
      h(
        'p',
        { class: 'muted small', id: 'precision-hint' },
        this.#front,
        ' The dotted line is the rounding of one number. With keys: left and right go from point to point, up and down from method to method.',
      ),
      h('details', {}, h('summary', {}, 'Methods'), this.#methods),
      h('details', {}, h('summary', {}, 'Numbers'), table('Numbers: speed against accuracy', head, this.#body)),
      h('details', {}, h('summary', {}, 'How it was measured'), this.#notes),
      this.#links,
    );
    root.append(
      h(
        'div',
        {},
        h(
          'form',
          {
            novalidate: true,
            change: changed,
            submit: (/** @type {Event} */ event) => {
              event.preventDefault();
              void this.ask();
            },
          },
          h('p', { class: 'precision-row' }, h('label', { for: 'precision-impacts' }, 'Contacts'), this.#impacts),
          this.#error,
          h('p', { class: 'precision-row' }, h('label', { for: 'precision-axis' }, 'Across'), this.#axis),
          this.#task.buttons,
          this.#task.told,
        ),
      ),
      this.#sheet,
    );
    this.#task.say(
      'Eleven methods with all their settings, one after the other: about three seconds, longer while the server has other work.',
    );
    this.#reader.box.classList.add('figure-box');
    this.#reader.read({
      nearest: (event) => this.#plot?.nearest(event) ?? null,
      moved: (key, at) => this.#moved(key, at),
      mark: (index) => this.#plot?.mark(index),
      words: (index) => this.#words(this.#drawn[index]),
    });
    this.restore(new URLSearchParams());
  }

  /** The panel's part of the address. */
  query() {
    const query = new URLSearchParams();
    const impacts = parse(this.#impacts.value, null);
    if (isRight(impacts) && impacts !== USUAL_IMPACTS) query.set('precision.impacts', String(impacts));
    if (this.#axis.value !== 'time') query.set('precision.axis', this.#axis.value);
    return query;
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    const dropped = [];
    const text = link.get('precision.impacts');
    const impacts = text === null ? USUAL_IMPACTS : Number(text);
    if (!isRight(impacts)) dropped.push(`precision.impacts “${text?.slice(0, 40)}”: it must be ${MUST}`);
    this.#impacts.value = String(isRight(impacts) ? impacts : USUAL_IMPACTS);
    this.#error.textContent = '';
    const axis = link.get('precision.axis') ?? 'time';
    if (!Object.hasOwn(AXES, axis))
      dropped.push(`precision.axis “${axis.slice(0, 40)}”: it must be one of ${Object.keys(AXES).join(', ')}`);
    this.#axis.value = Object.hasOwn(AXES, axis) ? axis : 'time';
    this.#draw();
    return dropped;
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    if (this.#task.active) this.#task.stop('The scene has changed; measure again.');
    else if (this.#shown) {
      this.#task.say('The scene has changed since.');
      this.#sheet.classList.add('stale');
    }
  }

  async ask() {
    const impacts = parse(this.#impacts.value, null);
    const request = this.#query();
    if (!request) return this.#task.say('A parameter of the scene is not a number; it is marked among them.');
    request.set('bounces', String(impacts));
    const answer = await this.#task.ask(`v1/precision?${request}`);
    if (!answer) return;
    this.#shown = { answer: answer.end, pictures: answer.pictures, request };
    const { kind, bounces: seen } = this.#shown.answer.reference.outcome;
    this.#task.say(
      `Measured over ${number(seen)} bounces in ${number(this.#task.took, 2)} s: ${kind.replaceAll('_', ' ')}.`,
    );
    this.#sheet.classList.remove('stale');
    this.#sheet.hidden = false;
    this.#show();
  }

  #show() {
    if (!this.#shown) return;
    const {
      answer: { methods, points, notes, reference },
    } = this.#shown;
    this.#draw();
    const title = new Map(methods.map((method) => [method.name, method.title]));
    const missing = (/** @type {string} */ name) => {
      const own = points.filter(({ method }) => method === name);
      return own.some(({ error }) => error !== null)
        ? ''
        : name === 'extended'
          ? 'the reference'
          : `not drawn: ${own[0]?.reason ?? 'no run'}`;
    };
    this.#methods.replaceChildren(
      ...methods.map(({ name, title: words, about }) =>
        h(
          'li',
          {},
          this.#symbol(name),
          h(
            'span',
            {},
            words,
            h('span', { class: 'muted' }, ...marked([about, missing(name)].filter(Boolean).join('; '))),
          ),
        ),
      ),
    );
    this.#body.replaceChildren(
      ...points.map((point) => {
        const spread = point.spread_ns_per_bounce;
        const best = [point.pareto && 'time', point.pareto_evaluations && 'evaluations']
          .filter((word) => word)
          .join(', ');
        const cells = [
          setting(point),
          number(point.cost_ns_per_bounce),
          spread ? `${number(spread[0])} to ${number(spread[1])}` : '–',
          number(point.steps, 7),
          number(point.evaluations, 9),
          number(point.error, 3),
          best,
        ];
        const line = row(title.get(point.method) ?? point.method, cells);
        line.append(h('td', {}, ...marked(point.reason ?? point.outcome.kind)));
        return line;
      }),
    );
    this.#notes.replaceChildren(
      h(
        'p',
        { class: 'muted' },
        `Errors are the largest of |ρδθ|, |δẋ|, |δẏ| and |ρδθ̇| just before bounce ${number(reference.outcome.bounces)}, from the run with 31 digits.`,
      ),
      ...notes.map((note) => h('p', { class: 'muted' }, ...marked(note))),
    );
  }

  /** The symbol of a method, as the chart has it; empty for a method that is not drawn. @param {string} method */
  #symbol(method) {
    const index = this.#drawn.findIndex((point) => point.method === method);
    const place = this.#plot?.points[index] ?? { x: 0, y: 0 };
    const mark = this.#reader.box.querySelector(`[data-mark="${method}"]`)?.cloneNode(true);
    const box = `${place.x - 8} ${place.y - 8} 16 16`;
    return svg('svg', { class: 'figure', viewBox: box, 'aria-hidden': 'true' }, ...(mark ? [mark] : []));
  }

  #draw() {
    if (!this.#shown) return;
    const {
      answer: { points },
      pictures,
      request,
    } = this.#shown;
    const axis = AXES[this.#axis.value];
    const figure = figureOf(pictures[this.#axis.value]);
    this.#reader.box.replaceChildren(figure);
    this.#plot = new FigurePoints(figure, ['point']);
    this.#drawn = this.#plot.points.map(({ values }) => points[Number(values.point)]);
    this.#reader.box.setAttribute(
      'aria-label',
      `Speed against accuracy: error over ${axis.title.toLowerCase()}, ${this.#drawn.length} points`,
    );
    this.#front.textContent = axis.hasFront
      ? 'Nothing lies below and left of the front.'
      : 'Steps of different methods are different work, so there is no front.';
    // A picture is of a measurement of its own: no two of them are the same.
    const picture = new URLSearchParams(request);
    picture.set('axis', this.#axis.value);
    this.#links.replaceChildren(
      'Measured anew as ',
      ...actions({
        id: 'precision',
        title: 'Speed against accuracy',
        path: `v1/precision?${picture}`,
        formats: ['svg', 'png', 'csv', 'arrow', 'json'],
      }),
    );
    this.#reader.point(null, false);
  }

  /** @param {Point} point */
  #words(point) {
    const title = this.#shown?.answer.methods.find(({ name }) => name === point.method)?.title ?? point.method;
    const spread = point.spread_ns_per_bounce;
    return [
      title,
      setting(point),
      `${number(point.cost_ns_per_bounce)} ns a bounce${spread ? ` (${number(spread[0])} to ${number(spread[1])})` : ''}`,
      `${number(each(point, point.steps))} steps`,
      point.evaluations === null ? '' : `${number(each(point, point.evaluations))} evaluations`,
      `error ${number(point.error, 3)}`,
    ]
      .filter((part) => part)
      .join('   ');
  }

  /** The point that a key leads to. @param {string} key @param {number | null} at @returns {number | null | undefined} */
  #moved(key, at) {
    const last = this.#drawn.length - 1;
    if (last < 0) return undefined;
    const turns = [...this.#drawn.keys()].filter(
      (index) => index === 0 || this.#drawn[index].method !== this.#drawn[index - 1].method,
    );
    const own = turns.findLast((index) => index <= (at ?? 0)) ?? 0;
    return {
      ArrowRight: at === null ? 0 : Math.min(last, at + 1),
      ArrowLeft: at === null ? last : Math.max(0, at - 1),
      ArrowDown: at === null ? 0 : (turns.find((index) => index > at) ?? at),
      ArrowUp: at === null ? last : (turns.findLast((index) => index < own) ?? 0),
      Home: 0,
      End: last,
      Escape: null,
    }[key];
  }
}
