// Sliders for fields: range and step, and a slider that stays where it was when a finger only scrolls past it.

import { shownFactor, shownValue } from '../dom/units.js';
import RANGES from './slider-ranges.json' with { type: 'json' };

/** The first range of a slider. The fields' own ranges are too wide to aim in; a typed value widens the slider. @type {Record<string, number[]>} */
const COMFORTABLE = RANGES;

/** A step of 1, 2 or 5 that parts the span into some two hundred. @param {number} span */
function step(span) {
  const raw = span / 200;
  const power = 10 ** Math.floor(Math.log10(raw));
  return Number((power * ([1, 2, 5].find((m) => m * power >= raw * 0.999) ?? 10)).toPrecision(2));
}

/** @param {Field} field @param {number | null} value @returns {[number, number]} */
export function sliderRange(field, value) {
  const size = Math.abs(value || Number(field.default) || 1);
  const low = field.minimum ?? -Infinity;
  const high = field.maximum ?? Infinity;
  const [from, to] = COMFORTABLE[field.field] ?? [low >= 0 ? 0 : -2 * size, field.maximum === 1 ? 1 : 2 * size];
  if (value == null || (value >= from && value <= to)) return [Math.max(low, from), Math.min(high, to)];
  const round = step((Math.max(to, value) - Math.min(from, value)) * 20);
  return [
    Math.max(low, value < from ? Math.floor(value / round - 1) * round : from),
    Math.min(high, value > to ? Math.ceil(value / round + 1) * round : to),
  ];
}

/** Places of a slider's end in degrees, so that it is a number one reads. */
const ROUND_DEG = 5;

/** The range of a slider in the unit that the page shows. @param {Field} field @param {number | null} value @returns {[number, number]} */
export function shownRange(field, value) {
  const [from, to] = sliderRange(field, value);
  const factor = shownFactor(field.unit);
  if (factor === 1) return [from, to];
  const low = shownValue(field.minimum ?? -Infinity, field.unit);
  const high = shownValue(field.maximum ?? Infinity, field.unit);
  const round = to - from < 0.2 ? ROUND_DEG / 10 : ROUND_DEG;
  return [
    Math.max(low, Math.floor((from * factor) / round + 1e-9) * round),
    Math.min(high, Math.ceil((to * factor) / round - 1e-9) * round),
  ];
}

/** The step of a slider and of the arrow keys, in the unit that the page shows. @param {Field} field @param {number | null} value */
export function sliderStep(field, value) {
  if (field.kind === 'integer') return 1;
  const [from, to] = shownRange(field, value);
  return step(to - from);
}

/** The value that a field begins with when it is set: none of its kind, or the middle of its slider. @param {Field} field */
export function firstValue(field) {
  const [from, to] = sliderRange(field, null);
  if (field.kind === 'integer' || (from < 0 && to > 0)) return Math.max(0, field.minimum ?? 0);
  return Number(((from + to) / 2).toPrecision(2));
}

/**
 * A finger that only scrolls past a slider has moved it before the browser knows: then what was there is put back.
 * @param {HTMLInputElement} slider
 * @param {() => () => void} hold keeps what the slider stands for, and gives what puts it back
 */
export function steady(slider, hold) {
  let putBack = () => {};
  let scrolled = false;
  slider.addEventListener('pointerdown', () => {
    scrolled = false;
    const before = slider.value;
    const give = hold();
    putBack = () => {
      slider.value = before;
      give();
    };
  });
  slider.addEventListener('pointercancel', () => {
    scrolled = true;
    putBack();
  });
  slider.addEventListener('keydown', () => {
    scrolled = false;
  });
  // The browser tells the cancelled move all the same.
  const told = (/** @type {Event} */ event) => {
    if (!scrolled) return;
    event.stopImmediatePropagation();
    putBack();
    if (event.type === 'change') scrolled = false;
  };
  for (const event of ['input', 'change']) slider.addEventListener(event, told, { capture: true });
}
