// A lab's own impacts over the simulated ones, and how far the two are apart. What is loaded stays in this page.

import { row, table } from '../../dom/tables.js';
import { ColumnPicker } from './columns.js';
import { COMPARED, SYMBOLS, numbersOf, residuals, simulatedOf, sums } from './compare.js';
import { measured } from './file.js';
import { derivedOf } from '../../physics/body.js';
import { drawResiduals } from './residual-chart.js';
import { h } from '../../dom/elements.js';
import { invalidate } from '../../charts/surface.js';
import { matchByNumber, matchByTime } from './match.js';
import { numberInput } from '../../dom/number-input.js';
import { fixed, number } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
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
/** Numbers and lines that are named one by one; more are counted. */
const NAMED = 8;
/** Growth of the run after which the offset of the clocks is looked for again. */
const GROWTH = 1.25;

/** A count with its noun. @param {number} count @param {string} noun */
const counted = (count, noun) => `${number(count, 7)} ${noun}${count === 1 ? '' : 's'}`;

/** The first of them. @param {number[]} all */
const listed = (all) =>
  all
    .slice(0, NAMED)
    .map((one) => number(one, 7))
    .join(', ') + (all.length > NAMED ? ' …' : '');

/** The offset of two clocks: in ms, unless one of them counts from long ago. @param {number} offset s */
const clocks = (offset) =>
  Math.abs(offset) < 100 ? `${fixed(Math.abs(offset) * 1e3, 1)}\u202fms` : `${fixed(Math.abs(offset), 3)}\u202fs`;

export class MeasuredPanel {
  #page;
  #run;
  /** The impacts as in the file. @type {Measured[]} */
  #read = [];
  /** With their numbers in the run. @type {Measured[]} */
  #impacts = [];
  /** Lines of the file, one for each impact. @type {number[]} */
  #lines = [];
  /** Number of the first impact as typed; null if it is found. @type {number | null} */
  #typedFirst = null;
  /** Offset of the clocks as found with so many simulated impacts, of which the first came at this time. @type {{start: {offset: number, alike: boolean}, count: number, began: number} | null} */
  #found = null;
  /** The constants that the points over the plots were computed with. */
  #laid = '';
  #compared_ms = -Infinity;
  #chip = h('span', { class: 'chip measured-chip', id: 'measured-chip', hidden: true });
  #name = h('h3', { id: 'measured-title' }, 'Measured impacts');
  #told = h('p', { id: 'measured-told', role: 'status' });
  #matched = h('p', { id: 'measured-matched' });
  #columns = new ColumnPicker('measured', (picks) => measured.pick(picks));
  #remarks = h('ul', { class: 'measured-remarks', id: 'measured-remarks' });
  #error = h('p', { class: 'error', id: 'measured-first-error' });
  #first = numberInput(
    {
      inputmode: 'numeric',
      id: 'measured-first',
      'aria-describedby': 'measured-first-hint measured-first-error',
      change: () => this.#number(),
    },
    this.#error,
    {
      unit: null,
      open: () => this.#byTime,
      fault: (value) => (Number.isInteger(value) && value >= 1 ? null : 'It must be a whole number from 1.'),
    },
  );
  #by = h(
    'select',
    { id: 'measured-by', change: () => this.#renumber() },
    h('option', { value: 'time' }, 'by time'),
    h('option', { value: 'number' }, 'by number'),
  );
  #hint = h('span', { class: 'muted small', id: 'measured-first-hint' }, 'Clear it to have it found.');
  #offset = h(
    'p',
    { class: 'measured-offset' },
    h('label', { for: 'measured-by' }, 'Match'),
    this.#by,
    h('label', { for: 'measured-first' }, 'The first measured impact is n ='),
    this.#first,
    this.#hint,
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
        'Measured less simulated at the same impact; the offset of the two clocks is taken off t. The file stays in this browser, unless you press Fit in the tab Fit, which finds missed and doubled impacts by itself.',
      ),
      this.#told,
      this.#matched,
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
    this.#lines = reading.lines;
    const timed = reading.impacts.some(({ t }) => !Number.isNaN(t));
    this.#by.disabled = !timed;
    this.#by.value = timed ? 'time' : 'number';
    this.#chip.replaceChildren(
      svg(
        'svg',
        { viewBox: '0 0 12 12', width: 12, height: 12, 'aria-hidden': 'true' },
        svg('path', { d: 'M6 1L11 6L6 11L1 6Z' }),
      ),
      ` measured (${number(reading.impacts.length, 7)})`,
    );
    this.#chip.hidden = this.#offset.hidden = false;
    this.#renumber();
    if (fresh) this.#panel.scrollIntoView({ block: 'nearest' });
  }

  #clear() {
    this.#name.textContent = 'Measured impacts';
    this.#read = this.#impacts = [];
    this.#laid = this.#matched.textContent = '';
    for (const plot of this.#page.plots) plot.lay([]);
    this.#chip.hidden = this.#offset.hidden = this.#sheet.hidden = true;
  }

  get #byTime() {
    return this.#by.value === 'time';
  }

  /** Takes the numbers of the file, or those found by time. */
  #renumber() {
    this.#first.value = String(this.#read[0].n);
    this.#hint.hidden = !this.#byTime;
    this.#begin(null);
  }

  /** Takes the typed number of the first measured impact. */
  #number() {
    const first = parse(this.#first.value, null);
    this.#begin(first);
  }

  /** Compares anew. @param {number | null} first number of the first impact */
  #begin(first) {
    this.#error.textContent = '';
    this.#typedFirst = first;
    this.#found = null;
    this.#impacts = this.#read.map((one) => ({ ...one, n: one.n - this.#read[0].n + (first ?? this.#read[0].n) }));
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
    this.#compare();
    this.#lay();
    return false;
  }

  /** The measured points over the plots, where they can be computed. */
  #lay() {
    const scene = this.#run.scene ?? this.#page.drawn();
    const { contact_distance: l, radius_of_gyration, gravity_in_plane: gravity } = derivedOf(scene);
    const rho = radius_of_gyration ?? 0;
    const key = JSON.stringify([
      l,
      rho,
      gravity,
      this.#impacts[0].n,
      this.#impacts.at(-1)?.n,
      this.#matched.textContent,
    ]);
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

  /** Pairs the measured impacts with those simulated by now. @param {import('./match.js').Simulated} simulated */
  #match(simulated) {
    const first = this.#typedFirst;
    if (!this.#byTime) return matchByNumber(this.#read, simulated, first ?? this.#read[0].n);
    const count = simulated.t.length;
    const old = this.#found;
    const known = old && old.began === simulated.t[0] && count >= old.count && count < GROWTH * old.count;
    const match = matchByTime(this.#read, simulated, first, known ? old.start : null);
    if (!known) this.#found = { start: match.start, count, began: simulated.t[0] };
    return match;
  }

  #compare() {
    if (this.#read.length === 0) return;
    const simulated = this.#run.impacts.end > 0 ? simulatedOf(this.#run.impacts) : null;
    const match = simulated && this.#match(simulated);
    const numbers = numbersOf(this.#read, simulated, match, this.#typedFirst ?? this.#read[0].n);
    this.#impacts = this.#read.map((one, row) => ({ ...one, n: numbers[row] }));
    const all = simulated && match ? residuals(this.#read, simulated, match).map(asShown) : [];
    const found = sums(all);
    this.#say(match, all.length);
    this.#sayMatched(simulated, match);
    const shown = this.#typedFirst === null && all.length > 0 && document.activeElement !== this.#first;
    if (shown) this.#first.value = String(numbers[match?.extra.includes(0) ? (match.pairs[0]?.[0] ?? 0) : 0]);
    this.#sheet.hidden = found.length === 0;
    if (found.length === 0) return;
    drawResiduals(
      this.#box,
      all,
      found.map(({ quantity }) => [quantity, nameOf(quantity)]),
      undefined,
      {
        missed: match?.missed.map((place) => simulated?.n[place] ?? NaN) ?? [],
        extra: match?.extra.map((row) => numbers[row]) ?? [],
      },
    );
    this.#box.setAttribute(
      'aria-label',
      `Residuals of ${all.length} impacts. ${found.map(({ quantity, rms }) => `${SYMBOLS[quantity][0]}: RMS ${number(rms)} ${shownUnit(SYMBOLS[quantity][1])}`).join('; ')}`,
    );
    this.#sums.replaceChildren(
      ...found.map(({ quantity, rms, largest, at }) =>
        row(nameOf(quantity), [number(rms), number(largest), number(at, 7)]),
      ),
    );
    if (this.#numbers.open) this.#list(simulated, match, all, numbers);
  }

  /**
   * The impacts one by one, in the order of their numbers.
   * @param {import('./match.js').Simulated | null} simulated
   * @param {import('./match.js').Match | null} match
   * @param {Residual[]} all
   * @param {number[]} numbers of the measured impacts
   */
  #list(simulated, match, all, numbers) {
    /** @param {string} name @param {string} words */
    const alone = (name, words) =>
      h(
        'tr',
        {},
        h('th', { scope: 'row' }, name),
        h('td', { class: 'measured-alone', colspan: COMPARED.length }, words),
      );
    const rows = [
      ...all.map((one) => {
        const cells = COMPARED.map((quantity) => number(one[quantity], 5));
        return { n: one.n, element: () => row(number(one.n, 7), cells) };
      }),
      ...(match?.missed ?? []).map((place) => {
        const n = simulated?.n[place] ?? NaN;
        return { n, element: () => alone(number(n, 7), 'missed: simulated, not measured') };
      }),
      ...(match?.extra ?? []).map((index) => ({
        n: numbers[index],
        element: () => alone(`line ${number(this.#lines[index], 7)}`, 'extra: measured, not simulated'),
      })),
    ].sort((a, b) => a.n - b.n);
    this.#rows.replaceChildren(...rows.slice(0, LISTED).map(({ element }) => element()));
  }

  /** Says how many of the measured impacts are compared. @param {import('./match.js').Match | null} match @param {number} both */
  #say(match, both) {
    const timed = this.#byTime ? this.#read.filter(({ t }) => !Number.isNaN(t)).length : this.#read.length;
    const measured = number(timed, 7);
    const without =
      timed < this.#read.length ? ` ${counted(this.#read.length - timed, 'row')} without t left out.` : '';
    const compared = `${number(both, 7)} of ${measured} measured impacts are simulated`;
    this.#tell(
      (both === 0
        ? this.#run.phase === 'idle'
          ? 'Nothing is simulated yet: run the scene to compare.'
          : 'None of them is simulated yet.'
        : match && match.later.length > 0
          ? `${compared} so far.`
          : match && match.extra.length > 0
            ? `${compared} ones.`
            : `All ${measured} measured impacts are simulated.`) + without,
    );
  }

  /** Says how they are paired. @param {import('./match.js').Simulated | null} simulated @param {import('./match.js').Match | null} match */
  #sayMatched(simulated, match) {
    if (!simulated || !match || match.pairs.length === 0) {
      this.#matched.textContent = '';
      return;
    }
    const { pairs, missed, extra, offset, alike, later } = match;
    const clock = Number.isNaN(offset)
      ? ''
      : `: the measured clock is ${clocks(offset)} ${offset < 0 ? 'behind' : 'ahead of'} the simulated one`;
    const unpaired = [
      missed.length > 0 &&
        `${counted(missed.length, 'impact')} missed (n = ${listed(missed.map((place) => simulated.n[place]))})`,
      extra.length > 0 &&
        `${counted(extra.length, 'row')} extra (line ${listed(extra.map((row) => this.#lines[row]))})`,
    ].filter(Boolean);
    this.#matched.textContent = [
      `Matched by ${this.#byTime ? 'time' : 'number'}${clock}.`,
      `${unpaired.join(', ') || 'None missed, none extra'}.`,
      missed.length + extra.length > pairs.length &&
        'More impacts are without a pair than with one: the run is of another scene or release. Match by number to compare them all the same.',
      alike && later.length === 0 && 'Other offsets fit about as well, so the numbers of the impacts decide.',
    ]
      .filter(Boolean)
      .join(' ');
  }

  /** @param {string} words */
  #tell(words) {
    if (this.#told.textContent !== words) this.#told.textContent = words;
  }
}
