// The budget of the rig's errors: how large each may be until the verdict is lost, when somebody asks.

import { Problem } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { row, table } from '../../dom/tables.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { reasonOf } from './plain-words.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {NonNullable<Stability['budget']>} Budget */
/** @typedef {NonNullable<Budget['together']>['factor']} Limit */

/** Impacts that a run has to survive: fewer than those of the verdict, for a budget takes a thousand runs. */
const IMPACTS = 500;

const CRITERIA = {
  linear: 'small deviations grow',
  boundary: 'stability is lost at its boundary',
  lyapunov: 'swings grow in third order',
  fixed_point: 'no bounce in place is left',
  refused: 'no such scene',
  range: 'the range ends',
};

/** @param {Limit} limit */
const lost = ({ decided_by: by, outcome }) => (by === 'nonlinear' ? reasonOf(outcome ?? '') : CRITERIA[by]);

/** A limit with its unit, and the sign of its side. @param {Limit | null} limit @param {string} unit @param {string} sign */
const shown = (limit, unit, sign) =>
  limit === null
    ? '–'
    : limit.decided_by === 'range'
      ? 'any'
      : limit.value === 0
        ? 'none'
        : `${sign}${quantity(limit.value, unit, 3)}`;

/** @param {Budget} budget */
function parts({ errors, together, present, impacts, reason: why }) {
  if (!errors) return [h('p', {}, ...prose(capitalized(why)))];
  const body = h('tbody');
  const without = h('ul', { class: 'muted' });
  for (const { path, unit, value, below, above, reason } of errors) {
    const limits = [below, above].filter((limit) => limit !== null);
    if (reason) without.append(h('li', {}, `${path}: `, ...prose(reason)));
    if (limits.length === 0) continue;
    const reasons = [...new Set(limits.map(lost))].join('; ');
    body.append(
      row(path, [quantity(value, unit, 3), shown(below, unit, '−'), shown(above, unit, '+'), capitalized(reasons)]),
    );
  }
  const head = ['Error', 'Here', 'Down to', 'Up to', 'Beyond it'];
  const isNone = (/** @type {Limit | null} */ limit) => limit?.value === 0;
  const others = errors.some(({ below, above }) => isNone(below) || isNone(above)) ? ', but for those with none' : '';
  const share = (/** @type {number} */ factor) => `${number(100 * factor, 3)} %`;
  return [
    h('p', {}, `Each alone, for runs of ${number(impacts)} impacts:`),
    table('Budget of the errors of the rig', head, body, 'numbers'),
    without.hasChildNodes() ? without : null,
    together && h('p', {}, `All at once${others}: each up to ${share(together.factor.value)} of its nearer limit.`),
    present &&
      h(
        'p',
        {},
        present.factor.value < 1
          ? `The errors of this rig are too large: all would have to come down to ${share(present.factor.value)}.`
          : `The errors of this rig may all grow to ${share(present.factor.value)}.`,
      ),
  ].filter((part) => part !== null);
}

/** @param {(query: string) => Promise<Stability>} ask asks for the verdict with more, which is dearer */
export function budget(ask) {
  const answer = h('div', { role: 'status' });
  const button = h('button', { type: 'button', id: 'budget' }, 'Compute it');
  button.addEventListener('click', async () => {
    button.disabled = true;
    answer.replaceChildren('Trying some thousand runs…');
    try {
      const { budget: found } = await ask(`budget=true&impacts=${IMPACTS}`);
      answer.replaceChildren(...(found ? parts(found) : []));
    } catch (error) {
      // If the scene has changed meanwhile, nobody sees this any more.
      button.disabled = false;
      answer.replaceChildren(error instanceof Problem ? `${error.message} ` : 'The server did not answer. ', button);
    }
  });
  answer.append('How large may each error of the rig be until the verdict is lost? ', button);
  return h('details', { class: 'model budget' }, h('summary', {}, 'Budget of errors'), answer);
}
