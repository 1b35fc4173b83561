// Settings of a panel: their parts of the address, the fields in which they are typed, and the request that they make.

import { brokenLinkNotice } from '../dom/notices.js';
import { number } from '../dom/numbers.js';
import { inWords } from '../dom/typeset.js';
import { html, useEffect } from '../vendor/preact/preact.js';
import { Choice, NumberField } from './parts.js';

/** A whole number from 1. @param {string} label @param {number} usual @param {number} most @param {string} [key] @returns {Setting} */
export const whole = (label, usual, most, key) => ({
  label,
  usual,
  key,
  right: (value) => Number.isInteger(value) && value >= 1 && value <= most,
  must: `a whole number from 1 to ${number(most, 7)}`,
});

/** Names of choices in words. @param {string[]} names */
const oneOf = (names) => (names.length > 2 ? `one of ${names.join(', ')}` : names.join(' or '));

/** A number of an address; NaN for a text that is none. @param {string | null} text */
export const numberOf = (text) => (text?.trim() ? Number(text) : NaN);

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
  const values = Object.entries(settings).map(
    ([name, { key = name, usual, choices, right = Number.isFinite, must }]) => {
      const part = `${id}.${key}`;
      const text = link.get(part);
      if (text === null) return [name, usual];
      if (choices ? Object.hasOwn(choices, text) : right(numberOf(text)))
        return [name, typeof usual === 'string' ? text : Number(text)];
      const allowed = must ?? (choices ? oneOf(Object.keys(choices)) : 'a number');
      broken.push([part, `${part} “${text.slice(0, 40)}”: it must be ${allowed}`]);
      return [name, usual];
    },
  );
  return { values: Object.fromEntries(values), broken };
}

/** The panels' parts of an address, as a page keeps them. */
export class Parts extends EventTarget {
  link = new URLSearchParams();

  /** Hears of other parts. */
  changed() {}

  /** Tells of broken parts, if there are any. @param {string} id of the panel @param {string[]} words */
  dropped(id, words) {
    brokenLinkNotice(`link-${id}`, words);
  }

  /** @type {PanelPage['part']} */
  part = (changes) => {
    const link = new URLSearchParams(this.link);
    for (const [part, value] of Object.entries(changes)) {
      if (value === null) link.delete(part);
      else link.set(part, value);
    }
    this.link = link;
    this.changed();
  };

  /** @type {PanelPage['drop']} */
  drop = (id, broken) => {
    this.dropped(id, broken.map(([, words]) => words).filter(Boolean));
    this.part(Object.fromEntries(broken.map(([part, , right = null]) => [part, right])));
  };
}

/** The server's errors about a part of a request. @param {ProblemError[]} errors @param {string} name */
export const within = (errors, name) => {
  const place = `/${name.replaceAll('.', '/')}`;
  return errors.filter(({ pointer }) => pointer === place || pointer.startsWith(`${place}/`));
};

/** @param {ProblemError[]} errors */
const wordsOf = (errors) => errors.map(({ detail }) => inWords(detail)).join(' ');

/** The server's words on a part of a request. @param {ProblemError[]} errors @param {string} name */
export const faultOf = (errors, name) => wordsOf(within(errors, name));

/** The server's words on all else of it. @param {ProblemError[]} errors @param {string[]} names */
export const otherFaults = (errors, names) =>
  wordsOf(errors.filter((error) => !names.some((name) => within([error], name).length > 0)));

/** The server's words on a refusal, but for those that stand beside fields. @param {Problem} problem @param {string[]} names of the fields */
export const refusalOf = ({ errors, message }, names) =>
  errors.length === 0 ? message : otherFaults(errors, names) || 'A setting is out of its range; it is marked.';

/** Takes broken parts of the address away. @param {PanelPage} page @param {string} id of the panel @param {Broken} broken */
export const useWhole = (page, id, broken) =>
  useEffect(() => {
    // A page that draws at once may not do so within an effect.
    if (broken.length > 0) queueMicrotask(() => page.drop(id, broken));
  }, [page.link]);

/** @param {number | undefined} value @param {number} factor */
const scaled = (value, factor) =>
  value === undefined || factor === 1 ? value : Number((value * factor).toPrecision(12));

/**
 * The controls of settings, and the same with their labels.
 * @param {PanelPage} page
 * @param {string} id of the panel
 * @param {Record<string, Setting>} settings
 * @param {Record<string, any>} values
 * @param {ProblemError[]} [errors] of the server on the request
 */
export function controlsOf(page, id, settings, values, errors = []) {
  const idOf = (/** @type {string} */ name) => `${id}-${(settings[name].key ?? name).replaceAll('.', '-')}`;
  /** @param {string} name @param {{id?: string, label?: string, hint?: string, blame?: string}} [more] `hint` stands in an empty field; words on the value that stands, where they are not those of the errors */
  const control = (name, { id: place = idOf(name), label, hint = '', blame = faultOf(errors, name) } = {}) => {
    const { key = name, usual, unit, scale = 1, choices, right, disabled, must } = settings[name];
    const open = settings[name].open ?? usual === undefined;
    const changed = (/** @type {number | string | undefined} */ value) =>
      page.part({ [`${id}.${key}`]: String(value) === String(usual) ? null : String(value) });
    if (choices)
      return html`<${Choice} id=${place} value=${String(values[name])} choices=${choices} changed=${changed} />`;
    return html`<${NumberField} key=${name} id=${place} label=${label} unit=${unit} value=${scaled(values[name], scale)} placeholder=${hint} open=${open} disabled=${disabled} blame=${blame}
      fault=${(/** @type {number} */ typed) => (right?.(typed / scale) === false ? `It must be ${must}.` : null)}
      changed=${(/** @type {number | undefined} */ typed) => changed(scaled(typed, 1 / scale))} />`;
  };
  const field = (/** @type {string} */ name, /** @type {string} */ hint = '') =>
    html`<p class="study-row row" key=${name}><label for=${idOf(name)}>${settings[name].label}</label>${control(name, { hint })}</p>`;
  return { control, field };
}

/**
 * The settings of a panel from the address, and their fields.
 * @param {PanelPage} page
 * @param {string} id of the panel
 * @param {Record<string, Setting>} settings
 * @param {ProblemError[]} [errors] of the server on the request
 */
export function useSettings(page, id, settings, errors) {
  const { values, broken } = readSettings(id, settings, page.link);
  useWhole(page, id, broken);
  return { values, ...controlsOf(page, id, settings, values, errors) };
}

/** A request about a scene; null while that is not whole. @param {string} path @param {URLSearchParams | null} query @param {Record<string, unknown>} more what is empty is left to the server */
export function requestOf(path, query, more) {
  if (!query) return null;
  const request = new URLSearchParams(query);
  for (const [name, value] of Object.entries(more))
    if (value !== undefined && value !== '') request.set(name, String(value));
  return `${path}?${request}`;
}
