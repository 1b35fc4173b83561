// The answer of a catch in words, numbers, tables and the server's picture, moment by moment through strikes and hold.

import { movedInRow } from '../../charts/readable/chart-reader.js';
import { FigureColumns } from '../../charts/readable/server-figure.js';
import { fixedQuantity, number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { ENDINGS } from '../../run/generated/endings.js';
import { html } from '../../vendor/preact/preact.js';
import { Loads, Picture, Savings } from '../figures.js';
import { Numbers, Row, Table, brief } from '../parts.js';
import { described } from './settings.js';

/** @typedef {import('contract').Catch} Catch */
/** @typedef {import('contract').CatchOutcome} Outcome */
/** An answer with its picture and the path of the request. @typedef {{answer: Catch, figure: SVGSVGElement, path: string}} Answered */

/** The strategies in the field's terms. */
const TERMS = {
  bounce_down: 'bounces that die down, with a gain scheduled on the contact speed',
  plan: 'multiple shooting over the strikes, planned again at each',
  brake: 'inelastic landing at the table’s own speed, then lasting contact',
};

/** The outcome of a catch in plain words. @param {Outcome} outcome */
function headline({ kind }) {
  const { verb, reason } = ENDINGS[kind];
  // Of a run it is the end; of a catch it is one way not to catch.
  return [kind === 'beyond_limits' ? 'Not caught' : verb, reason];
}

/** The headline, and below it the strategy in the field's terms and the numbers. @param {Answered} props */
export function Told({ answer: { outcome, settings, strategy } }) {
  const [verb, reason] = headline(outcome);
  const chosen = strategy.reason === 'as asked for' ? '' : ` ${capitalized(strategy.reason)}.`;
  return html`<p class="answer"><strong class="large">${verb}</strong>: ${reason}.</p>
    <p id="catch-term">${described(settings)}: ${TERMS[settings.strategy]}.</p>
    <p class="muted small">${brief(`${capitalized(outcome.detail)}.${chosen}`)}</p>`;
}

/** Times, contact and reach. @param {Catch} answer @returns {[name: string, value: string, meaning: string][]} */
function facts({ strikes, contact_from: from, upright_within: upright, demand, reach, error_bound: bound }) {
  const limit = reach?.limit ? `; it can turn back ${quantity(reach.limit, 'rad')}` : '';
  return [
    ['strikes', number(strikes.n.length), 'before the contact lasts'],
    ['in contact', quantity(from, 's'), 'since the release'],
    ['upright', quantity(upright.theta_1mrad, 's'), `within ${quantity(0.001, 'rad')}, since the release`],
    ['in place', quantity(upright.x_1mm, 's'), 'within 1 mm, since the release'],
    ['force', quantity(demand.normal_force, 'm/s²'), 'largest normal force per mass in contact'],
    ['friction', number(demand.friction), 'least coefficient that the contact needs'],
    ['reach', reach ? quantity(reach.theta, 'rad') : '–', `θ + θ̇ρ/√(Gl) as contact begins${limit}`],
    ['error', quantity(bound, 'm', 2), 'bound of the motion in contact'],
  ];
}

/** The reason that rules a candidate out, or none. @param {import('contract').CatchCandidate} candidate */
function judged({ taken, outcome }) {
  if (taken) return 'taken';
  const { verb, reason } = ENDINGS[outcome.kind];
  if (verb === 'Caught') return 'would catch it too';
  return reason + (outcome.quantity ? ` (${outcome.quantity.replaceAll('_', ' ')})` : '');
}

/** The strategies that were compared; none where one was asked for. @param {{all: Catch['candidates']}} props */
const Candidates = ({ all }) =>
  all.length > 1 &&
  html`<${Table}
    label="Strategies compared"
    kind="candidates"
    head=${['strategy', 'verdict', 'contact from', 'tilt', 'speed', 'stroke']}
    children=${all.map((one) => {
      const { tilt, speed, stroke } = one.demand;
      const numbers = [quantity(one.contact_from, 's', 3), quantity(tilt, 'rad', 3), quantity(speed, 'm/s', 3)];
      return html`<${Row} cells=${[described(one), judged(one), ...numbers, quantity(stroke, 'm', 3)]} />`;
    })}
  />`;

/** Each strike with its numbers. @param {{strikes: Catch['strikes']}} props */
const Strikes = ({ strikes: { n, t, theta, alpha, table_velocity: speed, ratio } }) =>
  html`<${Table}
    label="Strikes"
    kind="strikes"
    head=${['n', 't / s', 'θ / rad', 'α / rad', 'w / (m/s)', 'ratio']}
    children=${n.map((one, at) => {
      const angles = [quantity(theta[at], 'rad'), quantity(alpha[at], 'rad')];
      return html`<${Row} cells=${[one, number(t[at], 5), ...angles, number(speed[at]), number(ratio[at])]} />`;
    })}
  />`;

/** @param {Answered} props */
export function Sheet({ answer, figure, path }) {
  const { demand, scene, candidates, notes, strikes } = answer;
  return html`<${Picture} name="catch" figure=${figure} read=${reader(answer)}
      label=${`Angle, height and place of the body, and tilt, height and speed of the table over time. ${headline(answer.outcome).join(': ')}.`}
      hint="With keys: left and right go through strikes and hold, page up and page down by a tenth." />
    <div class="catch-numbers">
      <${Numbers} id="catch-facts" rows=${facts(answer)} />
      <${Loads} label="What it asks of the table" kind="demands" values=${demand} limits=${scene.table?.limits ?? {}} />
      <${Candidates} all=${candidates} />
      <div id="catch-notes">
        ${notes.map((note) => html`<p class="muted small">${brief(capitalized(note))}.</p>`)}
      </div>
      <details><summary>Strikes</summary><${Strikes} strikes=${strikes} /></details>
      <p class="actions" id="catch-links"><${Savings} id="catch" title="Catch the body" path=${path} /></p>
    </div>`;
}

/**
 * Moments with the body and the table in them.
 * @param {Pick<Catch['hold'], 't' | 'theta' | 'x' | 'alpha'>} columns
 * @param {number[]} speeds of the table
 * @param {number[]} heights of the table
 * @param {(index: number) => string} words
 */
const moments = ({ t, theta, x, alpha }, speeds, heights, words) =>
  t.map((time, at) => ({
    t: time,
    words: words(at),
    theta: theta[at],
    x: x[at],
    alpha: alpha[at],
    speed: speeds[at],
    height: heights[at],
  }));

/** Reads a catch moment by moment. @param {Catch} answer @returns {(figure: SVGSVGElement) => import('../figures.js').Readable} */
const reader = (answer) => (figure) => {
  const { strikes, hold } = answer;
  const all = [
    ...moments(strikes, strikes.table_velocity, strikes.clearance, (index) => `strike ${strikes.n[index]}`),
    ...moments(hold, hold.table_y_dot, hold.table_y, () => 'in contact'),
  ];
  const columns = new FigureColumns(figure);
  return {
    nearest: (event) => {
      const time = columns.valueAt(event);
      if (time === null || all.length === 0) return null;
      const away = (/** @type {number} */ index) => Math.abs(all[index].t - time);
      return all.reduce((best, _, index) => (away(index) < away(best) ? index : best), 0);
    },
    moved: (key, at) => movedInRow(key, at, 0, all.length - 1),
    mark: (index) => columns.mark(index === null ? null : all[index].t),
    words: (index) => {
      const { t, words, theta, x, alpha, speed, height } = all[index];
      return [
        `t ${fixedQuantity(t, 's', 3)}`,
        words,
        `θ ${fixedQuantity(theta, 'rad', 4)}`,
        `x ${fixedQuantity(x, 'm', 4)}`,
        `α ${fixedQuantity(alpha, 'rad', 4)}`,
        `w ${fixedQuantity(speed, 'm/s', 4)}`,
        `table at ${fixedQuantity(height, 'm', 4)}`,
      ].join('   ');
    },
  };
};
