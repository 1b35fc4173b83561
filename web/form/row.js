// A row of the settings: a field with its label, its control, its help, its error, and the way back to the case.

import { idOf, limitsOf, textOf, told, usual } from '../api/settings.js';
import { debounce } from '../dom/debounce.js';
import { commits } from '../dom/number-input.js';
import { number as shortNumber, quantity, unitAfter } from '../dom/numbers.js';
import { parse, unitsFor } from '../dom/typed-number.js';
import { inWords } from '../dom/typeset.js';
import { sign } from '../panels/parts.js';
import { angles, shownFactor, shownUnit, shownValue } from '../dom/units.js';
import { html, useLayoutEffect, useMemo, useRef, useState } from '../vendor/preact/preact.js';
import { firstValue, shownRange, sliderStep, steady } from './sliders.js';
import { Track } from './track.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {HTMLInputElement | HTMLTextAreaElement} Text */
/** Words beside a field: `wrong` for a fault, else a remark on an entry that was put back, with that entry where it can be edited. @typedef {{words: string, wrong: boolean, refused?: string}} Said */

/**
 * The form around a row.
 * @typedef {object} Host
 * @property {import('./typed-scene.js').TypedScene} typed
 * @property {(path: string, value: unknown, final: boolean, focus?: string) => void} set
 * @property {(path: string) => void} settle
 * @property {(field: Field, focus?: string) => void} reset
 * @property {(field: Field, text: string) => import('../api/settings.js').Reading} judge
 * @property {(field: Field, problem: string | null, refused: string) => void} refuse
 */

/**
 * @typedef {object} RowProps
 * @property {Host} form
 * @property {Field} field
 * @property {unknown} value undefined for a field that is not set
 * @property {unknown} base the value in the case, for a value that differs
 * @property {boolean} differs
 * @property {boolean} off
 * @property {boolean} hidden
 * @property {Said | undefined} said
 * @property {import('./track.js').Mark | null} [mark] on its track
 * @property {string | null} [scene] the query of the scene, for a track with a map
 */

/** Steps by keys have ended after so long without another, ms. */
const SETTLED_MS = 300;

/** True for a field with a slider; nobody finds a number among trillions with one. @param {Field} field */
const slides = ({ kind, maximum }) => kind === 'number' || (kind === 'integer' && (maximum ?? Infinity) <= 1e6);
/** True for a field that can be left open, and has no usual value then. @param {Field} field */
const isOptional = (field) => isNumber(field) && field.default == null && !field.required;
/** @param {Field} field */
const isNumber = ({ kind }) => kind === 'number' || kind === 'integer';

/** Sentences of the help. @param {Field} field @param {unknown} value */
function helpWords(field, value) {
  const { about, live, unit } = field;
  const [limits, standing] = [limitsOf(field), usual(field)];
  const words = about === '' ? [] : [inWords(about.endsWith('.') ? about : `${about}.`)];
  if (limits !== '') words.push(`Allowed: ${limits}.`);
  if (standing !== null) words.push(`Usually ${quantity(standing, unit)}.`);
  if (slides(field)) {
    const [from, to] = shownRange(field, typeof value === 'number' ? value : standing);
    words.push(`Slider: ${shortNumber(from)} to ${shortNumber(to)}${unitAfter(unit)}.`);
  }
  words.push(live ? 'Acts on a run from its next bounce.' : 'Acts when the run is restarted.');
  if (isNumber(field) && unit !== '1')
    words.push(`Type ${unitsFor(unit)}${unit === 'rad' ? ', as in “20°” and “pi/9”' : ''}.`);
  return words.join(' ');
}

/** A row, drawn anew only where it has changed. @param {RowProps} props */
export function Row(props) {
  const { value, base, differs, off, hidden, said, mark, scene } = props;
  const parts = [value, base, differs, off, hidden, said, mark, scene, angles()];
  return useMemo(() => html`<${Parts} ...${props} />`, parts);
}

/** @param {RowProps} props */
function Parts(props) {
  const { form, field, value, base, differs, off, hidden, said } = props;
  const { field: path, title, unit, kind } = field;
  const id = idOf(field);
  const [helps, help] = useState(false);
  const label = useRef(/** @type {HTMLElement | null} */ (null));
  useLayoutEffect(() => {
    if (label.current && isNumber(field)) dragLabel(label.current, form, field);
  }, []);
  const back = `Reset ${title} to ${told(field, base)}`;
  const unset = isOptional(field) && value !== undefined;
  const Control = CONTROLS[kind];
  const control = html`<${Control} ...${props} id=${id} />`;
  return html`<div class=${`field ${kind} ${differs ? 'differs' : ''} ${off ? 'off' : ''}`} hidden=${hidden}>
    <div class="field-head">
      ${kind === 'boolean' && control}
      <label for=${id} class=${isNumber(field) ? 'drags' : ''} ref=${label}
        onDblClick=${() => isNumber(field) && form.reset(field)}>${title}${field.symbol && [' ', sign(field.symbol)]}</label>
      <span class="unit">${unit === '1' || unit === null ? '' : shownUnit(unit)}</span><span class="gap" />
      <button type="button" class="reset icon" hidden=${!differs} aria-label=${back} title=${back}
        onClick=${() => form.reset(field, id)}>↺</button>
      ${
        isOptional(field) &&
        html`<button type="button" class="icon unset" aria-label=${`Unset ${title}`} hidden=${!unset}
          onClick=${() => form.set(path, undefined, true, `${id}-set`)}>×</button>`
      }
      <button type="button" class="icon help" aria-expanded=${String(helps)} aria-controls=${`${id}-help`}
        aria-label=${`About ${title}`} onClick=${() => help(!helps)}>?</button>
    </div>
    ${kind !== 'boolean' && control}
    <p class="field-help" id=${`${id}-help`} hidden=${!helps}>${helpWords(field, value)}</p>
    <p class=${`error ${said && !said.wrong ? 'remark' : ''}`} id=${`${id}-error`}>${said?.words}${
      said?.refused !== undefined &&
      html` <button type="button" onClick=${() => editAgain(id, said.refused ?? '')}>Edit it</button>`
    }</p>
  </div>`;
}

/** Half a polygon is no reason to type it all again. @param {string} id @param {string} refused */
function editAgain(id, refused) {
  const input = /** @type {HTMLTextAreaElement} */ (document.getElementById(id));
  input.focus();
  input.dispatchEvent(new InputEvent('beforeinput'));
  input.value = refused;
}

/** The attributes of every control. @param {RowProps & {id: string}} props */
const common = ({ id, off, said }) => ({
  id,
  disabled: off,
  'aria-describedby': `${id}-help ${id}-error`,
  'aria-invalid': said?.wrong ? 'true' : undefined,
});

/** @param {RowProps & {id: string}} props */
function Choice(props) {
  const { form, field, value } = props;
  const choose = (/** @type {Event} */ event) =>
    form.set(field.field, /** @type {HTMLSelectElement} */ (event.currentTarget).value || undefined, true);
  return html`<select ...${common(props)} value=${String(value ?? field.default ?? '')} onChange=${choose}>
    ${field.default == null && html`<option value="">not set</option>`}
    ${field.choices?.map((choice) => html`<option value=${choice}>${choice.replaceAll('_', ' ')}</option>`)}
  </select>`;
}

/** @param {RowProps & {id: string}} props */
function YesNo(props) {
  const { form, field, value } = props;
  const turn = (/** @type {Event} */ event) =>
    form.set(field.field, /** @type {HTMLInputElement} */ (event.currentTarget).checked || undefined, true);
  return html`<input type="checkbox" ...${common(props)} checked=${value === true} onChange=${turn} />`;
}

/** A text that is committed by Enter or by leaving it. @param {RowProps} props @returns {{current: Text | null}} */
function useText({ form, field, value }) {
  const text = useRef(/** @type {Text | null} */ (null));
  const show = () => {
    const input = /** @type {Text} */ (text.current);
    const [now, whole] = [form.typed.value(field), document.activeElement === input];
    input.value = textOf(field, now, whole);
    input.title = textOf(field, now, false) === textOf(field, now) ? '' : textOf(field, now);
  };
  useLayoutEffect(() => {
    const input = /** @type {Text} */ (text.current);
    const judge = (/** @type {string} */ typed) => form.judge(field, typed);
    const settle = debounce(SETTLED_MS, () => form.settle(field.field));
    const finish = commits(
      input,
      (typed) => ({ problem: judge(typed).problem }),
      (problem, refused) => {
        if (problem !== null) show();
        form.refuse(field, problem, refused);
      },
    );
    input.addEventListener('change', () => {
      form.set(field.field, judge(input.value).value, true);
      show();
    });
    input.addEventListener('focus', () => {
      show();
      if (isNumber(field)) input.select();
    });
    input.addEventListener('blur', show);
    input.addEventListener('keydown', (event) => {
      const { key, ctrlKey, metaKey, shiftKey } = /** @type {KeyboardEvent} */ (event);
      // A list has one line.
      if (key === 'Enter' && field.kind === 'numbers') {
        event.preventDefault();
        input.blur();
      }
      const way = { ArrowUp: 1, ArrowDown: -1 }[key];
      if (!isNumber(field) || !way || ctrlKey || metaKey) return;
      event.preventDefault();
      finish();
      const from = form.typed.value(field) ?? usual(field) ?? firstValue(field);
      form.set(field.field, moved(field, Number(from), way * (shiftKey ? 10 : 1)), false);
      settle();
    });
  }, []);
  useLayoutEffect(show, [value, angles()]);
  return text;
}

/** @param {RowProps & {id: string}} props */
function Lines(props) {
  const text = useText(props);
  return html`<textarea ...${common(props)} ref=${text} rows=${props.field.kind === 'numbers' ? 1 : 3}
    spellcheck="false" placeholder="not set" />`;
}

/** @param {RowProps & {id: string}} props */
function Numeric(props) {
  const { form, field, value, off, id, mark, scene } = props;
  const { field: path, title, unit } = field;
  const text = useText(props);
  const slider = useRef(/** @type {HTMLInputElement | null} */ (null));
  const standing = usual(field);
  const number = typeof value === 'number' ? value : null;
  const key = `${value} ${angles()}`;
  /** The key of the value that the slider itself has set: its ends and its step stay then. */
  const own = useRef('');
  const range = useRef({ ends: shownRange(field, number), step: sliderStep(field, number) });
  if (own.current !== key) {
    own.current = '';
    range.current = { ends: shownRange(field, number), step: sliderStep(field, number) };
  }
  const { ends, step } = range.current;
  const at = number ?? standing;
  const turn = (/** @type {Event} */ { type, currentTarget }) => {
    const set = parse(/** @type {HTMLInputElement} */ (currentTarget).value, unit);
    own.current = `${set} ${angles()}`;
    form.set(path, set, type === 'change');
  };
  useLayoutEffect(() => {
    if (!slider.current) return;
    steady(slider.current, () => {
      const before = form.typed.value(field);
      return () => form.set(path, before, false);
    });
  }, []);
  const open = isOptional(field) && value === undefined;
  return html`<div class="field-row">
    ${
      slides(field) &&
      html`<${Track} form=${form} field=${field} ends=${ends} mark=${mark} scene=${scene} hollow=${at === null}>
        <input type="range" id=${`${id}-slider`} ref=${slider} min=${ends[0]} max=${ends[1]} step=${step}
          value=${at === null ? (ends[0] + ends[1]) / 2 : shownValue(at, unit)} disabled=${at === null || off}
          aria-label=${`${title}, slider`} aria-valuetext=${told(field, value)} aria-describedby=${`${id}-slider-track`}
          onInput=${turn} onChange=${turn} />
      <//>`
    }
    <button type="button" class="set" id=${`${id}-set`} aria-label=${`Set ${title}`} hidden=${!open || off}
      onClick=${() => form.set(path, firstValue(field), true, id)}>Set</button>
    <input type="text" ...${common(props)} ref=${text} inputmode="decimal" autocomplete="off" spellcheck="false"
      placeholder=${standing === null ? 'not set' : shortNumber(shownValue(standing, unit))} />
  </div>`;
}

const CONTROLS = {
  choice: Choice,
  boolean: YesNo,
  vertices: Lines,
  numbers: Lines,
  number: Numeric,
  integer: Numeric,
};

/** A value some steps from another, in round numbers of the shown unit and within the limits. @param {Field} field @param {number} from @param {number} steps */
function moved(field, from, steps) {
  const { unit, minimum, maximum } = field;
  const to = Number((shownValue(from, unit) + steps * sliderStep(field, from)).toPrecision(12));
  return Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, to / shownFactor(unit)));
}

/** Movement before a press is a drag, and for a step, px. */
const LEAST_PX = 4;
const STEP_PX = 3;

/** Drags a label left and right to change its number. @param {HTMLElement} label @param {RowProps['form']} form @param {Field} field */
function dragLabel(label, form, field) {
  /** @type {{x: number, before: unknown, from: number, steps: number} | null} */
  let held = null;
  let dragged = false;
  const move = (/** @type {NonNullable<typeof held>} */ { before, from, steps }, /** @type {boolean} */ final) =>
    form.set(field.field, steps === 0 ? before : moved(field, from, steps), final);
  label.addEventListener('pointerdown', ({ button, clientX: x }) => {
    const before = form.typed.value(field);
    const from = before ?? usual(field);
    dragged = false;
    held = button === 0 && typeof from === 'number' && !form.typed.isOff(field) ? { x, before, from, steps: 0 } : null;
  });
  label.addEventListener('pointermove', ({ clientX, pointerId, shiftKey }) => {
    if (!held) return;
    const way = clientX - held.x;
    if (!dragged && Math.abs(way) < LEAST_PX) return;
    if (!dragged) label.setPointerCapture(pointerId);
    dragged = true;
    held.steps = Math.round(way / STEP_PX) * (shiftKey ? 10 : 1);
    move(held, false);
  });
  for (const event of ['pointerup', 'pointercancel'])
    label.addEventListener(event, () => {
      // A finger that scrolls the column away takes the value back with it.
      if (held && event === 'pointercancel') held.steps = 0;
      if (held && dragged) move(held, true);
      held = null;
    });
  // The end of a drag is no click, which would focus the field.
  label.addEventListener('click', (event) => {
    if (dragged) event.preventDefault();
  });
}
