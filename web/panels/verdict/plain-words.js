// Endings of runs in plain words, and which run a sentence of the server is on.

import { number } from '../../dom/numbers.js';

/** Reasons why runs end, by the kind of their outcome; each goes on after “fell at bounce 11:”. @type {Record<string, string>} */
const ENDINGS = {
  completed: 'it went through all its bounces',
  toppled: 'it had tipped over',
  separating: 'its foot was leaving the table already',
  sinking: 'the table struck too steeply',
  settled: 'its bounces died out',
  diverged: 'it became too fast to compute',
  other_vertex: 'another corner touched the table',
  missed: 'it never met the table again',
  beyond_limits: 'the strike asks more of the table than its limits allow',
};

/** The reason of an ending. @param {string} kind */
export const reasonOf = (kind) => ENDINGS[kind] ?? kind.replaceAll('_', ' ');

/** The ending of a run in words, as in “fell at bounce 11”. @param {string} kind @param {number} impacts */
export function endedAs(kind, impacts) {
  const at = `at bounce ${number(impacts, 8)}`;
  if (kind === 'completed') return `survived ${number(impacts, 8)} bounces`;
  if (kind === 'settled') return `came to rest ${at}`;
  return `${kind === 'diverged' ? 'could not be followed' : 'fell'} ${at}`;
}

/** A sentence of the server on the run that a verdict rests on, which is a fresh release and never “this run”. @param {string} text */
export const plainly = (text) =>
  text
    .replace(
      /\b(?:this|the) run ended as `(\w+)` at contact (\d+)/g,
      (_, kind, n) => `a fresh release ${endedAs(kind, Number(n))} (${reasonOf(kind)})`,
    )
    .replace(/\b(?:this|the) run\b/g, 'a fresh release');
