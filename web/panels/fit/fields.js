// The settings of a fit: the fields that may be unknown, the values at which each chosen one begins, and the deviations of the data.

import { playedAt } from '../../api/scene-fields.js';
import { number, quantity } from '../../dom/numbers.js';
import { html, useState } from '../../vendor/preact/preact.js';
import { COLUMNS, QUANTITIES } from '../measured/read.js';
import { sign } from '../parts.js';
import { controlsOf, readSettings } from '../settings.js';

/** @import { Column } from '../measured/read.js' */
/** A field with the value at which the search begins. @typedef {{field: Field, value: number | null}} Unknown */
/** Words on what is wrong, by the place at which they stand. @typedef {Record<string, string>} Faults */

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
  const ranked = [...PROPOSED].reverse();
  const rank = (/** @type {Field} */ { field }) => -ranked.indexOf(field);
  return fields
    .filter(({ kind, group }) => kind === 'number' && group !== 'noise')
    .sort((one, other) => rank(one) - rank(other));
}

/** Lengths that a body of another kind has, which therefore are none of it. @param {Scene} scene @param {Field} field */
const isOfAnotherBody = ({ body }, { field: path }) =>
  /^body\.(contact_distance|radius_of_gyration)$/.test(path) && Boolean(body?.vertices || body?.point);

/** The value of a field in the scene, else a guess; undefined where there is none. @param {Scene} scene @param {Field} field */
function presentValue(scene, field) {
  const value = playedAt(scene, field);
  if (typeof value === 'number') return value;
  if (field.field === 'table.assumed_restitution') return scene.contact?.restitution ?? 1;
  return ERRORS.test(field.field) ? 0 : undefined;
}

/** The field that is unknown unless somebody says otherwise. @param {Field[]} fields eligible ones @param {Scene} scene */
const proposal = (fields, scene) =>
  fields
    .filter((field) => typeof playedAt(scene, field) === 'number')
    .slice(0, 1)
    .map(({ field }) => field);

/** The numbers among the settings: first values of fields, and deviations of columns. @param {Field[]} items @param {Scene} scene @returns {Record<string, Setting>} */
const settingsOf = (items, scene) =>
  Object.fromEntries([
    ...items.map((field) => [
      `first.${field.field}`,
      { label: `${field.title}: first value`, usual: presentValue(scene, field), unit: field.unit, open: true },
    ]),
    ...COLUMNS.map((column) => [
      `sd.${column}`,
      {
        label: html`of ${sign(QUANTITIES[column].symbol)}`,
        unit: QUANTITIES[column].unit,
        right: (/** @type {number} */ value) => value >= LEAST && value <= GREATEST,
        must: 'a number above 0, or empty to estimate it',
      },
    ]),
  ]);

/** The settings of a fit with their controls, and the broken parts of the address. @param {PanelPage} page */
export function readFit(page) {
  const { link, fields, scene } = page;
  const items = eligible(fields);
  const settings = settingsOf(items, scene);
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
    .map((field) => ({ field, value: values[`first.${field.field}`] ?? null }));
  const deviations = COLUMNS.map((column) => [column, values[`sd.${column}`]]);
  /** @type {Partial<Record<Column, number>>} */
  const given = Object.fromEntries(deviations.filter(([, value]) => value !== undefined));
  const { control } = controlsOf(page, 'fit', settings, values);
  return { items, unknown, given, broken, settings, control };
}

/** @typedef {{page: PanelPage, settings: ReturnType<typeof readFit>, faults: Faults}} Props */

/** The list of fields to choose from, with a search: each with its box, and with its first value where it is chosen. @param {Props} props */
export function UnknownFields({ page: { scene, part }, settings: { items, unknown, control }, faults }) {
  const [searched, search] = useState('');
  const words = searched.toLowerCase().split(/\s+/).filter(Boolean);
  const found = items.filter((field) => {
    const { field: path, title, symbol, about } = field;
    if (isOfAnotherBody(scene, field)) return false;
    if (words.length > 0)
      return words.every((word) => `${path} ${title} ${symbol} ${about}`.toLowerCase().includes(word));
    return PROPOSED.includes(path) || (path.startsWith('table.feedback.') && playedAt(scene, field) !== undefined);
  });
  const isChosen = (/** @type {Field} */ field) => unknown.some((one) => one.field === field);
  const full = unknown.length >= MOST;
  const choose = (/** @type {Field} */ field, /** @type {boolean} */ on) => {
    const paths = items.filter((one) => (one === field ? on : isChosen(one))).map(({ field: path }) => path);
    const usual = String(paths) === String(proposal(items, scene));
    part({ 'fit.unknown': usual ? null : String(paths), ...(!on && { [`fit.first.${field.field}`]: null }) });
  };
  const item = (/** @type {Field} */ field) => {
    const { field: path, title, about, symbol, unit } = field;
    const id = `fit-unknown-${path.replaceAll('.', '-')}`;
    const name = `first.${path}`;
    const value = playedAt(scene, field);
    const chosen = isChosen(field);
    return html`<li class="fit-field row" key=${path}>
      <label class="check" for=${id} title=${about}>
        <input type="checkbox" id=${id} checked=${chosen} disabled=${full && !chosen}
          onChange=${(/** @type {Event} */ { currentTarget }) => choose(field, /** @type {HTMLInputElement} */ (currentTarget).checked)} />
        <span>${symbol && sign(symbol)} ${title}</span>
      </label>
      <span class="fit-value">
        ${
          chosen
            ? control(name, { id: `${id}-first`, label: `${title}: first value`, blame: faults[path] })
            : html`<span class="muted">${typeof value === 'number' ? quantity(value, unit, 5) : 'not set'}</span>`
        }
      </span>
    </li>`;
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
    <ul class="fit-fields">${items.filter((field) => isChosen(field) || found.includes(field)).map(item)}</ul>
    <div class="fit-search row">
      <input type="search" id="fit-search" placeholder="Find another field" aria-label="Find another field" autocomplete="off" spellcheck="false"
        value=${searched} onKeyDown=${key} onInput=${(/** @type {Event} */ { currentTarget }) => search(/** @type {HTMLInputElement} */ (currentTarget).value)} />
      <p class="muted small found" role="status">${words.length === 0 ? `${number(items.length, 4)} fields can be unknown.` : found.length === 0 ? 'No field has these words.' : count}</p>
    </div>
    ${unknown.some(({ field }) => field.field.startsWith('release.')) && html`<p class="muted small">With a field of the release unknown, the first bounce of the data is the first after the release, unless the file has a column n.</p>`}
    <p class="error" id="fit-unknown-error" role="status">${faults.unknown ?? (full ? `A fit takes at most ${MOST} unknown fields.` : '')}</p>
  </fieldset>`;
}

/** The measured columns with their standard deviations: typed where they are known, else estimated by the fit. @param {Omit<Props, 'page'> & {counts: Map<Column, number>}} props */
export const Deviations = ({ counts, settings: { given, settings, control }, faults }) =>
  html`<fieldset class="fit-deviations">
    <legend>Standard deviations of the data</legend>
    <ul class="fit-fields">
      ${COLUMNS.filter((column) => counts.has(column) || column in given).map(
        (column) => html`<li class="fit-field row" key=${column}>
          <label for=${`fit-sd-${column}`}>${settings[`sd.${column}`].label}</label>
          <span class="fit-value">${control(`sd.${column}`, { hint: 'estimated', blame: faults[column] })}</span>
          <span class="muted">${number(counts.get(column) ?? 0, 7)} values</span>
        </li>`,
      )}
    </ul>
    <p class="muted small">${counts.size > 0 ? 'Give those that you know. Only if all are given can χ² say that the model is wrong.' : 'The columns of the data appear here.'}</p>
  </fieldset>`;
