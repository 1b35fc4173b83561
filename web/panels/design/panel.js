// The panel that designs a law α = −K·(x, θ, ẋ, θ̇) for the page's scene by chosen weights, and runs it.

import { here, readFigure } from '../../charts/readable/server-figure.js';
import { entries, row, table } from '../../dom/tables.js';
import { LatestRequest } from '../../api/latest-request.js';
import { wordsOf } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { term } from '../../dom/glossary.js';
import { marked, prose, symbol } from '../../dom/typeset.js';
import { NO_SCENE, pictured, savings, study, studyForm } from '../study.js';
import { committed, numberInput } from '../../dom/number-input.js';
import { number, quantity } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';

/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Eigenvalue} Eigenvalue */
/** @typedef {import('contract').Controller} Controller */

/** @type {[string, string, string, string][]} name, sign, weight at first, unit of the gain */
const STATES = [
  ['x', 'x', '1', 'rad/m'],
  ['theta', 'θ', '10', '1'],
  ['x_dot', 'ẋ', '0.1', 'rad·s/m'],
  ['theta_dot', 'θ̇', '0.1', 's'],
];
const INPUT = '10';
const CONTACTS = { '': 'As the scene’s', frictionless: 'Frictionless', stick: 'Sticks' };

/** @param {Eigenvalue} eigenvalue */
const complex = ({ re, im }) =>
  im === 0 ? number(re) : `${number(re)} ${im < 0 ? '\u2212' : '+'} ${number(Math.abs(im))} i`;

/** The eigenvalues of the closed loop beside those without a law. @param {Eigenvalue[]} closed @param {Eigenvalue[]} open */
function eigenvalueRows(closed, open) {
  const cells = (/** @type {Eigenvalue | undefined} */ one) => (one ? [complex(one), number(one.modulus)] : ['–', '–']);
  const rows = Array.from({ length: Math.max(closed.length, open.length) }, (_, index) => {
    const [first, ...rest] = [...cells(closed[index]), ...cells(open[index])];
    return row(first, rest);
  });
  return h('tbody', {}, ...rows);
}

/** @type {import('../card.js').Module['mount']} */
export const mount = (root, page) => new DesignPanel(root, page);

class DesignPanel {
  #page;
  /** @type {Map<string, HTMLInputElement>} */
  #weights = new Map();
  #error = h('p', { class: 'error', id: 'design-error' });
  #contact = h(
    'select',
    { id: 'design-contact', change: () => this.#page.changed() },
    ...Object.entries(CONTACTS).map(([value, words]) => h('option', { value }, words)),
  );
  #told;
  #sheet;
  #run = h(
    'button',
    {
      type: 'button',
      id: 'design-run',
      class: 'primary',
      hidden: true,
      click: () => this.#designed && this.#page.play(this.#designed),
    },
    'Use this law',
  );
  /** The scene with the law of the sheet. @type {Scene | null} */
  #designed = null;
  #latest = new LatestRequest();

  /**
   * @param {HTMLElement} root
   * @param {import('../card.js').PanelPage} page
   */
  constructor(root, page) {
    this.#page = page;
    const { told, sheet } = study(root, 'design');
    this.#told = told;
    this.#sheet = sheet;
    const row = (/** @type {string} */ name, /** @type {string} */ sign, /** @type {string} */ value) => {
      const input = numberInput({ id: `design-${name}`, change: () => page.changed() }, this.#error, {
        unit: null,
        fault: (weight) =>
          weight > 0 || (weight === 0 && name !== 'input')
            ? null
            : 'Weights must be numbers from 0 on, that of the tilt above 0.',
      });
      input.defaultValue = value;
      this.#weights.set(name, input);
      return h('p', { class: 'study-row' }, h('label', { for: `design-${name}` }, 'of ', symbol(sign)), input);
    };
    root.append(
      studyForm(
        'design',
        'Design',
        () => void this.ask(),
        [this.#run, told],
        [
          h(
            'fieldset',
            { class: 'study-settings' },
            h('legend', {}, 'Weights of squared deviations (', term('lqr', 'LQR'), ')'),
            ...STATES.map(([name, sign, value]) => row(name, sign, value)),
            row('input', 'α', INPUT),
            h('p', { class: 'study-row' }, h('label', { for: 'design-contact' }, 'Contact'), this.#contact),
          ),
          this.#error,
        ],
      ),
      sheet,
    );
    this.#told.append(
      'A tilt in proportion to the angle leaves the rod circling and drifting. A law that feeds back the whole state brings it to rest in place.',
    );
  }

  /** The panel's part of the address. */
  query() {
    const query = new URLSearchParams(
      [...this.#weights]
        .filter(([, input]) => committed(input).trim() !== input.defaultValue)
        .map(([name, input]) => [`design.weights.${name}`, committed(input).trim()]),
    );
    if (this.#contact.value) query.set('design.contact', this.#contact.value);
    return query;
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    const dropped = [];
    for (const [name, input] of this.#weights) {
      const text = link.get(`design.weights.${name}`);
      const right = text === null || parse(text, null) !== null;
      if (!right) dropped.push(`the weight “${text.slice(0, 40)}”, which is not a number`);
      input.value = right && text !== null ? text : input.defaultValue;
    }
    const contact = link.get('design.contact') ?? '';
    if (contact in CONTACTS) this.#contact.value = contact;
    else dropped.push(`the contact “${contact.slice(0, 40)}”`);
    return dropped;
  }

  /** The scene of the page is another one. */
  sceneChanged() {
    this.#latest.cancel();
    if (this.#sheet.hidden) return;
    this.#told.replaceChildren('The scene has changed since; design anew for it.');
    this.#stale(true);
  }

  /** A law for another scene is dimmed, and not offered to run. @param {boolean} stale */
  #stale(stale) {
    this.#sheet.classList.toggle('stale', stale);
    this.#run.hidden = stale;
  }

  /** The request; null while the scene is not whole. */
  #request() {
    const request = this.#page.query();
    for (const [name, input] of this.#weights)
      request?.set(name === 'input' ? 'weights.input' : `weights.state.${name}`, String(parse(committed(input), null)));
    if (this.#contact.value) request?.set('contact', this.#contact.value);
    if (!request) this.#told.replaceChildren(NO_SCENE);
    return request;
  }

  retell() {
    if (!this.#sheet.hidden) void this.ask();
  }

  async ask() {
    const request = this.#request();
    if (!request) return;
    const signal = this.#latest.next();
    const path = `v1/controllers?${request}`;
    try {
      const [answer, figure] = await pictured(path, signal);
      if (!signal.aborted) this.#show(answer, figure, path);
    } catch (error) {
      if (signal.aborted) return;
      this.#sheet.hidden = this.#run.hidden = true;
      this.#told.replaceChildren(...marked(wordsOf(error)));
    }
  }

  /** @param {Controller} answer @param {SVGSVGElement} figure @param {string} path */
  #show(answer, figure, path) {
    const {
      scene,
      gain,
      stable,
      eigenvalues,
      open_loop: open,
      spectral_radius: radius,
      bounces_per_decade: decade,
      margins: [margin],
      regions,
      notes,
      contact,
    } = answer;
    this.#told.replaceChildren(
      stable ? 'Every small deviation that is fed back dies out.' : 'This law does not hold: a small deviation grows.',
    );
    /** @type {[string | Node, string, string][]} */
    const rows = [
      ...STATES.filter(([name]) => name in gain).map(
        ([name, sign, , unit]) =>
          /** @type {[Node, string, string]} */ ([
            symbol(`K_${sign}`),
            quantity(gain[/** @type {keyof typeof gain} */ (name)], unit, 5),
            `gain of ${sign}`,
          ]),
      ),
      [term('spectral-radius'), number(radius), 'largest factor per bounce'],
      ['decade', decade === null ? '–' : number(decade), 'bounces to a tenth'],
      [
        term('gain-margin', 'margin'),
        margin ? `${number(margin.below?.limit)} to ${number(margin.above?.limit)}` : '–',
        'factors on the whole gain that still hold',
      ],
      ['contact', contact, 'that the law is for'],
      [term('riccati', 'residual'), number(answer.residual, 2), 'of the Riccati equation'],
    ];
    const region = (/** @type {string} */ name, /** @type {string | null | undefined} */ address) =>
      address && h('a', { href: `${here(address)}&format=svg` }, name);
    const reader = readFigure(figure, {
      name: 'design',
      label: `Eigenvalues of the closed loop on the unit circle, the largest ${number(radius)}; they are in the table. Beside them, the largest as the gain is scaled.`,
      values: ['factor', 'modulus'],
      words: ({ factor, modulus }) => `gain × ${number(Number(factor))}   max |λ| ${number(Number(modulus), 5)}`,
      hint: 'With keys: left and right scale the gain, page up and page down by a tenth of the way.',
    });
    this.#designed = scene;
    this.#stale(false);
    this.#sheet.replaceChildren(
      reader,
      h(
        'div',
        {},
        h('dl', { class: 'numbers', id: 'design-gains' }, ...entries(rows)),
        (regions?.designed || regions?.proportional) &&
          h(
            'p',
            { class: 'actions', id: 'design-regions' },
            'What it survives: ',
            region('with the law', regions.designed),
            region('with the tilt gain', regions.proportional),
          ),
        h(
          'details',
          {},
          h('summary', {}, 'Eigenvalues'),
          table(
            'Eigenvalues',
            ['λ of the closed loop', '|λ|', 'λ without a law', '|λ|'],
            eigenvalueRows(eigenvalues, open),
            'eigenvalues',
          ),
        ),
        notes.length > 0 &&
          h(
            'details',
            {},
            h('summary', {}, 'Notes'),
            ...notes.map((note) =>
              h('p', { class: 'muted small' }, ...prose(note[0].toUpperCase() + note.slice(1)), '.'),
            ),
          ),
        savings('design', 'Design a controller', path),
      ),
    );
    this.#sheet.hidden = false;
  }
}
