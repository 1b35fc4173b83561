// The settings of a fit: the fields that may be unknown, the values at which each chosen one begins, and the deviations of the data.

import { playedAt } from '../../api/scene-fields.js';
import { number, quantity } from '../../dom/numbers.js';
import { html, useState } from '../../vendor/preact/preact.js';
import { COLUMNS, QUANTITIES } from '../measured/quantities.js';
import { NumberField, sign } from '../parts.js';
import { readSettings } from '../settings.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../measured/quantities.js').Column} Column */
/** @typedef {import('../settings.js').Page} Page */
/** A field with the value at which the search begins. @typedef {{field: Field, value: number | null}} Unknown */
/** Words on what is wrong, by the place at which they stand. @typedef {Record<string, string>} Faults */
/** Changes parts of the address. @typedef {(changes: Record<string, string | null>) => void} Change */

/** Most unknown fields of a fit. */
const MOST = 8;
/** The server's limits of a deviation, in the unit of the column. */
const [LEAST, GREATEST] = [1e-9, 1e3];

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

/** The numbers of a scene that may be unknown, the proposed ones first. @param {Field[]} fields */
function eligible(fields) {
  const rank = (/** @type {Field} */ { field }) =>
    PROPOSED.includes(field) ? PROPOSED.indexOf(field) : PROPOSED.length;
  return fields
    .filter(({ kind, group }) => kind === 'number' && group !== 'noise')
    .sort((one, other) => rank(one) - rank(other));
}

/** Lengths that a body of another kind has, which therefore are none of it. @param {Scene} scene @param {Field} field */
const isOfAnotherBody = ({ body }, { field: path }) =>
  /^body\.(contact_distance|radius_of_gyration)$/.test(path) && Boolean(body?.vertices || body?.point);

/** The value of a field in the scene, else a guess; null where there is none. @param {Scene} scene @param {Field} field */
function presentValue(scene, field) {
  const value = playedAt(scene, field);
  if (typeof value === 'number') return value;
  if (field.field === 'table.assumed_restitution') return scene.contact?.restitution ?? 1;
  return ERRORS.test(field.field) ? 0 : null;
}

/** The field that is unknown unless somebody says otherwise. @param {Field[]} fields eligible ones @param {Scene} scene */
const proposal = (fields, scene) =>
  fields
    .filter((field) => typeof playedAt(scene, field) === 'number')
    .slice(0, 1)
    .map(({ field }) => field);

/** @param {number} value in the unit of its column */
const isDeviation = (value) => value >= LEAST && value <= GREATEST;

/** The settings of a fit that are numbers: deviations of columns and first values of fields, undefined where none is given. @param {Field[]} items @returns {Record<string, import('../settings.js').Setting>} */
const settingsOf = (items) =>
  Object.fromEntries([
    ...COLUMNS.map((column) => [`sd.${column}`, { label: '', right: isDeviation, must: 'a number above 0' }]),
    ...items.map(({ field }) => [`first.${field}`, { label: '' }]),
  ]);

/**
 * The settings of a fit, and the broken parts of the address.
 * @param {Page} page
 */
export function readFit({ link, fields, scene }) {
  const items = eligible(fields);
  const settings = settingsOf(items);
  const { values, broken } = readSettings('fit', settings, link);
  for (const [part] of link)
    if (part.startsWith('fit.') && part !== 'fit.unknown' && !(part.slice(4) in settings))
      broken.push([part, `“${part.slice(0, 40)}”, which has no meaning here`]);
  const isKnown = (/** @type {string} */ path) => items.some(({ field }) => field === path);
  const asked = link.get('fit.unknown')?.split(',').filter(Boolean);
  const paths = asked?.filter(isKnown).slice(0, MOST) ?? proposal(items, scene);
  for (const path of asked ?? [])
    if (!isKnown(path)) {
      const words = `the unknown field “${path.slice(0, 40)}”, which is none that can be fitted`;
      broken.push(['fit.unknown', words, String(paths)]);
    }
  /** @type {Unknown[]} */
  const unknown = items
    .filter(({ field }) => paths.includes(field))
    .map((field) => ({ field, value: values[`first.${field.field}`] ?? presentValue(scene, field) }));
  const deviations = COLUMNS.map((column) => [column, values[`sd.${column}`]]);
  /** @type {Partial<Record<Column, number>>} */
  const given = Object.fromEntries(deviations.filter(([, value]) => value !== undefined));
  return { unknown, given, broken };
}

/**
 * A field in the list: its box, and its first value where it is chosen.
 * @param {{scene: Scene, field: Field, chosen: Unknown | undefined, full: boolean, fault: string | undefined, choose: (on: boolean) => void, change: Change}} props
 */
function Item({ scene, field, chosen, full, fault, choose, change }) {
  const { field: path, title, about, symbol, unit } = field;
  const id = `fit-unknown-${path.replaceAll('.', '-')}`;
  const present = presentValue(scene, field);
  const isSet = typeof playedAt(scene, field) === 'number';
  const begin = (/** @type {number | undefined} */ value) =>
    change({ [`fit.first.${path}`]: value === undefined || value === present ? null : String(value) });
  return html`<li class="fit-field">
    <label class="check" for=${id} title=${about}>
      <input type="checkbox" id=${id} checked=${Boolean(chosen)} disabled=${full && !chosen}
        onChange=${(/** @type {Event} */ { currentTarget }) => choose(/** @type {HTMLInputElement} */ (currentTarget).checked)} />
      <span>${symbol && sign(symbol)} ${title}</span>
    </label>
    <span class="fit-value">
      ${
        chosen
          ? html`<${NumberField} id=${`${id}-first`} label=${`${title}: first value`} unit=${unit} value=${chosen.value ?? undefined} open blame=${fault} changed=${begin} />`
          : html`<span class="muted">${isSet ? quantity(present, unit, 5) : 'not set'}</span>`
      }
    </span>
  </li>`;
}

/**
 * The list of fields to choose from, with a search.
 * @param {{page: Page, unknown: Unknown[], faults: Faults, change: Change}} props
 */
export function UnknownFields({ page: { fields, scene }, unknown, faults, change }) {
  const [searched, search] = useState('');
  const items = eligible(fields);
  const words = searched.toLowerCase().split(/\s+/).filter(Boolean);
  const isFound = (/** @type {Field} */ field) => {
    const { field: path, title, symbol, about } = field;
    if (isOfAnotherBody(scene, field)) return false;
    if (words.length > 0)
      return words.every((word) => `${path} ${title} ${symbol} ${about}`.toLowerCase().includes(word));
    return PROPOSED.includes(path) || (path.startsWith('table.feedback.') && playedAt(scene, field) !== undefined);
  };
  const found = items.filter(isFound);
  const chosen = (/** @type {Field} */ field) => unknown.find((one) => one.field === field);
  const full = unknown.length >= MOST;
  const choose = (/** @type {Field} */ field, /** @type {boolean} */ on) => {
    const paths = items.filter((one) => (one === field ? on : chosen(one))).map(({ field: path }) => path);
    const usual = String(paths) === String(proposal(items, scene));
    change({ 'fit.unknown': usual ? null : String(paths), ...(!on && { [`fit.first.${field.field}`]: null }) });
  };
  const key = (/** @type {KeyboardEvent} */ event) => {
    // Enter would ask for a fit.
    if (event.key === 'Enter') event.preventDefault();
    if (event.key !== 'Escape' || searched === '') return;
    event.preventDefault();
    search('');
  };
  const count = `${found.length} ${found.length === 1 ? 'field' : 'fields'}`;
  return html`<fieldset class="fit-unknown">
    <legend>Unknown fields, with the values at which the search begins</legend>
    <ul class="fit-fields">
      ${items.filter((field) => chosen(field) || found.includes(field)).map((field) => html`<${Item} key=${field.field} scene=${scene} field=${field} chosen=${chosen(field)} full=${full} fault=${faults[field.field]} choose=${(/** @type {boolean} */ on) => choose(field, on)} change=${change} />`)}
    </ul>
    <div class="fit-search">
      <input type="search" id="fit-search" placeholder="Find another field" aria-label="Find another field" autocomplete="off" spellcheck="false"
        value=${searched} onKeyDown=${key} onInput=${(/** @type {Event} */ { currentTarget }) => search(/** @type {HTMLInputElement} */ (currentTarget).value)} />
      <p class="muted small found" role="status">${words.length === 0 ? `${number(items.length, 4)} fields can be unknown.` : found.length === 0 ? 'No field has these words.' : count}</p>
    </div>
    ${unknown.some(({ field }) => field.field.startsWith('release.')) && html`<p class="muted small">With a field of the release unknown, the first bounce of the data is the first after the release, unless the file has a column n.</p>`}
    <p class="error" id="fit-unknown-error" role="status">${faults.unknown ?? (full ? `A fit takes at most ${MOST} unknown fields.` : '')}</p>
  </fieldset>`;
}

/**
 * The measured columns with their standard deviations: typed where they are known, else estimated by the fit.
 * @param {{counts: Map<Column, number>, given: Partial<Record<Column, number>>, faults: Faults, change: Change}} props
 */
export const Deviations = ({ counts, given, faults, change }) => {
  const field = (/** @type {Column} */ column) => {
    const [letter, unit] = QUANTITIES[column];
    const id = `fit-sd-${column}`;
    return html`<li class="fit-field" key=${column}>
      <label for=${id}>of ${sign(letter)}</label>
      <span class="fit-value"><${NumberField} id=${id} unit=${unit} value=${given[column]} placeholder="estimated" open blame=${faults[column]}
        fault=${(/** @type {number} */ value) => (isDeviation(value) ? null : 'It must be a number above 0, or empty to estimate it.')}
        changed=${(/** @type {number | undefined} */ value) => change({ [`fit.sd.${column}`]: value === undefined ? null : String(value) })} /></span>
      <span class="muted">${number(counts.get(column) ?? 0, 7)} values</span>
    </li>`;
  };
  return html`<fieldset class="fit-deviations">
    <legend>Standard deviations of the data</legend>
    <ul class="fit-fields">${COLUMNS.filter((column) => counts.has(column) || column in given).map(field)}</ul>
    <p class="muted small">${counts.size > 0 ? 'Give those that you know. Only if all are given can χ² say that the model is wrong.' : 'The columns of the data appear here.'}</p>
  </fieldset>`;
};
