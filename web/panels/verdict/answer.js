// A verdict in plain words with its term, its margin, its reason, its numbers, the evidence beyond the linear map, and the model it is for.

import { h } from '../../dom/elements.js';
import { quantity } from '../../dom/numbers.js';
import { entries } from '../../dom/tables.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { evidence } from './evidence.js';
import { headlineOf } from './headline.js';
import { numbersOf } from './numbers.js';
import { plainly } from './plain-words.js';

/** @typedef {import('contract').Stability} Stability */

const DECIDERS = {
  linear: 'the linear map',
  nonlinear: 'a fresh release',
  boundary: 'the boundary',
  lyapunov: 'the third order',
  fixed_point: 'the bounces, of which none repeats',
  ensemble: 'runs with noise',
};

/**
 * @param {import('../card.js').Judged} judged
 * @param {(query: string) => Promise<Stability>} ask asks for the verdict with more, which is dearer
 */
export function answerParts({ answer, scene }, ask) {
  const { verdict, agree, model, notes, nonlinear } = answer;
  const { kind, sign, headline, said, parts } = headlineOf(answer);
  const agreement = agree ? 'linear map and fresh release agree' : 'linear map and fresh release disagree';
  const say = (/** @type {string} */ words) => prose(capitalized(plainly(words)));
  const note = (/** @type {string} */ words) => h('p', { class: 'muted' }, ...say(words));
  const load = nonlinear?.demand;
  const asked =
    load && `The table tilts up to ${quantity(load.tilt, 'rad', 3)} and ${quantity(load.tilt_rate, 'rad/s', 3)}.`;
  const more = [
    h('p', { class: 'line-label' }, 'This setting'),
    h('div', { class: `verdict-words ${kind}` }, ...parts),
    h('p', { class: 'reason' }, ...say(verdict.reason)),
    h(
      'p',
      { class: 'chips' },
      h('span', { class: 'chip' }, `decided by ${DECIDERS[verdict.decided_by]}`),
      agree === null ? '' : h('span', { class: `chip ${agree ? '' : 'caution'}` }, agreement),
    ),
    asked ? h('p', { class: 'asked' }, asked) : '',
    h(
      'details',
      { class: 'verdict-numbers' },
      h('summary', {}, 'Numbers of the verdict'),
      h('dl', { class: 'numbers' }, ...entries(numbersOf(answer))),
    ),
    evidence(answer, () => ask('basin=true')),
    h(
      'p',
      { class: 'model' },
      h('a', { class: 'budget', href: `rig?${scene}#budget` }, 'What may go wrong: the errors of a rig that end it'),
    ),
    h(
      'details',
      { class: 'model' },
      h('summary', {}, `Model: ${model.name.replaceAll('_', ' ')}`),
      note(model.reason),
      ...notes.map(note),
    ),
  ];
  return { kind, sign, headline, said, more };
}
