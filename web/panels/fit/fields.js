// The fields of a scene that may be unknown: a list to choose from, with a search, and the value at which each chosen one begins.

import { pathOf, playedAt } from '../../api/scene-fields.js';
import { h } from '../../dom/elements.js';
import { numberInput } from '../../dom/number-input.js';
import { number, quantity } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { shownUnit, shownValue } from '../../dom/units.js';
import { symbol } from '../../dom/typeset.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('../../api/scene-fields.js').Scene} Scene */

/** Most unknown fields of a fit. */
const MOST = 8;
/** Rank of the fields that are not proposed. */
const MANY = 1000;

/** Fields that labs do not know well, best first. */
const PROPOSED = [
  'table.tilt_gain',
  'body.radius_of_gyration',
  'body.contact_distance',
  'contact.restitution',
  'table.assumed_restitution',
  'contact.friction',
  'table.errors.angle_bias',
  'gravity',
];
/** Errors of a rig, which are 0 in a scene without them. */
const ERRORS = /^table\.errors\.|^body\.offset$/;

/** Lengths that a body of another kind has, which therefore are none of it. @param {Scene} scene @param {Field} field */
const isOfAnotherBody = ({ body }, { field: path }) =>
  /^body\.(contact_distance|radius_of_gyration)$/.test(path) && Boolean(body?.vertices || body?.point);

/**
 * The first value of a field: that of the scene, else a guess; null where there is none.
 * @param {Scene} scene
 * @param {Field} field
 * @returns {number | null}
 */
function firstValue(scene, field) {
  const value = playedAt(scene, field);
  if (typeof value === 'number') return value;
  if (field.field === 'table.assumed_restitution') return scene.contact?.restitution ?? 1;
  return ERRORS.test(field.field) ? 0 : null;
}

/** A value as text in an input. @param {number} value in SI units @param {string} unit */
export const inputText = (value, unit) => String(Number(shownValue(value, unit).toPrecision(6)));

/** A field in the list. */
class Item {
  field;
  element;
  box;
  /** The value at which a fit begins. */
  first;
  /** The first value as typed, in SI units; undefined for that of the scene. @type {number | undefined} */
  typed;
  /** The same without typing. @type {number | null} */
  #present = null;
  #value = h('span', { class: 'fit-value' });
  #error;

  /** @param {Field} field @param {() => void} changed */
  constructor(field, changed) {
    this.field = field;
    const { field: path, title, about, symbol: sign, unit } = field;
    const id = `fit-unknown-${path.replaceAll('.', '-')}`;
    this.#error = h('p', { class: 'error', id: `${id}-error` });
    this.box = h('input', { type: 'checkbox', id, 'aria-describedby': `${id}-error`, change: changed });
    this.first = numberInput(
      {
        id: `${id}-first`,
        'aria-label': `${title}: first value`,
        change: () => {
          this.typed = parse(this.first.value, unit) ?? undefined;
          changed();
        },
      },
      this.#error,
      { unit, open: true },
    );
    this.element = h(
      'li',
      { class: 'fit-field' },
      h('label', { class: 'check', for: id, title: about }, this.box, h('span', {}, sign && symbol(sign), ` ${title}`)),
      this.#value,
      this.#error,
    );
  }

  get chosen() {
    return this.box.checked;
  }

  /** The first value; null where there is none. */
  get value() {
    return this.typed ?? this.#present;
  }

  /** True if the first value differs from that of the scene. */
  get differs() {
    return this.value !== null && this.value !== this.#present;
  }

  /** @param {Scene} scene @param {boolean} [anew] in another unit too */
  show(scene, anew = false) {
    const { unit } = this.field;
    this.#present = firstValue(scene, this.field);
    const { value } = this;
    if (this.typed === undefined || (anew && value !== null))
      this.first.value = value === null ? '' : inputText(value, unit);
    const isSet = typeof playedAt(scene, this.field) === 'number';
    this.#value.replaceChildren(
      ...(this.chosen
        ? [this.first, h('span', { class: 'unit' }, unit === '1' ? '' : shownUnit(unit))]
        : [h('span', { class: 'muted' }, isSet ? quantity(this.#present, unit, 5) : 'not set')]),
    );
  }

  /** @param {string} words */
  blame(words) {
    this.#error.textContent = words;
    for (const input of [this.box, this.first]) input.setAttribute('aria-invalid', String(words !== ''));
  }
}

export class UnknownFields {
  /** @type {Item[]} */
  #items;
  #scene;
  #list = h('ul', { class: 'fit-fields' });
  #found = h('p', { class: 'muted small found', role: 'status' });
  #search = h('input', {
    type: 'search',
    id: 'fit-search',
    placeholder: 'Find another field',
    'aria-label': 'Find another field',
    autocomplete: 'off',
    spellcheck: 'false',
    input: () => this.#filter(),
  });
  #error = h('p', { class: 'error', id: 'fit-unknown-error' });
  #released = h(
    'p',
    { class: 'muted small', hidden: true },
    'With a field of the release unknown, the first bounce of the data is the first after the release, unless the file has a column n.',
  );
  element;

  /**
   * @param {Field[]} fields
   * @param {() => Scene} scene
   * @param {() => void} changed
   */
  constructor(fields, scene, changed) {
    this.#scene = scene;
    const eligible = fields.filter(({ kind, group }) => kind === 'number' && group !== 'noise');
    this.#items = eligible.map(
      (field) =>
        new Item(field, () => {
          this.show();
          changed();
        }),
    );
    const rank = (/** @type {Item} */ { field: { field: path } }) =>
      PROPOSED.includes(path) ? PROPOSED.indexOf(path) : MANY;
    this.#items.sort((one, other) => rank(one) - rank(other));
    this.#search.addEventListener('keydown', (event) => {
      // Enter would ask for a fit.
      if (event.key === 'Enter') event.preventDefault();
      if (event.key !== 'Escape' || this.#search.value === '') return;
      event.preventDefault();
      this.#search.value = '';
      this.#filter();
    });
    this.element = h(
      'fieldset',
      { class: 'fit-unknown' },
      h('legend', {}, 'Unknown fields, with the values at which the search begins'),
      this.#list,
      h('div', { class: 'fit-search' }, this.#search, this.#found),
      this.#released,
      this.#error,
    );
    this.#choose(this.#proposal());
    this.show();
  }

  /** The field that is unknown unless somebody says otherwise. */
  #proposal() {
    const scene = this.#scene();
    const [first] = this.#items.filter(({ field }) => typeof playedAt(scene, field) === 'number');
    return first ? [first.field.field] : [];
  }

  /** @param {string[]} paths @returns {string[]} those that there are not */
  #choose(paths) {
    for (const item of this.#items) item.box.checked = paths.includes(item.field.field);
    return paths.filter((path) => !this.#items.some(({ field }) => field.field === path));
  }

  get chosen() {
    return this.#items.filter(({ chosen }) => chosen);
  }

  /** Shows the present values. @param {boolean} [anew] in another unit too */
  show(anew = false) {
    const scene = this.#scene();
    const full = this.chosen.length >= MOST;
    for (const item of this.#items) {
      item.show(scene, anew);
      item.box.disabled = full && !item.chosen;
    }
    this.#released.hidden = !this.chosen.some(({ field }) => field.field.startsWith('release.'));
    this.#error.textContent = full ? `A fit takes at most ${MOST} unknown fields.` : '';
    this.#filter();
  }

  /** Lists the fields with all words of the search, else those that are proposed, and always the chosen ones. */
  #filter() {
    const scene = this.#scene();
    const words = this.#search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.#items.filter(({ field }) => {
      if (isOfAnotherBody(scene, field)) return false;
      if (words.length === 0)
        return (
          PROPOSED.includes(field.field) ||
          (field.field.startsWith('table.feedback.') && playedAt(scene, field) !== undefined)
        );
      const text = `${field.field} ${field.title} ${field.symbol} ${field.about}`.toLowerCase();
      return words.every((word) => text.includes(word));
    });
    const listed = this.#items.filter((item) => item.chosen || found.includes(item));
    const elements = listed.map(({ element }) => element);
    // A list that stays keeps the focus in it.
    if (
      elements.length !== this.#list.children.length ||
      elements.some((one, place) => one !== this.#list.children[place])
    )
      this.#list.replaceChildren(...elements);
    this.#found.textContent =
      words.length === 0
        ? `${number(this.#items.length, 4)} fields can be unknown.`
        : found.length === 0
          ? 'No field has these words.'
          : `${found.length} ${found.length === 1 ? 'field' : 'fields'}`;
  }

  /** The chosen paths and the scene with their first values; null where something is wrong, which is marked. */
  read() {
    this.clear();
    /** @type {Item | null} */
    let wrong = null;
    for (const item of this.chosen) {
      if (item.value !== null) continue;
      item.blame('It has no value in the scene: give a first guess.');
      wrong ??= item;
    }
    if (this.chosen.length === 0) this.#error.textContent = 'Choose at least one field.';
    if (wrong) wrong.first.focus();
    else if (this.chosen.length === 0) this.#items.find(({ element }) => element.isConnected)?.box.focus();
    else return this.chosen.map(({ field, value }) => ({ path: field.field, value: Number(value) }));
    return null;
  }

  clear() {
    for (const item of this.#items) item.blame('');
    this.#error.textContent = '';
  }

  /** Marks the fields that the server blames. @param {import('contract').ProblemError[]} errors @returns {import('contract').ProblemError[]} the others */
  blame(errors) {
    const { chosen } = this;
    return errors.filter(({ pointer, detail }) => {
      const [, index] = /^\/unknown\/(\d+)/.exec(pointer) ?? [];
      const item = index ? chosen[Number(index)] : chosen.find(({ field }) => field.field === pathOf(pointer));
      item?.blame(detail);
      if (!item && pointer === '/unknown') this.#error.textContent = detail;
      return !item && pointer !== '/unknown';
    });
  }

  /** The part of the address. */
  query() {
    const query = new URLSearchParams();
    const chosen = this.chosen.map(({ field }) => field.field);
    if (String(chosen) !== String(this.#proposal())) query.set('fit.unknown', String(chosen));
    for (const { field, differs, value } of this.chosen)
      if (differs) query.set(`fit.first.${field.field}`, String(value));
    return query;
  }

  /** @param {URLSearchParams} link @returns {string[]} what was dropped of it */
  restore(link) {
    const asked = link.get('fit.unknown');
    const paths = asked === null ? this.#proposal() : asked.split(',').filter(Boolean);
    const unknown = this.#choose(paths.slice(0, MOST));
    const dropped = unknown.map((path) => `the unknown field “${path.slice(0, 40)}”, which is none that can be fitted`);
    for (const item of this.#items) {
      const text = link.get(`fit.first.${item.field.field}`);
      const value = text === null || text.trim() === '' ? NaN : Number(text);
      item.typed = Number.isFinite(value) ? value : undefined;
      if (text !== null && item.typed === undefined)
        dropped.push(`the first value “${text.slice(0, 40)}”, which is not a number`);
    }
    this.show(true);
    return dropped;
  }
}
