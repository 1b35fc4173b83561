// Endings of runs in plain words, and which run a sentence of the server is on.

import { number } from '../../dom/numbers.js';
import { ENDINGS } from '../../run/generated/endings.js';

/** The verbs of the server's headlines, told of a run that is over. @type {Record<string, string>} */
const PAST = {
  Falls: 'fell',
  'Comes to rest': 'stopped bouncing',
  'Cannot be followed': 'could not be followed',
  Caught: 'was caught',
  'Not caught': 'was not caught',
};

/** The reason of an ending; it goes on after “fell at bounce 11:”. @param {string} kind */
export const reasonOf = (kind) =>
  kind === 'completed' ? 'it went through all its bounces' : (ENDINGS[kind]?.reason ?? kind.replaceAll('_', ' '));

/** The ending of a run in words, as in “fell at bounce 11”. @param {string} kind @param {number} impacts */
export function endedAs(kind, impacts) {
  if (kind === 'completed') return `survived ${number(impacts, 8)} bounces`;
  const when = impacts === 0 ? 'before its first bounce' : `at bounce ${number(impacts, 8)}`;
  return `${PAST[ENDINGS[kind]?.verb] ?? 'ended'} ${when}`;
}

/** A sentence of the server on the run that a verdict rests on, which is a fresh release and never “this run”. @param {string} text */
export const plainly = (text) =>
  text
    .replace(
      /\b(?:this|the) run ended as `(\w+)` at contact (\d+)/g,
      (_, kind, n) => `a fresh release ${endedAs(kind, Number(n))} (${reasonOf(kind)})`,
    )
    .replace(/\b(?:this|the) run\b/g, 'a fresh release');
