// The settings of a stability map: two fields with their ends, quantity, bounces, resolution; from the address, as a request, and their controls.

import { MOST_IMPACTS } from '../../api/client.js';
import { limitsOf } from '../../api/settings.js';
import { number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { sliderRange } from '../../form/sliders.js';
import { html } from '../../vendor/preact/preact.js';
import { CATCHES, CatchFields, inUse } from '../catch/settings.js';
import { NumberField } from '../parts.js';
import { controlsOf, faultOf, numberOf, otherFaults, readSettings, whole, within } from '../settings.js';

const NAMES = /** @type {const} */ (['x', 'y']);

/** The usual sides of a map, and those of a scene whose usual fields mean nothing: feedback has no tilt gain, a point no angle. */
const GAIN = { path: 'table.tilt_gain', from: 1, to: 1.6 };
const ANGLE = { path: 'release.theta', from: 0, to: 0.5 };
const SPIN = { path: 'release.theta_dot', from: -2, to: 2 };
const DRIFT = { path: 'release.x_dot', from: 0, to: 0.5 };

/** Those with `runs` run each cell by the law of its scene; those with `catches` catch its body. @type {Record<string, {title: string, unit?: string, runs?: boolean, catches?: boolean}>} */
export const QUANTITIES = {
  survival: { title: 'Bounces survived', runs: true },
  max_theta: { title: 'Largest |θ|', unit: 'rad', runs: true },
  residue: { title: 'Residue R' },
  spectral_radius: { title: 'Spectral radius' },
  caught: { title: 'Caught', catches: true },
  rest_time: { title: 'Time to rest', unit: 's', catches: true },
};
const USUAL = 'survival';

const COLUMNS = [48, 72, 96, 192, 384];
/** Finest columns of a map unless somebody asks for others. A catch takes about a millisecond, and a server computes some 4000 for a request. */
const USUAL_COLUMNS = { runs: 384, catches: 72 };
/** A catch in bounces of a run, by their time. */
const CATCH_BOUNCES = 1e5;

/** True for a map with a catch in every cell. @param {string} quantity */
export const isOfCatches = (quantity) => QUANTITIES[quantity].catches === true;

/** @param {number} columns */
export const rowsOf = (columns) => (columns * 2) / 3;

/** The settings of a map of a quantity, but for its sides. @param {string} quantity @returns {Record<string, Setting>} */
const tableOf = (quantity) => ({
  quantity: {
    label: 'Colour',
    usual: USUAL,
    choices: Object.fromEntries(Object.entries(QUANTITIES).map(([name, { title }]) => [name, title])),
  },
  bounces: {
    ...whole('Bounces', 1000, MOST_IMPACTS, 'impacts'),
    disabled: !QUANTITIES[quantity].runs,
    must: `a whole number of bounces from 1 to ${number(MOST_IMPACTS, 7)}`,
  },
  columns: {
    label: 'Finest',
    usual: isOfCatches(quantity) ? USUAL_COLUMNS.catches : USUAL_COLUMNS.runs,
    choices: Object.fromEntries(COLUMNS.map((columns) => [columns, `${columns} × ${rowsOf(columns)}`])),
    must: `one of the resolutions ${COLUMNS.join(', ')}`,
  },
  ...CATCHES,
});

/** Columns that a map goes through until it is as fine as wanted. */
const PASSES = [24, 96, 384];

/** The columns of its passes, from coarse to fine. @param {number} finest */
export const passesOf = (finest) => [...PASSES.filter((columns) => columns < finest), finest];

/** Bounces of its runs, or as many as take the time of its catches. @param {MapSettings} settings */
export function bouncesOf({ columns, bounces, quantity }) {
  const { runs, catches } = QUANTITIES[quantity];
  return columns * rowsOf(columns) * (runs ? bounces : catches ? CATCH_BOUNCES : 0);
}

/** Half of the width of a cell. @param {Side} side @param {number} count of cells */
export const halfCell = ({ from, to }, count) => (to - from) / (count - 1) / 2;

/** The values along both axes. Half of a finest cell lies beyond the ends, so that they are the same for all passes. @param {MapSettings} settings */
export function rangesOf({ x, y, columns }) {
  const around = (/** @type {Side} */ side, /** @type {number} */ count) => {
    const half = halfCell(side, count);
    return { low: side.from - half, high: side.to + half };
  };
  return { x: around(x, columns), y: around(y, rowsOf(columns)) };
}

/** Fields whose values are numbers, which a map can vary. @param {Field[]} fields */
const sidesOf = (fields) => fields.filter(({ kind }) => kind === 'number');

/** The value of a field next to this one. @param {number} value @param {Field} field */
export const kept = (value, { minimum, maximum }) =>
  Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, value));

/** The usual sides of a map around a scene: in steps of a fifth they reach as far as it. @param {Pick<PanelPage, 'fields' | 'scene'>} page @returns {Sides} */
function usualSides({ fields, scene: { table, body, release } }) {
  const side = (/** @type {typeof GAIN} */ { path, from, to }, value = from) => {
    const step = (to - from) / 5;
    const beyond = (/** @type {number} */ end) => Number((step * end).toPrecision(6));
    return {
      field: /** @type {Field} */ (fields.find(({ field }) => field === path)),
      from: value < from ? beyond(Math.floor(value / step)) : from,
      to: value > to ? beyond(Math.ceil(value / step)) : to,
    };
  };
  return {
    x: table?.feedback ? side(SPIN) : side(GAIN, table?.tilt_gain),
    y: body?.point ? side(DRIFT) : side(ANGLE, release?.theta),
  };
}

/** A side of an address. @param {'x' | 'y'} name @param {PanelPage} page @param {Side} usual @param {Broken} broken @returns {Side} */
function readSide(name, { fields, link }, usual, broken) {
  const parts = partsOf(name).filter((part) => link.has(part));
  if (parts.length === 0) return usual;
  const [path, from, to] = partsOf(name).map((part) => link.get(part));
  const field = sidesOf(fields).find((one) => one.field === path);
  const side = field && { field, from: numberOf(from), to: numberOf(to) };
  if (side && side.from < side.to && kept(side.from, field) === side.from && kept(side.to, field) === side.to)
    return side;
  const words = field
    ? `the ends of ${field.title.toLowerCase()}`
    : `the field “${(path ?? '').slice(0, 40)}”, which a map cannot vary`;
  for (const [index, part] of parts.entries()) broken.push([part, index === 0 ? words : '']);
  return usual;
}

/** The parts of the address that are about a side. @param {'x' | 'y'} name */
const partsOf = (name) => ['parameter', 'from', 'to'].map((key) => `map.${name}.${key}`);

/** The settings of a map from the address, with what it usually shows of this scene. @param {PanelPage} page */
export function readMap(page) {
  const asked = page.link.get('map.quantity') ?? '';
  const table = tableOf(Object.hasOwn(QUANTITIES, asked) ? asked : USUAL);
  const { values, broken } = readSettings('map', table, page.link);
  const usual = usualSides(page);
  let { x, y } = { x: readSide('x', page, usual.x, broken), y: readSide('y', page, usual.y, broken) };
  if (x.field === y.field) {
    broken.push(['map.y.parameter', 'the second of two equal fields']);
    for (const part of NAMES.flatMap(partsOf)) broken.push([part, '']);
    ({ x, y } = usual);
  }
  const settings = /** @type {MapSettings} */ ({ ...values, x, y });
  return { settings, table, usual, broken };
}

/** The parts of the address that make a map have these sides. @param {Sides} sides @param {Sides} usual */
export const sideParts = (sides, usual) =>
  Object.fromEntries(
    NAMES.flatMap((name) => {
      const { field, from, to } = sides[name];
      const own = field !== usual[name].field || from !== usual[name].from || to !== usual[name].to;
      const values = [field.field, from, to];
      return partsOf(name).map((part, index) => [part, own ? String(values[index]) : null]);
    }),
  );

/**
 * A request for `/v1/regions`. The scene's own values of the two fields do not matter and are left out.
 * @param {MapSettings} settings
 * @param {URLSearchParams} scene
 */
export function requestQuery(settings, scene) {
  const { quantity, bounces, columns } = settings;
  const query = new URLSearchParams(scene);
  for (const [name, count] of /** @type {const} */ ([
    ['x', columns],
    ['y', rowsOf(columns)],
  ])) {
    const { field, from, to } = settings[name];
    query.delete(`scene.${field.field}`);
    for (const [key, value] of Object.entries({ field: field.field, from, to, count }))
      query.set(`${name}.${key}`, String(value));
  }
  query.set('quantity', quantity);
  if (!isOfCatches(quantity)) query.set('bounces', String(bounces));
  else for (const [key, value] of Object.entries(inUse(settings, 'catch.'))) query.set(`catch.${key}`, String(value));
  return query;
}

/** Nodes along a side, as many as the server looks at for the linear boundary. */
const NODES = 49;

/**
 * The cheapest request that has the linear boundary of the same map, and the names of outcomes: NDJSON has neither. A map of catches
 * has no boundary.
 * @param {URLSearchParams} request
 */
export function outlineQuery(request) {
  const query = new URLSearchParams(request);
  const cheapest = isOfCatches(request.get('quantity') ?? '')
    ? { 'x.count': 1, 'y.count': 1 }
    : { 'x.count': NODES, 'y.count': NODES, quantity: 'residue', bounces: 1, 'tile.index': 0, 'tile.of': NODES };
  for (const [key, value] of Object.entries(cheapest)) query.set(key, String(value));
  return query;
}

/** @typedef {{page: PanelPage, map: ReturnType<typeof readMap>, errors: ProblemError[], turn: (sides: Sides) => void}} Props */

// The controls, with their errors beside them.

/** The reason to refuse an end of a side: the limits of its field, the other end. @param {Side} side @param {'from' | 'to'} end */
const refusal =
  ({ field, from, to }, end) =>
  (/** @type {number} */ value) => {
    const { unit } = field;
    if (kept(value, field) !== value) return `${quantity(value, unit)} is outside its limits, ${limitsOf(field)}.`;
    if (end === 'from') return value < to ? null : `It must be below ${quantity(to, unit, 8)}.`;
    return value > from ? null : `It must be above ${quantity(from, unit, 8)}.`;
  };

/** A field with its ends. @param {Props & {name: 'x' | 'y', title: string}} props */
function EndsOf({ name, title, page, map: { settings }, errors, turn }) {
  const id = `map-${name}`;
  const { x, y, [name]: side } = settings;
  const fields = sidesOf(page.fields);
  const ends = [`${name}.from`, `${name}.to`];
  const fault = otherFaults(within(errors, name), ends);
  const change = (/** @type {Partial<Side>} */ changes) => turn({ x, y, [name]: { ...side, ...changes } });
  /** Takes a field with the range of its slider; swaps the sides if the other has it. */
  const choose = (/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget: { value } }) => {
    const field = /** @type {Field} */ (fields.find((one) => one.field === value));
    if ([x, y].some((one) => one !== side && one.field === field)) return turn({ x: y, y: x });
    const [from, to] = sliderRange(field, null);
    change({ field, from, to });
  };
  const groups = [...new Set(fields.map(({ group }) => group))];
  return html`<fieldset>
    <legend>${title}</legend>
    <select id=${id} aria-label=${`Field ${title.toLowerCase()}`} aria-describedby=${`${id}-error`}
      aria-invalid=${fault ? 'true' : null} value=${side.field.field} onChange=${choose}>
      ${groups.map(
        (group) => html`<optgroup label=${capitalized(group)}>
          ${fields
            .filter((one) => one.group === group)
            .map(
              ({ field: path, title: words, symbol }) =>
                html`<option value=${path}>${words}${symbol && !symbol.includes('_') ? ` ${symbol}` : ''}</option>`,
            )}
        </optgroup>`,
      )}
    </select>
    <p class="error" id=${`${id}-error`} role="status">${fault}</p>
    <p class="map-ends row">
      ${
        /** @type {const} */ (['from', 'to']).map(
          (end) => html`<label for=${`${id}-${end}`}>${end}</label>
          <${NumberField} id=${`${id}-${end}`} unit=${side.field.unit ?? ''} value=${side[end]} digits=${8}
            fault=${refusal(side, end)}
            blame=${faultOf(errors, `${name}.${end}`)}
            changed=${(/** @type {number} */ value) => change({ [end]: value })}
          />`,
        )
      }
    </p>
  </fieldset>`;
}

/** @param {Props} props */
export function MapControls(props) {
  const { page, map, errors } = props;
  const { settings, table } = map;
  const { field } = controlsOf(page, 'map', table, settings, errors);
  const catches = isOfCatches(settings.quantity);
  return html`<${EndsOf} ...${props} name="x" title="Across" />
    <${EndsOf} ...${props} name="y" title="Upwards" />
    <fieldset class="map-shown">
      <legend>Shown</legend>
      ${field('quantity')}
      ${!catches && field('bounces')} ${field('columns')}
    </fieldset>
    ${catches && html`<${CatchFields} values=${settings} field=${field} at="catch." />`}`;
}
