// The settings of a catch: how the table moves, and the numbers that this way has.

import { number } from '../../dom/numbers.js';
import { parse } from '../../dom/typed-number.js';
import { html, useLayoutEffect } from '../../vendor/preact/preact.js';
import { ErrorLine, SharedField } from '../parts.js';

/** The strategies by their names in requests; without one the server chooses. */
const STRATEGIES = { '': 'Choose for me', bounce_down: 'Bounce down', plan: 'Plan', brake: 'Brake' };

/** The numbers, with a hint for each strategy that has them. */
const NUMBERS = {
  ratio: { label: 'Ratio of speeds', unit: '1', hints: { bounce_down: '0.5', plan: '0.8' } },
  strikes: { label: 'Strikes before the stop', unit: '1', hints: { plan: '8' } },
  brake: { label: 'Deceleration', unit: 'm/s²', hints: { brake: 'gravity' } },
  hold: { label: 'Hold for', unit: 's', hints: { '': '6', bounce_down: '6', plan: '6', brake: '6' } },
};

/** @typedef {Partial<Record<'strategy', string> & Record<keyof typeof NUMBERS, number>>} CatchSettings */
/** @typedef {{detail: string, pointer: string}} Fault */

/** The hints on the numbers of the chosen strategy. @param {CatchSettings} settings @returns {[keyof typeof NUMBERS, string][]} */
const hintsOf = ({ strategy = '' }) =>
  Object.entries(NUMBERS).flatMap(([name, { hints }]) => {
    const hint = /** @type {Record<string, string>} */ (hints)[strategy];
    return hint === undefined ? [] : [[/** @type {keyof typeof NUMBERS} */ (name), hint]];
  });

/** The settings that the chosen strategy has. @param {CatchSettings} settings @returns {Record<string, string | number>} */
export function inUse(settings) {
  const names = ['strategy', ...hintsOf(settings).map(([name]) => name)];
  return Object.fromEntries(Object.entries(settings).filter(([name, value]) => value && names.includes(name)));
}

/** The settings of a link, and those that it has wrong. @param {URLSearchParams} link @param {string} key beginning of theirs */
export function readCatch(link, key) {
  /** @type {CatchSettings} */
  const settings = {};
  /** @type {string[]} */
  const dropped = [];
  const strategy = link.get(`${key}strategy`);
  if (strategy && strategy in STRATEGIES) settings.strategy = strategy;
  else if (strategy) dropped.push(`the strategy “${strategy.slice(0, 40)}”`);
  for (const name of /** @type {(keyof typeof NUMBERS)[]} */ (Object.keys(NUMBERS))) {
    const text = link.get(key + name);
    if (!text) continue;
    const value = parse(text, null);
    if (value !== null) settings[name] = value;
    else dropped.push(`${name} of the catch “${text.slice(0, 40)}”, which is not a number`);
  }
  return { settings, dropped };
}

/** The errors that are about none of the settings in use. @param {import('contract').ProblemError[]} errors @param {CatchSettings} settings */
export const others = (errors, settings) =>
  errors.filter(({ pointer }) => !hintsOf(settings).some(([name]) => pointer === `/${name}`));

/**
 * @param {object} props
 * @param {string} props.id beginning of theirs
 * @param {CatchSettings} props.settings
 * @param {import('contract').ProblemError[]} props.errors of the server; the first of them gets the focus
 * @param {boolean} [props.automatic] the server may choose the strategy
 * @param {(settings: CatchSettings) => void} props.changed
 */
export function CatchFields({ id, settings, errors, automatic = false, changed }) {
  useLayoutEffect(() => {
    const places = errors.map(({ pointer }) => document.getElementById(`${id}-${pointer.slice(1)}`));
    places.find(Boolean)?.focus();
  }, [errors]);
  const choose = (/** @type {{currentTarget: HTMLSelectElement}} */ { currentTarget: { value } }) =>
    changed({ ...settings, strategy: value || undefined });
  return html`<fieldset class="study-settings">
    <legend>How</legend>
    <div class="study-row">
      <label for=${`${id}-strategy`}>Strategy</label>
      <select id=${`${id}-strategy`} value=${settings.strategy ?? ''} onChange=${choose}>
        ${Object.entries(STRATEGIES).map(
          ([value, words]) => (automatic || value) && html`<option value=${value}>${words}</option>`,
        )}
      </select>
    </div>
    ${hintsOf(settings).map(([name, hint]) => {
      const { label, unit } = NUMBERS[name];
      const own = errors.filter(({ pointer }) => pointer === `/${name}`);
      return html`<div class="study-row" key=${name}>
        <label for=${`${id}-${name}`}>${label}</label>
        <${SharedField}
          id=${`${id}-${name}`}
          error=${`${id}-${name}-error`}
          unit=${unit}
          value=${settings[name]}
          hint=${hint}
          blamed=${own.length > 0}
          changed=${(/** @type {number | undefined} */ value) => changed({ ...settings, [name]: value })}
        />
        ${unit !== '1' && html`<span class="unit">${unit}</span>`}
        <${ErrorLine} id=${`${id}-${name}-error`} errors=${own} />
      </div>`;
    })}
  </fieldset>`;
}

/** A strategy with its numbers. @param {Pick<import('contract').CatchUsed, 'strategy' | 'ratio' | 'strikes' | 'brake'>} used */
export function described({ strategy, ratio, strikes, brake }) {
  const numbers = [
    strikes === null ? '' : `${strikes} strikes`,
    ratio === null ? '' : `ratio ${number(ratio)}`,
    brake === null ? '' : `${number(brake)}\u202fm/s²`,
  ].filter(Boolean);
  return `${STRATEGIES[strategy]}, ${numbers.join(' of ')}`;
}
