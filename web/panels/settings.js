// Settings of a panel: their parts of the address, and the fields in which they are typed.

import { number } from '../dom/numbers.js';
import { html, useEffect } from '../vendor/preact/preact.js';
import { Choice, NumberField } from './parts.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/**
 * The page around a panel, as far as the panel knows it.
 * @typedef {object} Page
 * @property {Field[]} fields
 * @property {URLSearchParams | null} query the scene; null while some of it is no value
 * @property {Scene} scene as far as it goes
 * @property {URLSearchParams} link parts of the address that belong to panels
 * @property {(changes: Record<string, string | null>) => void} part changes such parts; null takes one away
 * @property {(id: string, broken: Broken) => void} drop takes broken parts away, and tells of them
 * @property {(scene: Scene) => void} take shows another scene
 * @property {boolean} [unattended] nobody is there to press a button
 */

/** Parts of an address that are wrong, with words on each, and what of them is right. @typedef {[part: string, words: string, right?: string][]} Broken */

/**
 * @typedef {object} Setting
 * @property {string} [key] its part of the address behind the panel's, where that is not its name
 * @property {unknown} label
 * @property {number | string} usual
 * @property {string} [unit] in which it is typed
 * @property {number} [scale] typed units in one of the address
 * @property {Record<string, string>} [choices] with their words
 * @property {(value: number) => boolean} [right]
 * @property {string} [must] it must be, in words
 */

/** A whole number from 1. @param {string} label @param {number} usual @param {number} most @returns {Setting} */
export const whole = (label, usual, most) => ({
  label,
  usual,
  right: (value) => Number.isInteger(value) && value >= 1 && value <= most,
  must: `a whole number from 1 to ${number(most, 7)}`,
});

/** Names of choices in words. @param {string[]} names */
const oneOf = (names) => (names.length > 2 ? `one of ${names.join(', ')}` : names.join(' or '));

/**
 * The settings of an address.
 * @param {string} id of the panel
 * @param {Record<string, Setting>} settings
 * @param {URLSearchParams} link
 * @returns {{values: Record<string, any>, broken: Broken}}
 */
export function readSettings(id, settings, link) {
  /** @type {Broken} */
  const broken = [];
  const values = Object.entries(settings).map(([name, { key = name, usual, choices, right, must }]) => {
    const part = `${id}.${key}`;
    const text = link.get(part);
    if (text === null) return [name, usual];
    const value = choices || text.trim() === '' ? text : Number(text);
    if (choices ? Object.hasOwn(choices, text) : typeof value === 'number' && right?.(value)) return [name, value];
    broken.push([part, `${part} “${text.slice(0, 40)}”: it must be ${choices ? oneOf(Object.keys(choices)) : must}`]);
    return [name, usual];
  });
  return { values: Object.fromEntries(values), broken };
}

/** Parts of an address with others in their place. @param {URLSearchParams} link @param {Record<string, string | null>} changes */
export function withParts(link, changes) {
  const changed = new URLSearchParams(link);
  for (const [part, value] of Object.entries(changes)) {
    if (value === null) changed.delete(part);
    else changed.set(part, value);
  }
  return changed;
}

/** Parts without what is broken of them. @param {URLSearchParams} link @param {Broken} broken */
export const wholeParts = (link, broken) =>
  withParts(link, Object.fromEntries(broken.map(([part, , right = null]) => [part, right])));

/** A setting with its label. @param {{id: string, setting: Setting, value: any, changed: (value: number | string) => void}} props */
function SettingField({ id, setting: { label, unit, scale = 1, choices, right, must }, value, changed }) {
  return html`<p class="study-row">
    <label for=${id}>${label}</label>
    ${
      choices
        ? html`<${Choice} id=${id} value=${value} choices=${choices} changed=${changed} />`
        : html`<${NumberField} id=${id} unit=${unit} value=${Number((value * scale).toPrecision(12))}
            fault=${(/** @type {number} */ typed) => (right?.(typed / scale) ? null : `It must be ${must}.`)}
            changed=${(/** @type {number} */ typed) => changed(Number((typed / scale).toPrecision(12)))} />`
    }
  </p>`;
}

/**
 * The settings of a panel from the address, and their fields.
 * @param {Page} page
 * @param {string} id of the panel
 * @param {Record<string, Setting>} settings
 */
export function useSettings(page, id, settings) {
  const { values, broken } = readSettings(id, settings, page.link);
  useEffect(() => {
    if (broken.length > 0) page.drop(id, broken);
  }, [page.link]);
  const field = (/** @type {string} */ name) => {
    const { key = name, usual } = settings[name];
    const changed = (/** @type {number | string} */ value) =>
      page.part({ [`${id}.${key}`]: value === usual ? null : String(value) });
    return html`<${SettingField} key=${name} id=${`${id}-${name}`} setting=${settings[name]} value=${values[name]} changed=${changed} />`;
  };
  return { values, field };
}

/** A request about a scene; null while that is not whole. @param {string} path @param {URLSearchParams | null} query @param {Record<string, unknown>} more */
export function requestOf(path, query, more) {
  if (!query) return null;
  const request = new URLSearchParams(query);
  for (const [name, value] of Object.entries(more)) request.set(name, String(value));
  return `${path}?${request}`;
}
