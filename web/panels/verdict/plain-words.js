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

/** The end, and the reason. @type {Partial<Record<import('contract').HoldEnd['kind'], [string, string]>>} */
const FALLS = {
  toppled: ['fell over', 'it tipped over'],
  other_vertex: ['fell over', 'another corner touched the table'],
  contact_lost: ['left the table', 'only a pull could keep its foot there'],
  slipped: ['slipped', 'its foot slipped on the table'],
  beyond_limits: ['was lost', 'the contact asks more of the table than its limits allow'],
  off_table: ['left the table', 'the table ended before it'],
  too_long: ['could not be followed', 'its motion in contact is too long to compute'],
};

/**
 * The deed of a body that fell in contact, as in “stopped bouncing and fell over”, and the reason; null if it did not.
 * @param {import('contract').Outcome & {contact?: import('contract').HoldEnd}} outcome of the connection, with its end in contact
 */
export function fallInContact({ contact }) {
  const [deed, reason] = (contact && FALLS[contact.kind]) ?? [];
  return deed ? { deed, reason } : null;
}
