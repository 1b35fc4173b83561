// The controls of a map with their errors beside them, and the progress of its answer.

import { COLUMNS, QUANTITIES, isOfCatches, rowsOf, sidesOf, usualColumns } from './settings.js';
import { MOST_IMPACTS } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { numberInput, wholeNumber } from '../../dom/number-input.js';
import { number, quantity, unitAfter } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { styles } from '../../dom/styles.js';
import { inWords } from '../../dom/typeset.js';
import { UNITS, shownValue } from '../../dom/units.js';
import { sliderRange } from '../../form/slider-range.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {'x' | 'y'} Name */

/**
 * @typedef {object} ControlActions
 * @property {(settings: Settings) => void} changed
 * @property {() => void} compute
 * @property {() => void} cancel
 * @property {() => void} back
 */

/** @param {number} count */
const times = (count) => `${count} × ${rowsOf(count)}`;

/** The fault of an end of a side beyond the limits of its field. @param {number} value @param {Field | undefined} field */
const endFault = (value, field) =>
  field && (value < (field.minimum ?? -Infinity) || value > (field.maximum ?? Infinity))
    ? `${quantity(value, field.unit)} is outside its limits, ${number(shownValue(field.minimum ?? -Infinity, field.unit))} to ${quantity(field.maximum ?? Infinity, field.unit)}.`
    : null;

export class MapControls {
  element;
  #actions;
  #fields;
  /** @type {Settings} */
  #settings;
  #sides;
  #quantity;
  #impacts;
  #impactsError = h('p', { class: 'error', id: 'map-impacts-error' });
  #columns;
  #bounces;
  #catch = h('div', { hidden: true });
  /** The settings of a catch, there with the first map of catches. @type {import('../catch/settings.js').CatchSettings | null} */
  #catching = null;
  #compute = h('button', { type: 'button', id: 'map-compute', click: () => this.#actions.compute() }, 'Compute');
  #cancel = h(
    'button',
    { type: 'button', id: 'map-cancel', disabled: true, click: () => this.#actions.cancel() },
    'Cancel',
  );
  #back = h('button', { type: 'button', id: 'map-back', disabled: true, click: () => this.#actions.back() }, 'Back');
  #progress = h('progress', { id: 'map-progress', 'aria-label': 'Rows of the map', max: 1, value: 0 });
  #count = h('span', { class: 'muted' });
  #told = h('p', { class: 'map-told', id: 'map-told', role: 'status' });

  /**
   * @param {Field[]} fields
   * @param {Settings} settings
   * @param {ControlActions} actions
   */
  constructor(fields, settings, actions) {
    this.#actions = actions;
    this.#fields = sidesOf(fields);
    this.#settings = settings;
    this.#sides = { x: this.#side('x', 'Across'), y: this.#side('y', 'Upwards') };
    this.#quantity = h(
      'select',
      { id: 'map-quantity', change: () => this.#read() },
      ...Object.entries(QUANTITIES).map(([value, { title }]) => h('option', { value }, title)),
    );
    this.#impacts = numberInput(
      { id: 'map-impacts', inputmode: 'numeric', change: () => this.#read() },
      this.#impactsError,
      { unit: null, fault: wholeNumber(1, MOST_IMPACTS, 'It') },
    );
    this.#columns = h(
      'select',
      { id: 'map-columns', change: () => this.#read() },
      ...COLUMNS.map((value) => h('option', { value }, times(value))),
    );
    this.#bounces = h('p', { class: 'map-row' }, h('label', { for: 'map-impacts' }, 'Bounces'), this.#impacts);
    this.element = h(
      'form',
      {
        class: 'map-controls',
        novalidate: true,
        submit: (event) => {
          event.preventDefault();
          this.#actions.compute();
        },
      },
      this.#sides.x.element,
      this.#sides.y.element,
      h(
        'fieldset',
        {},
        h('legend', {}, 'Shown'),
        h('p', { class: 'map-row' }, h('label', { for: 'map-quantity' }, 'Colour'), this.#quantity),
        this.#bounces,
        this.#impactsError,
        h('p', { class: 'map-row' }, h('label', { for: 'map-columns' }, 'Finest'), this.#columns),
      ),
      this.#catch,
      h(
        'div',
        { class: 'map-go' },
        h('p', { class: 'buttons' }, this.#compute, this.#cancel, this.#back),
        h('p', { class: 'map-progress' }, this.#progress, this.#count),
        this.#told,
      ),
    );
    this.show(settings);
    document.addEventListener(UNITS, () => this.show(this.#settings));
  }

  /** @param {Name} name @param {string} title */
  #side(name, title) {
    const id = `map-${name}`;
    const error = h('p', { class: 'error', id: `${id}-error` });
    const groups = [...new Set(this.#fields.map(({ group }) => group))];
    const field = h(
      'select',
      {
        id,
        'aria-label': `Field ${title.toLowerCase()}`,
        'aria-describedby': error.id,
        change: () => this.#turn(name),
      },
      ...groups.map((group) =>
        h(
          'optgroup',
          { label: group[0].toUpperCase() + group.slice(1) },
          ...this.#fields
            .filter((one) => one.group === group)
            .map((one) =>
              h(
                'option',
                { value: one.field },
                `${one.title}${one.symbol && !one.symbol.includes('_') ? ` ${one.symbol}` : ''}`,
              ),
            ),
        ),
      ),
    );
    const own = () => this.#fields.find((one) => one.field === field.value);
    /** @param {'from' | 'to'} end */
    const ending = (end) =>
      numberInput({ id: `${id}-${end}`, change: () => this.#read() }, error, {
        unit: () => own()?.unit ?? null,
        fault: (value) => endFault(value, own()) ?? this.#orderFault(name, end, value),
      });
    const [from, to, unit] = [ending('from'), ending('to'), h('span', { class: 'unit' })];
    const element = h(
      'fieldset',
      {},
      h('legend', {}, title),
      field,
      h(
        'p',
        { class: 'map-ends' },
        h('label', { for: from.id }, 'from'),
        from,
        h('label', { for: to.id }, 'to'),
        to,
        unit,
      ),
      error,
    );
    return { element, field, from, to, unit, error };
  }

  /** Takes the selected field with the range of its slider. Swaps the sides if the other has it. @param {Name} name */
  #turn(name) {
    const other = name === 'x' ? 'y' : 'x';
    const settings = structuredClone(this.#settings);
    const parameter = this.#sides[name].field.value;
    const field = this.#fields.find((one) => one.field === parameter);
    if (!field) return;
    if (settings[other].parameter === parameter) [settings.x, settings.y] = [settings.y, settings.x];
    else {
      const [from, to] = sliderRange(field, null);
      settings[name] = { parameter, from, to };
    }
    this.show(settings);
    this.#actions.changed(settings);
  }

  /** @param {HTMLInputElement} input @param {number} value @param {string} unit */
  #put(input, value, unit) {
    input.value = String(Number(shownValue(value, unit).toPrecision(8)));
    // Keeps the exact value of the rounded text until it is edited.
    input.dataset.text = input.value;
    input.dataset.value = String(value);
  }

  /** @param {Settings} settings */
  show(settings) {
    this.#settings = settings;
    for (const name of /** @type {const} */ (['x', 'y'])) {
      const { field, from, to, unit } = this.#sides[name];
      field.value = settings[name].parameter;
      const si = this.#fields.find((one) => one.field === settings[name].parameter)?.unit ?? '';
      this.#put(from, settings[name].from, si);
      this.#put(to, settings[name].to, si);
      unit.textContent = unitAfter(si).trim();
    }
    this.#quantity.value = settings.quantity;
    this.#impacts.value = String(settings.impacts);
    this.#columns.value = String(settings.columns);
    this.#suit(settings);
    this.blame([]);
    void this.#showCatch();
  }

  /** Offers what the quantity needs. @param {Settings} settings */
  #suit({ quantity }) {
    this.#impacts.disabled = !QUANTITIES[quantity].runs;
    this.#bounces.hidden = isOfCatches(quantity);
    this.#catch.hidden = !isOfCatches(quantity);
  }

  /** Shows the settings of the catch, and loads what they need before. */
  async #showCatch() {
    if (this.#catch.hidden) return;
    if (!this.#catching) {
      try {
        const [{ CatchSettings }] = await Promise.all([import('../catch/settings.js'), styles('panels/study.css')]);
        this.#catching ??= new CatchSettings(() => this.#read(), {
          id: 'map-catch',
          key: 'map.catch.',
          automatic: false,
        });
      } catch {
        return this.say(['The settings of the catch did not load.'], 'wrong');
      }
      this.#catch.replaceChildren(this.#catching.element);
    }
    const { catch: chosen } = this.#settings;
    this.#catching.restore(
      new URLSearchParams(Object.entries(chosen).map(([name, value]) => [`map.catch.${name}`, value])),
    );
  }

  /** The fault of an end on the wrong side of the other. @param {Name} name @param {'from' | 'to'} end @param {number} value */
  #orderFault(name, end, value) {
    const { from, to } = this.#settings[name];
    const unit = this.#fields.find((one) => one.field === this.#settings[name].parameter)?.unit ?? null;
    if (end === 'from' ? value < to : value > from) return null;
    return end === 'from'
      ? `It must be below ${quantity(to, unit, 8)}.`
      : `It must be above ${quantity(from, unit, 8)}.`;
  }

  /** Reads the typed settings. */
  #read() {
    const settings = structuredClone(this.#settings);
    for (const name of /** @type {const} */ (['x', 'y'])) {
      const side = this.#sides[name];
      const unit = this.#fields.find((one) => one.field === side.field.value)?.unit ?? null;
      for (const end of /** @type {const} */ (['from', 'to'])) {
        const { value, dataset } = side[end];
        settings[name][end] =
          value === dataset.text ? Number(dataset.value) : (parse(value, unit) ?? settings[name][end]);
      }
    }
    settings.impacts = parse(this.#impacts.value, null) ?? settings.impacts;
    const before = settings.quantity;
    settings.quantity = this.#quantity.value;
    settings.columns = Number(this.#columns.value);
    if (isOfCatches(before) !== isOfCatches(settings.quantity) && settings.columns === usualColumns(before)) {
      settings.columns = usualColumns(settings.quantity);
      this.#columns.value = String(settings.columns);
    }
    this.#suit(settings);
    this.blame([]);
    const chosen = isOfCatches(settings.quantity) && this.#catching ? this.#catching.read() : settings.catch;
    settings.catch = Object.fromEntries(Object.entries(chosen).map(([name, value]) => [name, String(value)]));
    this.#settings = settings;
    if (isOfCatches(before) !== isOfCatches(settings.quantity)) void this.#showCatch();
    this.#actions.changed(settings);
  }

  /**
   * Shows errors beside their controls.
   * @param {import('contract').ProblemError[]} errors
   * @returns {string[]} errors of other controls
   */
  blame(errors) {
    for (const { from, to, field, error } of Object.values(this.#sides)) {
      for (const input of [from, to, field]) input.removeAttribute('aria-invalid');
      error.textContent = '';
    }
    this.#impacts.removeAttribute('aria-invalid');
    this.#impactsError.textContent = '';
    /** @type {string[]} */
    const elsewhere = [];
    const ofCatch = errors.filter(({ pointer }) => pointer.startsWith('/catch/'));
    if (this.#catching) {
      const inside = ofCatch.map(({ pointer, detail }) => ({ pointer: pointer.slice('/catch'.length), detail }));
      elsewhere.push(...this.#catching.blame(inside));
    }
    for (const error of errors) {
      if (ofCatch.includes(error) && this.#catching) continue;
      const { pointer } = error;
      const detail = inWords(error.detail);
      const [, place, end] = pointer.split('/');
      if (place === 'x' || place === 'y') {
        const side = this.#sides[place];
        (end === 'from' || end === 'to' ? side[end] : side.field).setAttribute('aria-invalid', 'true');
        side.error.textContent += `${side.error.textContent ? ' ' : ''}${detail}`;
      } else if (place === 'bounces') {
        this.#impacts.setAttribute('aria-invalid', 'true');
        this.#impactsError.textContent = detail;
      } else elsewhere.push(detail);
    }
    return elsewhere;
  }

  /** @param {{arrived: number, rows: number, columns: number} | null} progress null when no answer is awaited */
  busy(progress) {
    const ended = this.#cancel === document.activeElement && progress === null;
    this.#cancel.disabled = progress === null;
    // A disabled button loses the focus.
    if (ended) this.#compute.focus();
    this.#progress.hidden = progress === null;
    if (!progress) return;
    this.#progress.max = progress.rows;
    this.#progress.value = progress.arrived;
    this.count(progress);
  }

  /** @param {{arrived: number, rows: number, columns: number}} progress */
  count({ arrived, rows, columns }) {
    this.#progress.value = arrived;
    this.#count.textContent = `${arrived} / ${rows} rows of ${times(columns)}`;
  }

  /** @param {boolean} possible */
  canGoBack(possible) {
    if (!possible && this.#back === document.activeElement) this.#compute.focus();
    this.#back.disabled = !possible;
  }

  /** @param {(string | Node)[]} words @param {'said' | 'wrong' | 'stale'} manner */
  say(words, manner = 'said') {
    this.#told.classList.toggle('error', manner === 'wrong');
    this.#compute.classList.toggle('attention', manner !== 'said');
    this.#told.replaceChildren(...words);
  }
}
