// The panel of survival under noise: how long many runs of the page's scene last. It asks on request only.

import { NO_SCENE } from '../study.js';
import { ChartReader, movedInRow } from '../../charts/readable/chart-reader.js';
import { FigureColumns, figureOf } from '../../charts/readable/server-figure.js';
import { entries, row, table } from '../../dom/tables.js';
import { LongRequest } from '../long-request.js';
import { actions } from '../../export/save-actions.js';
import { h } from '../../dom/elements.js';
import { marked, prose } from '../../dom/typeset.js';
import { shownValue } from '../../dom/units.js';
import { term } from '../../dom/glossary.js';
import { committed, numberInput } from '../../dom/number-input.js';
import { fixed, number, quantity } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';

/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Ensemble} Ensemble */

const QUANTILES = /** @type {const} */ (['q05', 'q25', 'q50', 'q75', 'q95']);
/** The inputs: name in requests, value at first, factor from the request's unit to the typed one, limit, and the limit in words. */
const TYPED = {
  runs: {
    key: 'runs',
    sent: 'runs',
    usual: 200,
    unit: null,
    scale: 1,
    most: 20_000,
    must: `a whole number from 1 to ${number(20_000, 7)}`,
  },
  impacts: {
    key: 'impacts',
    sent: 'bounces',
    usual: 400,
    unit: null,
    scale: 1,
    most: 100_000,
    must: `a whole number from 1 to ${number(100_000, 7)}`,
  },
  // Noise for a scene that has none.
  timing: {
    key: 'timing_sd',
    sent: 'scene.noise.timing_sd',
    usual: 0.01,
    unit: 'ms',
    scale: 1000,
    most: 1,
    must: 'a number above 0 and up to 1000 ms',
  },
};
/** @typedef {keyof typeof TYPED} Name */
const NAMES = /** @type {Name[]} */ (Object.keys(TYPED));
const READINGS = { strike: 'It strikes early or late', plan: 'It carries out the plan for a wrong time' };

/** @param {Name} name @param {number | null} value */
const isRight = (name, value) =>
  value !== null && value > 0 && value <= TYPED[name].most && (TYPED[name].scale !== 1 || Number.isInteger(value));

/** A share in whole per cent; near all or none with a decimal, so that no share but 0 and 1 reads as such. @param {number} share */
const percent = (share) => {
  const whole = Math.round(100 * share);
  return (whole === 0 || whole === 100) && share > 0 && share < 1 ? fixed(100 * share, 1) : fixed(whole, 0);
};

/** Errors beside those of timing and angle, with symbol and unit. */
const FURTHER = /** @type {const} */ ([
  ['x_sd', 'σ_x', 'm'],
  ['x_dot_sd', 'σ_ẋ', 'm/s'],
  ['y_dot_sd', 'σ_ẏ', 'm/s'],
  ['theta_dot_sd', 'σ_θ̇', 'rad/s'],
  ['restitution_sd', 'σ_e', '1'],
]);

/** @param {Scene} scene */
const hasNoise = ({ noise }) =>
  Object.entries(noise ?? {}).some(([key, value]) => key.endsWith('_sd') && Number(value) > 0);

/** @param {Name} name @param {HTMLElement} error */
const typed = (name, error) =>
  numberInput({ id: `survival-${name}` }, error, {
    unit: TYPED[name].unit,
    fault: (value) => (isRight(name, value / TYPED[name].scale) ? null : `It must be ${TYPED[name].must}.`),
  });

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new SurvivalPanel(root, page);

class SurvivalPanel {
  #page;
  #errors = {
    runs: h('p', { class: 'error', id: 'survival-runs-error' }),
    impacts: h('p', { class: 'error', id: 'survival-impacts-error' }),
    timing: h('p', { class: 'error', id: 'survival-timing-error' }),
  };
  #inputs = {
    runs: typed('runs', this.#errors.runs),
    impacts: typed('impacts', this.#errors.impacts),
    timing: typed('timing', this.#errors.timing),
  };
  #reading = h(
    'select',
    { id: 'survival-reading' },
    ...Object.entries(READINGS).map(([value, words]) => h('option', { value }, words)),
  );
  #offered;
  #own = h('p', { class: 'muted', id: 'survival-noise' });
  #task = new LongRequest(
    'survival',
    h('button', { type: 'submit', id: 'survival-start', class: 'primary' }, 'Run them all'),
    'Running',
    'runs',
  );
  #reader = new ChartReader('survival', 'Survival');
  #headline = h('p', { class: 'answer', id: 'survival-headline' });
  #numbers = h('dl', { class: 'numbers', id: 'survival-numbers' });
  #body = h('tbody');
  #notes = h('div');
  #links = h('p', { class: 'actions', id: 'survival-links' });
  #sheet;
  /** @type {FigureColumns | null} */
  #plot = null;
  /** @type {{answer: Ensemble, path: string} | null} */
  #shown = null;

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    const field = (/** @type {Name} */ name, /** @type {string} */ label) => [
      h('p', { class: 'study-row' }, h('label', { for: `survival-${name}` }, label), this.#inputs[name]),
      this.#errors[name],
    ];
    this.#offered = h(
      'div',
      { id: 'survival-offer' },
      h('p', { class: 'muted' }, 'The scene has no noise; this one is tried.'),
      ...field('timing', 'σ_t / ms'),
      h(
        'p',
        { class: 'study-row survival-wide' },
        h('label', { for: 'survival-reading' }, 'A table that errs in time:'),
        this.#reading,
      ),
    );
    this.#offered.querySelector('label')?.replaceChildren(...marked('σ_t / ms'));
    const head = [
      'Bounce',
      term('at-risk', 'at risk'),
      'ended',
      'going on',
      term('wilson', '95 % from'),
      'to',
      ...QUANTILES.map((name) => `|θ| ${Number(name.slice(1))} % / rad`),
    ];
    this.#sheet = h(
      'div',
      { class: 'study-sheet survival-sheet', hidden: true },
      this.#headline,
      h(
        'div',
        { class: 'survival-chart' },
        this.#reader.box,
        this.#reader.readout,
        this.#reader.spoken,
        h(
          'p',
          { class: 'muted small', id: 'survival-hint' },
          'Above: the share of runs going on after each bounce. Below: |θ| of those that go on. With keys: left and right go from bounce to bounce, page up and page down by a tenth.',
        ),
      ),
      h(
        'div',
        {},
        this.#numbers,
        h('details', {}, h('summary', {}, 'Numbers'), table('Numbers: survival', head, this.#body)),
        h('details', {}, h('summary', {}, 'How it was counted'), this.#notes),
        this.#links,
      ),
    );
    root.classList.add('study');
    root.append(
      h(
        'form',
        {
          novalidate: true,
          change: page.changed,
          submit: (/** @type {Event} */ event) => {
            event.preventDefault();
            void this.ask();
          },
        },
        ...field('runs', 'Runs'),
        ...field('impacts', 'Bounces'),
        this.#own,
        this.#offered,
        this.#task.buttons,
        this.#task.told,
      ),
      this.#sheet,
    );
    this.#reader.box.classList.add('figure-box');
    this.#reader.read({
      nearest: (event) => this.#plot?.nearest(event) ?? null,
      moved: (key, at) => (this.#shown ? movedInRow(key, at, 1, this.#shown.answer.bounces) : undefined),
      mark: (contact) => this.#plot?.mark(contact),
      words: (contact) => (this.#shown ? wordsAt(this.#shown.answer, contact) : ''),
    });
    this.#offer();
    this.restore(new URLSearchParams());
  }

  /** The panel's part of the address. */
  query() {
    const query = new URLSearchParams();
    for (const name of NAMES) {
      const value = this.#value(name);
      if (isRight(name, value) && value !== TYPED[name].usual) query.set(`survival.${TYPED[name].key}`, String(value));
    }
    if (this.#reading.value !== 'strike') query.set('survival.model', this.#reading.value);
    return query;
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    const dropped = [];
    for (const name of NAMES) {
      const { key, usual, scale, must } = TYPED[name];
      const text = link.get(`survival.${key}`);
      const value = text === null ? usual : Number(text);
      if (!isRight(name, value)) dropped.push(`survival.${key} “${text?.slice(0, 40)}”: it must be ${must}`);
      this.#inputs[name].value = String(Number(((isRight(name, value) ? value : usual) * scale).toPrecision(12)));
      this.#errors[name].textContent = '';
    }
    const model = link.get('survival.model') ?? 'strike';
    if (!Object.hasOwn(READINGS, model))
      dropped.push(`survival.model “${model.slice(0, 40)}”: it must be ${Object.keys(READINGS).join(' or ')}`);
    this.#reading.value = Object.hasOwn(READINGS, model) ? model : 'strike';
    return dropped;
  }

  retell() {
    this.#offer();
    if (!this.#sheet.classList.contains('stale')) this.#show();
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#offer();
    if (this.#task.active) this.#task.stop('The scene has changed; run them again.');
    else if (this.#shown) {
      this.#task.say('The scene has changed since.');
      this.#stale(true);
    }
  }

  /** Curves of another scene are dimmed, and the button offers to run anew. @param {boolean} stale */
  #stale(stale) {
    this.#sheet.classList.toggle('stale', stale);
    const start = this.#task.buttons.querySelector('button');
    if (start) start.textContent = stale ? 'Run again' : 'Run them all';
  }

  /** Noise to try with, where the scene has none. */
  #offer() {
    const scene = this.#page.scene();
    const own = hasNoise(scene);
    this.#offered.hidden = own;
    this.#own.hidden = !own;
    const { timing_sd: timing, angle_sd: angle, model = 'strike' } = scene.noise ?? {};
    const parts = [
      timing && `σ_t = ${quantity(timing * 1000, 'ms')}`,
      angle && `σ_α = ${quantity(angle, 'rad')}`,
      ...FURTHER.map(([key, symbol, unit]) => scene.noise?.[key] && `${symbol} = ${quantity(scene.noise[key], unit)}`),
    ].filter((part) => part);
    this.#own.replaceChildren(
      'Noise of the scene: ',
      ...marked(parts.join(', ')),
      timing ? `. ${READINGS[/** @type {'strike'} */ (model)] ?? model}.` : '.',
    );
  }

  /** A typed value in the server's unit; null where it is no number. @param {Name} name */
  #value(name) {
    const value = parse(committed(this.#inputs[name]), TYPED[name].unit);
    return value === null ? null : Number((value / TYPED[name].scale).toPrecision(12));
  }

  /** The request; null while the scene is not whole. */
  #request() {
    const request = this.#page.query();
    for (const name of NAMES) {
      if (name === 'timing' && this.#offered.hidden) continue;
      request?.set(TYPED[name].sent, String(this.#value(name)));
    }
    if (!this.#offered.hidden) request?.set('scene.noise.model', this.#reading.value);
    if (!request) this.#task.say(NO_SCENE);
    return request;
  }

  async ask() {
    const request = this.#request();
    if (!request) return;
    const path = `v1/ensembles?${request}`;
    const answer = await this.#task.ask(path);
    if (!answer) return;
    this.#shown = { answer: answer.end, path };
    this.#sheet.hidden = false;
    this.#stale(false);
    this.#show();
    const figure = figureOf(answer.pictures.survival);
    this.#reader.box.replaceChildren(figure);
    this.#plot = new FigureColumns(figure);
    this.#reader.point(null, false);
  }

  #show() {
    if (!this.#shown) return;
    const { answer, path } = this.#shown;
    const { survived, runs, bounces, counts, survival, quantiles } = answer;
    this.#task.say(`${number(survived.runs, 6)} of ${number(runs, 6)} runs outlast ${number(bounces, 7)} bounces.`);
    this.#page.told?.(
      `${percent(survived.share)} % of ${number(runs, 6)} runs last ${number(bounces, 7)} bounces`,
      null,
    );
    const ends = Object.entries(counts)
      .filter(([name, count]) => name !== 'completed' && count > 0)
      .map(([name, count]) => `${number(count, 6)} ${name.replaceAll('_', ' ')}`);
    this.#headline.replaceChildren(
      h('strong', { class: 'large' }, `${percent(survived.share)} %`),
      ` last ${number(bounces, 7)} bounces, ${percent(survived.lower)} to ${percent(survived.upper)} % `,
      term('wilson', 'with 95 % confidence'),
      '.',
    );
    /** @type {[string | Node, string, string][]} */
    const rows = [
      [
        term('median', 'median'),
        answer.median_bounces === null ? `> ${number(bounces, 7)}` : number(answer.median_bounces, 7),
        'bounces of a run',
      ],
      ['mean', `${survived.runs > 0 ? '≥ ' : ''}${number(answer.mean_bounces)}`, 'bounces of a run'],
      [
        term('half-life', 'half-life'),
        answer.half_life === null ? '–' : number(answer.half_life),
        'bounces, late in the runs',
      ],
      ['ends', ends.join(', ') || 'none', 'of those that did not last'],
    ];
    this.#numbers.replaceChildren(...entries(rows));
    this.#body.replaceChildren(
      ...quantiles.n.map((contact, index) => {
        const at = contact - 1;
        const cells = [
          number(survival.at_risk[at], 6),
          number(survival.ended[at], 6),
          number(survival.survival[at]),
          number(survival.lower[at]),
          number(survival.upper[at]),
          ...QUANTILES.map((name) => number(shown(quantiles[name][index]))),
        ];
        return row(number(contact, 7), cells);
      }),
    );
    this.#notes.replaceChildren(...answer.notes.map((note) => h('p', { class: 'muted' }, ...prose(note))));
    this.#reader.box.setAttribute(
      'aria-label',
      `Survival: ${number(survived.share)} of the runs outlast ${number(bounces, 7)} bounces`,
    );
    this.#links.replaceChildren(
      ...actions({
        id: 'survival',
        title: 'Survival under noise',
        path,
        formats: ['svg', 'png', 'csv', 'arrow', 'json'],
      }),
      h(
        'button',
        { type: 'button', id: 'survival-first', click: () => this.#page.play(answer.scene) },
        'Watch the first run',
      ),
    );
  }
}

/** An angle as a number in the shown unit. @param {number | null} angle */
const shown = (angle) => angle && shownValue(angle, 'rad');

/** @param {Ensemble} answer @param {number} contact */
function wordsAt({ survival, quantiles }, contact) {
  const at = contact - 1;
  const index = quantiles.n.findLastIndex((n) => n <= contact);
  const median = quantiles.n[index] === contact ? quantiles.q50[index] : null;
  return [
    `bounce ${number(contact, 7)}`,
    `going on ${number(survival.survival[at])} (${number(survival.lower[at])} to ${number(survival.upper[at])})`,
    `at risk ${number(survival.at_risk[at], 6)}`,
    median === null ? '' : `median |θ| ${quantity(median, 'rad')}`,
  ]
    .filter((part) => part)
    .join('   ');
}
