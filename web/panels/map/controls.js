// The controls of a map, with their errors beside them.

import { limitsOf } from '../../api/settings.js';
import { quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { sliderRange } from '../../form/sliders.js';
import { html } from '../../vendor/preact/preact.js';
import { CatchFields } from '../catch/settings.js';
import { NumberField } from '../parts.js';
import { faultOf, fieldsOf, otherFaults, within } from '../settings.js';
import { isOfCatches, kept, sidesOf } from './settings.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('./settings.js').Side} Side */
/** @typedef {import('./settings.js').Sides} Sides */
/** @typedef {{page: import('../settings.js').Page, map: ReturnType<typeof import('./settings.js').readMap>, errors: import('contract').ProblemError[], turn: (sides: Sides) => void}} Props */

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
    <select
      id=${id}
      aria-label=${`Field ${title.toLowerCase()}`}
      aria-describedby=${`${id}-error`}
      aria-invalid=${fault ? 'true' : null}
      value=${side.field.field}
      onChange=${choose}
    >
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
    <p class="map-ends">
      ${
        /** @type {const} */ (['from', 'to']).map(
          (end) => html`<label for=${`${id}-${end}`}>${end}</label>
          <${NumberField}
            id=${`${id}-${end}`}
            unit=${side.field.unit ?? ''}
            value=${side[end]}
            digits=${8}
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
  const field = fieldsOf(page, 'map', table, settings, errors);
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
