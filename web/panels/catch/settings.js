// The settings of a catch: how the table moves, and the numbers that this way has.

import { number } from '../../dom/numbers.js';
import { html } from '../../vendor/preact/preact.js';

/** The strategies by their names in requests. @type {Record<string, string>} */
const STRATEGIES = { bounce_down: 'Bounce down', plan: 'Plan', brake: 'Brake' };

/** @type {Record<string, Setting>} */
const NUMBERS = {
  ratio: { label: 'Ratio of speeds', unit: '1' },
  strikes: { label: 'Strikes before the stop', unit: '1' },
  brake: { label: 'Deceleration', unit: 'm/s²' },
  hold: { label: 'Hold for', unit: 's' },
};

/** The numbers that each strategy has, with a hint on each; without a strategy the server chooses. @type {Record<string, Record<string, string>>} */
const HINTS = {
  '': { hold: '6' },
  bounce_down: { ratio: '0.5', hold: '6' },
  plan: { ratio: '0.8', strikes: '8', hold: '6' },
  brake: { brake: 'gravity', hold: '6' },
};

/** @type {Record<string, Setting>} */
export const CATCH = {
  strategy: { label: 'Strategy', usual: '', choices: { '': 'Choose for me', ...STRATEGIES } },
  ...NUMBERS,
};

/** The same for a catch in each cell of a map: comparing all strategies in each takes too long. @type {Record<string, Setting>} */
export const CATCHES = {
  'catch.strategy': { label: 'Strategy', usual: 'bounce_down', choices: STRATEGIES },
  ...Object.fromEntries(Object.entries(NUMBERS).map(([name, one]) => [`catch.${name}`, one])),
};

/** The settings that the chosen strategy has. @param {Record<string, any>} values @param {string} [at] beginning of their names */
export const namesOf = (values, at = '') =>
  ['strategy', ...Object.keys(HINTS[values[`${at}strategy`]])].map((name) => at + name);

/** Those of them that are set, by their names in a request for one catch. @param {Record<string, any>} values @param {string} [at] @returns {Record<string, string | number>} */
export const inUse = (values, at = '') =>
  Object.fromEntries(
    namesOf(values, at)
      .filter((name) => values[name])
      .map((name) => [name.slice(at.length), values[name]]),
  );

/** @param {{values: Record<string, any>, field: (name: string, hint?: string) => unknown, at?: string}} props */
export const CatchFields = ({ values, field, at = '' }) => html`<fieldset class="study-settings row">
  <legend>How</legend>
  ${namesOf(values, at).map((name) => field(name, HINTS[values[`${at}strategy`]][name.slice(at.length)]))}
</fieldset>`;

/** A strategy with its numbers. @param {Pick<import('contract').CatchUsed, 'strategy' | 'ratio' | 'strikes' | 'brake'>} used */
export function described({ strategy, ratio, strikes, brake }) {
  const numbers = [
    strikes === null ? '' : `${strikes} strikes`,
    ratio === null ? '' : `ratio ${number(ratio)}`,
    brake === null ? '' : `${number(brake)}\u202fm/s²`,
  ].filter(Boolean);
  return `${STRATEGIES[strategy]}, ${numbers.join(' of ')}`;
}
