// A lab's own impacts over the simulated ones, and how far the two are apart. What is loaded stays in this page.

import { row, table } from '../../dom/tables.js';
import { ColumnPicker } from './columns.js';
import { COMPARED, SYMBOLS, residuals, sums } from './compare.js';
import { measured } from './file.js';
import { derivedOf } from '../../physics/body.js';
import { drawResiduals } from './residual-chart.js';
import { h } from '../../dom/elements.js';
import { invalidate } from '../../charts/surface.js';
import { number, parse } from '../../dom/numbers.js';
import { shownFactor, shownUnit } from '../../dom/units.js';
import { onThemeChange } from '../../charts/theme.js';
import { svg } from '../../charts/svg.js';

/** @typedef {import('./read.js').Measured} Measured */
/** @typedef {import('./compare.js').Compared} Compared */
/** @typedef {import('./compare.js').Residual} Residual */
/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {{run: import('../../run/run.js').Run, plots: import('../../charts/impacts/impact-plot.js').ImpactPlot[], drawn: () => Scene}} MeasuredParts */

/** Name and shown unit of a quantity. @param {Compared} quantity */
const nameOf = (quantity) => SYMBOLS[quantity].map(shownUnit).join(' / ');

/** Residuals in the units that are shown. @param {Residual} one @returns {Residual} */
const asShown = (one) => ({
  ...one,
  theta: one.theta * shownFactor('rad'),
  theta_dot: one.theta_dot * shownFactor('rad/s'),
});
/** Time between two comparisons during a run, ms. */
const PACE_MS = 300;
/** More rows than these are no reading. */
const LISTED = 500;

export class MeasuredPanel {
  #page;
  #run;
  /** The impacts as in the file. @type {Measured[]} */
  #read = [];
  /** With their numbers in the run. @type {Measured[]} */
  #impacts = [];
  /** The constants that the points over the plots were computed with. */
  #laid = '';
  #compared_ms = -Infinity;
  #chip = h('span', { class: 'chip measured-chip', id: 'measured-chip', hidden: true });
  #name = h('h3', { id: 'measured-title' }, 'Measured impacts');
  #told = h('p', { id: 'measured-told', role: 'status' });
  #columns = new ColumnPicker('measured', (picks) => measured.pick(picks));
  #remarks = h('ul', { class: 'measured-remarks', id: 'measured-remarks' });
  #first = h('input', {
    type: 'text',
    inputmode: 'numeric',
    autocomplete: 'off',
    id: 'measured-first',
    'aria-describedby': 'measured-first-error',
    change: () => this.#number(),
  });
  #error = h('p', { class: 'error', id: 'measured-first-error' });
  #offset = h(
    'p',
    { class: 'measured-offset' },
    h('label', { for: 'measured-first' }, 'The first measured impact is n ='),
    this.#first,
  );
  #box = h('div', { class: 'measured-box', role: 'img', 'aria-label': 'Residuals' });
  #sums = h('tbody');
  #rows = h('tbody');
  #numbers;
  #sheet;
  #panel;

  /**
   * @param {HTMLElement} bar over the plots
   * @param {MeasuredParts} page
   */
  constructor(bar, page) {
    this.#page = page;
    this.#run = page.run;
    this.#numbers = h(
      'details',
      { toggle: () => this.#compare() },
      h('summary', {}, 'Numbers'),
      table('Numbers: residuals', ['impact', ...COMPARED.map((quantity) => SYMBOLS[quantity].join(' / '))], this.#rows),
    );
    this.#sheet = h(
      'div',
      { class: 'measured-sheet', hidden: true },
      this.#box,
      h('div', {}, table('Residuals in sum', ['residual', 'RMS', 'largest', 'at n'], this.#sums), this.#numbers),
    );
    this.#panel = h(
      'section',
      { class: 'card measured', 'aria-labelledby': 'measured-title', hidden: true },
      h(
        'div',
        { class: 'card-head' },
        this.#name,
        h('button', { type: 'button', id: 'measured-remove', click: () => measured.remove() }, 'Remove'),
      ),
      h(
        'p',
        { class: 'muted' },
        'Measured less simulated at the same impact; t counts from the first that both have. The file stays in this browser, unless you press Fit in the tab Fit.',
      ),
      this.#told,
      this.#remarks,
      this.#columns.element,
      this.#offset,
      this.#error,
      this.#sheet,
    );
    bar.parentElement?.append(this.#panel);
    bar.querySelector('#measured-load')?.before(this.#chip);
    new ResizeObserver(() => this.struck()).observe(this.#box);
    onThemeChange(() => this.struck());
    measured.watch((fresh) => this.#take(fresh));
    if (measured.name) this.#take(true);
  }

  /** Shows what is in the file, or says why not. @param {boolean} fresh another file, not the same with other columns */
  #take(fresh) {
    const { name, reading, refusal, heads } = measured;
    if (!reading) {
      this.#clear();
      this.#remarks.replaceChildren();
      this.#columns.show(heads, '');
      this.#columns.element.open = heads.length > 0;
      this.#told.textContent = `${name}: ${refusal}`;
      this.#panel.hidden = refusal === '';
      // The button that removed it is gone.
      if (refusal === '' && !document.activeElement?.checkVisibility())
        document.getElementById('measured-load')?.focus();
      return;
    }
    this.#panel.hidden = false;
    this.#name.textContent = `Measured impacts: ${name}`;
    const unused = reading.remarks.filter((words) => words.startsWith('Not used:'));
    this.#remarks.replaceChildren(
      ...reading.remarks.filter((words) => !unused.includes(words)).map((words) => h('li', {}, words)),
    );
    this.#columns.show(heads, unused.join(' '));
    this.#read = reading.impacts;
    this.#first.value = String(reading.impacts[0].n);
    this.#chip.replaceChildren(
      svg(
        'svg',
        { viewBox: '0 0 12 12', width: 12, height: 12, 'aria-hidden': 'true' },
        svg('path', { d: 'M6 1L11 6L6 11L1 6Z' }),
      ),
      ` measured (${number(reading.impacts.length, 7)})`,
    );
    this.#chip.hidden = this.#offset.hidden = false;
    this.#number();
    if (fresh) this.#panel.scrollIntoView({ block: 'nearest' });
  }

  #clear() {
    this.#name.textContent = 'Measured impacts';
    this.#read = this.#impacts = [];
    this.#laid = '';
    for (const plot of this.#page.plots) plot.lay([]);
    this.#chip.hidden = this.#offset.hidden = this.#sheet.hidden = true;
  }

  /** Numbers the measured impacts from the typed number of the first one. */
  #number() {
    const first = parse(this.#first.value, null);
    const right = first !== null && Number.isInteger(first) && first >= 1;
    this.#error.textContent = right ? '' : 'It must be a whole number from 1.';
    this.#first.setAttribute('aria-invalid', String(!right));
    if (!right) return;
    this.#impacts = this.#read.map((one) => ({ ...one, n: one.n - this.#read[0].n + first }));
    this.#laid = '';
    this.#compared_ms = -Infinity;
    this.struck();
  }

  /** There are other simulated impacts. */
  struck() {
    if (this.#impacts.length > 0) invalidate(this);
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    if (this.#impacts.length === 0) return false;
    if (now_ms - this.#compared_ms < PACE_MS) return true;
    this.#compared_ms = now_ms;
    this.#lay();
    this.#compare();
    return false;
  }

  /** The measured points over the plots, where they can be computed. */
  #lay() {
    const scene = this.#run.scene ?? this.#page.drawn();
    const { contact_distance: l, radius_of_gyration, gravity } = derivedOf(scene);
    const rho = radius_of_gyration ?? 0;
    const key = JSON.stringify([l, rho, gravity]);
    if (key === this.#laid) return;
    this.#laid = key;
    /** @param {Measured} one */
    const energy = (one) =>
      (one.x_dot ** 2 + one.y_dot ** 2 + (rho && rho ** 2 * one.theta_dot ** 2)) / 2 +
      (l && gravity * l * Math.cos(one.theta));
    for (const plot of this.#page.plots) {
      const values = (/** @type {string} */ column) =>
        this.#impacts.map((one) => (column === 'energy' ? energy(one) : one[/** @type {'t'} */ (column)]));
      const up = values(plot.meaning.y.column);
      plot.lay(
        values(plot.meaning.x.column)
          .map((across, index) => /** @type {[number, number]} */ ([across, up[index]]))
          .filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y)),
      );
    }
  }

  #compare() {
    const all = residuals(this.#impacts, this.#run.impacts).map(asShown);
    const found = sums(all);
    const [measured, both] = [this.#impacts.length, all.length];
    this.#tell(
      both === 0
        ? this.#run.phase === 'idle'
          ? 'Nothing is simulated yet: run the scene to compare.'
          : 'None of them is simulated yet.'
        : both < measured
          ? `${number(both, 7)} of ${number(measured, 7)} measured impacts are simulated so far.`
          : `All ${number(measured, 7)} measured impacts are simulated.`,
    );
    this.#sheet.hidden = found.length === 0;
    if (found.length === 0) return;
    drawResiduals(
      this.#box,
      all,
      found.map(({ quantity }) => [quantity, nameOf(quantity)]),
    );
    this.#box.setAttribute(
      'aria-label',
      `Residuals of ${both} impacts. ${found.map(({ quantity, rms }) => `${SYMBOLS[quantity][0]}: RMS ${number(rms)} ${shownUnit(SYMBOLS[quantity][1])}`).join('; ')}`,
    );
    this.#sums.replaceChildren(
      ...found.map(({ quantity, rms, largest, at }) =>
        row(nameOf(quantity), [number(rms), number(largest), number(at, 7)]),
      ),
    );
    if (this.#numbers.open)
      this.#rows.replaceChildren(
        ...all.slice(0, LISTED).map((one) =>
          row(
            number(one.n, 7),
            COMPARED.map((quantity) => number(one[quantity], 5)),
          ),
        ),
      );
  }

  /** @param {string} words */
  #tell(words) {
    if (this.#told.textContent !== words) this.#told.textContent = words;
  }
}
