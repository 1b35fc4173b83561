// The budget of the rig's errors: how large each may be until the verdict is lost, when somebody asks.

import { Problem } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { table } from '../../dom/tables.js';
import { shownFactor } from '../../dom/units.js';
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
const lost = ({ decided_by: by, outcome }) => (by === 'nonlinear' ? reasonOf(outcome?.kind ?? '') : CRITERIA[by]);

/** A limit in the shown unit, as a size with the sign of its side or as a value. @param {Limit | null} limit @param {string} unit @param {-1 | 1} side @param {number} from */
const shown = (limit, unit, side, from) =>
  limit === null
    ? '–'
    : limit.decided_by === 'range'
      ? 'any'
      : limit.value === 0
        ? 'none'
        : from !== 0
          ? number((from + side * limit.value) * shownFactor(unit), 3)
          : `${side < 0 ? '−' : '+'}${number(limit.value * shownFactor(unit), 3)}`;

/** @param {Budget} budget */
function parts({ errors, together, present, bounces, reason: why }) {
  if (!errors) return [h('p', {}, ...prose(capitalized(why)))];
  const bodies = document.createDocumentFragment();
  const without = h('ul', { class: 'muted' });
  for (const { field, unit, value, reference, below, above, reason } of errors) {
    const limits = [below, above].filter((limit) => limit !== null);
    if (reason) without.append(h('li', {}, `${field}: `, ...prose(reason)));
    if (limits.length === 0) continue;
    const reasons = [...new Set(limits.map(lost))].join('; ');
    const cells = [shown(below, unit, -1, reference), shown(above, unit, 1, reference), capitalized(reasons)];
    // The panel is narrow: a path has a line of its own, with the unit.
    bodies.append(
      h(
        'tbody',
        {},
        h('tr', {}, h('th', { colspan: 3, scope: 'rowgroup' }, `${field}, here ${quantity(value, unit, 3)}`)),
        h('tr', {}, ...cells.map((cell) => h('td', {}, cell))),
      ),
    );
  }
  const head = ['Down to', 'Up to', 'Beyond it'];
  const isNone = (/** @type {Limit | null} */ limit) => limit?.value === 0;
  const others = errors.some(({ below, above }) => isNone(below) || isNone(above)) ? ', but for those with none' : '';
  const share = (/** @type {number} */ factor) => `${number(100 * factor, 3)} %`;
  return [
    h('p', {}, `Each alone, for runs of ${number(bounces)} impacts:`),
    table('Budget of the errors of the rig', head, bodies),
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
      const { budget: found } = await ask(`budget=true&bounces=${IMPACTS}`);
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
