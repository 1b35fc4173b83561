// The controls of a map, with their errors beside them.

import { MOST_IMPACTS } from '../../api/client.js';
import { wholeNumber } from '../../dom/number-input.js';
import { number, quantity, unitAfter } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { shownValue } from '../../dom/units.js';
import { sliderRange } from '../../form/sliders.js';
import { html } from '../../vendor/preact/preact.js';
import { CatchFields, others } from '../catch/settings.js';
import { ErrorLine, SharedField } from '../parts.js';
import { COLUMNS, QUANTITIES, isOfCatches, isWithin, rowsOf, sidesOf, withQuantity } from './settings.js';

/** @typedef {import('../../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').ProblemError} ProblemError */
/** @typedef {import('./settings.js').Name} Name */
/** @typedef {import('./settings.js').Settings} Settings */
/** @typedef {{fields: Field[], settings: Settings, errors: ProblemError[], changed: (settings: Settings) => void}} Props */

/** The errors about a part of the request, with their pointers within it. @param {ProblemError[]} errors @param {string} part */
const within = (errors, part) =>
  errors.flatMap((error) => {
    const [, place, ...rest] = error.pointer.split('/');
    return place === part ? [{ ...error, pointer: `/${rest.join('/')}` }] : [];
  });

/** The errors that are about none of the controls. @param {ProblemError[]} errors @param {Settings} settings */
export const elsewhere = (errors, settings) => [
  ...errors.filter(({ pointer }) => !/^\/(x|y|bounces|catch)(\/|$)/.test(pointer)),
  ...others(within(errors, 'catch'), settings.catch),
];

/** The chosen option of a list. @param {(value: string) => void} take */
const chosen = (take) => (/** @type {{currentTarget: HTMLSelectElement}} */ event) => take(event.currentTarget.value);

/** The reason to refuse an end of a side: the limits of its field, the other end. @param {import('./settings.js').Side} side @param {'from' | 'to'} end @param {Field | undefined} field */
const faultOf = (side, end, field) => (/** @type {number} */ value) => {
  const unit = field?.unit ?? null;
  if (!isWithin(value, field))
    return `${quantity(value, unit)} is outside its limits, ${number(shownValue(field?.minimum ?? -Infinity, unit))} to ${quantity(field?.maximum ?? Infinity, unit)}.`;
  if (end === 'from') return value < side.to ? null : `It must be below ${quantity(side.to, unit, 8)}.`;
  return value > side.from ? null : `It must be above ${quantity(side.from, unit, 8)}.`;
};

/** A field with its ends. @param {Props & {name: Name, title: string}} props */
function Side({ name, title, fields, settings, errors, changed }) {
  const id = `map-${name}`;
  const side = settings[name];
  const field = fields.find((one) => one.field === side.parameter);
  const own = within(errors, name);
  const blamed = (/** @type {string} */ end) => own.some(({ pointer }) => pointer === `/${end}`);
  /** Takes a field with the range of its slider; swaps the sides if the other has it. */
  const turn = chosen((parameter) => {
    const other = settings[name === 'x' ? 'y' : 'x'];
    if (other.parameter === parameter) return changed({ ...settings, x: settings.y, y: settings.x });
    const [from, to] = sliderRange(/** @type {Field} */ (fields.find((one) => one.field === parameter)), null);
    changed({ ...settings, [name]: { parameter, from, to } });
  });
  const groups = [...new Set(fields.map(({ group }) => group))];
  return html`<fieldset>
    <legend>${title}</legend>
    <select
      id=${id}
      aria-label=${`Field ${title.toLowerCase()}`}
      aria-describedby=${`${id}-error`}
      aria-invalid=${own.length > 0 && !blamed('from') && !blamed('to') ? 'true' : null}
      value=${side.parameter}
      onChange=${turn}
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
    <p class="map-ends">
      ${
        /** @type {const} */ (['from', 'to']).map(
          (end) => html`<label for=${`${id}-${end}`}>${end}</label>
          <${SharedField}
            id=${`${id}-${end}`}
            error=${`${id}-error`}
            unit=${field?.unit ?? null}
            value=${side[end]}
            fault=${faultOf(side, end, field)}
            blamed=${blamed(end)}
            changed=${(/** @type {number} */ value) => changed({ ...settings, [name]: { ...side, [end]: value } })}
          />`,
        )
      }
      <span class="unit">${unitAfter(field?.unit ?? null).trim()}</span>
    </p>
    <${ErrorLine} id=${`${id}-error`} errors=${own} />
  </fieldset>`;
}

/** The rows that have arrived. @param {{progress: import('./refinement.js').Progress | null, busy: boolean}} props */
export const Progress = ({ progress, busy }) => html`<p class="map-progress">
  <progress
    id="map-progress"
    aria-label="Rows of the map"
    max=${progress?.rows ?? 1}
    value=${progress?.arrived ?? 0}
    hidden=${!busy}
  />
  <span class="muted">
    ${progress && `${progress.arrived} / ${progress.rows} rows of ${progress.columns} × ${progress.rows}`}
  </span>
</p>`;

/** @param {Props} props */
export function MapControls(props) {
  const { settings, errors, changed } = props;
  const fields = sidesOf(props.fields);
  const catches = isOfCatches(settings.quantity);
  const bounces = within(errors, 'bounces');
  return html`<${Side} ...${props} fields=${fields} name="x" title="Across" />
    <${Side} ...${props} fields=${fields} name="y" title="Upwards" />
    <fieldset>
      <legend>Shown</legend>
      <p class="map-row">
        <label for="map-quantity">Colour</label>
        <select
          id="map-quantity"
          value=${settings.quantity}
          onChange=${chosen((one) => changed(withQuantity(settings, one)))}
        >
          ${Object.entries(QUANTITIES).map(([value, { title }]) => html`<option value=${value}>${title}</option>`)}
        </select>
      </p>
      <p class="map-row" hidden=${catches}>
        <label for="map-impacts">Bounces</label>
        <${SharedField}
          id="map-impacts"
          error="map-impacts-error"
          unit=${null}
          value=${settings.impacts}
          fault=${wholeNumber(1, MOST_IMPACTS, 'It')}
          blamed=${bounces.length > 0}
          disabled=${!QUANTITIES[settings.quantity].runs}
          changed=${(/** @type {number} */ impacts) => changed({ ...settings, impacts })}
        />
      </p>
      <${ErrorLine} id="map-impacts-error" errors=${bounces} />
      <p class="map-row">
        <label for="map-columns">Finest</label>
        <select
          id="map-columns"
          value=${settings.columns}
          onChange=${chosen((one) => changed({ ...settings, columns: Number(one) }))}
        >
          ${COLUMNS.map((value) => html`<option value=${value}>${value} × ${rowsOf(value)}</option>`)}
        </select>
      </p>
    </fieldset>
    ${catches && html`<${CatchFields} id="map-catch" settings=${settings.catch} errors=${within(errors, 'catch')} changed=${(/** @type {Settings['catch']} */ one) => changed({ ...settings, catch: one })} />`}`;
}
