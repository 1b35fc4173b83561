// The answer of a catch in words, numbers and tables.

import { h } from '../../dom/elements.js';
import { number, quantity } from '../../dom/numbers.js';
import { row, table } from '../../dom/tables.js';
import { capitalized, prose } from '../../dom/typeset.js';
import { ENDINGS } from '../../run/generated/endings.js';
import { LOAD_COLUMNS, loadRows } from '../impacts/demand.js';
import { described } from './settings.js';

/** @typedef {import('contract').Catch} Catch */
/** @typedef {import('contract').CatchOutcome} Outcome */

/** The strategies in the field's terms. */
const TERMS = {
  bounce_down: 'bounces that die down, with a gain scheduled on the contact speed',
  plan: 'multiple shooting over the strikes, planned again at each',
  brake: 'inelastic landing at the table’s own speed, then lasting contact',
};

/** @param {{kind: string}} outcome */
export const isCaught = ({ kind }) => ENDINGS[kind]?.verb === 'Caught';

/** The outcome of a catch in plain words. @param {Outcome} outcome */
function headline({ kind }) {
  const { verb, reason } = ENDINGS[kind];
  // Of a run it is the end; of a catch it is one way not to catch.
  return [kind === 'beyond_limits' ? 'Not caught' : verb, reason];
}

/** The headline, and below it the strategy in the field's terms and the numbers. @param {Catch} answer */
export function told({ outcome, settings, strategy }) {
  const [verb, reason] = headline(outcome);
  const chosen = strategy.reason === 'as asked for' ? '' : ` ${capitalized(strategy.reason)}.`;
  return [
    h('p', { class: 'answer' }, h('strong', { class: 'large' }, verb), `: ${reason}.`),
    h('p', { id: 'catch-term' }, `${described(settings)}: ${TERMS[settings.strategy]}.`),
    h('p', { class: 'muted small' }, ...prose(`${capitalized(outcome.detail)}.${chosen}`)),
  ];
}

/** Demands of the catch on the table, beside its limits. @param {Catch} answer */
export const demands = ({ demand, scene }) =>
  table(
    'What it asks of the table',
    LOAD_COLUMNS,
    h('tbody', {}, ...loadRows(demand, scene.table?.limits ?? {})),
    'demands',
  );

/** Times, contact and reach. @param {Catch} answer @returns {[string | Node, string, string][]} */
export function facts({ strikes, contact_from: from, upright_within: upright, demand, reach, error_bound: bound }) {
  return [
    ['strikes', number(strikes.n.length), 'before the contact lasts'],
    ['in contact', quantity(from, 's'), 'since the release'],
    ['upright', quantity(upright.theta_1mrad, 's'), `within ${quantity(0.001, 'rad')}, since the release`],
    ['in place', quantity(upright.x_1mm, 's'), 'within 1 mm, since the release'],
    ['force', quantity(demand.normal_force, 'm/s²'), 'largest normal force per mass in contact'],
    ['friction', number(demand.friction), 'least coefficient that the contact needs'],
    [
      'reach',
      reach ? quantity(reach.theta, 'rad') : '–',
      reach?.limit
        ? `θ + θ̇ρ/√(Gl) as contact begins; it can turn back ${quantity(reach.limit, 'rad')}`
        : 'θ + θ̇ρ/√(Gl) as contact begins',
    ],
    ['error', quantity(bound, 'm', 2), 'bound of the motion in contact'],
  ];
}

/** The reason that rules a candidate out, or none. @param {import('contract').CatchCandidate} candidate */
function judged({ taken, outcome }) {
  if (taken) return 'taken';
  if (isCaught(outcome)) return 'would catch it too';
  return ENDINGS[outcome.kind].reason + (outcome.quantity ? ` (${outcome.quantity.replaceAll('_', ' ')})` : '');
}

/** The strategies that were compared; empty where one was asked for. @param {Catch} answer */
export const candidates = ({ candidates: all }) =>
  all.length < 2
    ? []
    : [
        table(
          'Strategies compared',
          ['strategy', 'verdict', 'contact from', 'tilt', 'speed', 'stroke'],
          h(
            'tbody',
            {},
            ...all.map((one) =>
              row(described(one), [
                judged(one),
                quantity(one.contact_from, 's', 3),
                quantity(one.demand.tilt, 'rad', 3),
                quantity(one.demand.speed, 'm/s', 3),
                quantity(one.demand.stroke, 'm', 3),
              ]),
            ),
          ),
          'candidates',
        ),
      ];

/** Each strike with its numbers. @param {Catch} answer */
export const strikesTable = ({ strikes }) =>
  table(
    'Strikes',
    ['n', 't / s', 'θ / rad', 'α / rad', 'w / (m/s)', 'ratio'],
    h(
      'tbody',
      {},
      ...strikes.n.map((n, index) =>
        row(String(n), [
          quantity(strikes.t[index], '1', 5),
          quantity(strikes.theta[index], 'rad'),
          quantity(strikes.alpha[index], 'rad'),
          number(strikes.table_velocity[index]),
          number(strikes.ratio[index]),
        ]),
      ),
    ),
    'strikes',
  );
