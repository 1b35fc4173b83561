// The panel that catches the body of the page's scene, tells how in words, numbers and the server's picture, and catches, throws and juggles in the
// run under way.

import { catchIt, isHeld, juggle, lengthOf, throwIt } from '../../app/late/guide.js';
import { readColumns } from '../../charts/readable/server-figure.js';
import { fixedQuantity, number, quantity } from '../../dom/numbers.js';
import { capitalized } from '../../dom/typeset.js';
import { THROWN } from '../../physics/body.js';
import { html, useEffect, useLayoutEffect, useRef, useState } from '../../vendor/preact/preact.js';
import { useAnswer } from '../ask.js';
import { Loads, Picture, Savings, pictured } from '../figures.js';
import { Form, NO_SCENE, Numbers, Row, Table, brief, words } from '../parts.js';
import { otherFaults, refusalOf, requestOf, useSettings } from '../settings.js';
import { ENDINGS } from '../verdict/words.js';
import { CATCH, CatchFields, described, inUse, namesOf } from './settings.js';

/** @import { Catch, CatchOutcome as Outcome } from 'contract' */

/** Heights of throws in distances from contact point to centre of gravity, and the angle. */
const THROWS = { height: THROWN, theta: 0, low: 1.5, high: THROWN };
/** @typedef {keyof typeof THROWS} Throw */

/** @type {Record<string, Setting>} */
const SETTINGS = {
  ...CATCH,
  height: { label: 'to', unit: 'm' },
  theta: { label: 'at an angle of', unit: 'rad' },
  low: { label: 'to', unit: 'm' },
  high: { label: 'and in turn to', unit: 'm' },
};

/** The map of its reach: its two fields with their ends. */
const REACH = {
  'map.quantity': 'caught',
  ...{ 'map.x.parameter': 'release.theta', 'map.x.from': '-1', 'map.x.to': '1' },
  ...{ 'map.y.parameter': 'release.theta_dot', 'map.y.from': '-8', 'map.y.to': '8' },
};

const PROMISE =
  'After a release of this scene, the table brings the body to rest and keeps it upright in lasting contact.';

/** @param {{page: PanelPage}} props */
export function CatchBody({ page }) {
  const { play, query } = page;
  const [wanted, want] = useState(/** @type {string | null} */ (null));
  const asked = useAnswer(wanted, { quiet_ms: 0, ask: pictured });
  /** Refusals of what the run under way was asked for. */
  const [refused, refuse] = useState(/** @type {ProblemError[]} */ ([]));
  const root = useRef(/** @type {HTMLElement | null} */ (null));
  const { answer, of, problem, lost, current } = asked;
  const { values, field } = useSettings(page, 'catch', SETTINGS, [...(problem?.errors ?? []), ...refused]);
  const used = inUse(values);
  const path = requestOf('v1/catches', query, used);
  const catchIt = () => {
    refuse([]);
    want(path);
  };
  useEffect(() => {
    if (page.unattended) want(path);
  }, []);
  useLayoutEffect(() => {
    /** @type {HTMLElement | null | undefined} */ (root.current?.querySelector('[aria-invalid=true]'))?.focus();
  }, [problem, refused]);
  const fresh = current && wanted === path;
  const told =
    (path === null && NO_SCENE) ||
    lost ||
    (problem && refusalOf(problem, namesOf(values))) ||
    (answer ? 'The scene or the settings have changed since; catch anew.' : PROMISE);
  const shown = answer && !lost && !problem && { answer: answer[0], figure: answer[1], path: of };
  const reach = () => {
    const own = Object.entries(used).map(([name, value]) => [`map.catch.${name}`, String(value)]);
    page.open?.('map', new URLSearchParams([...Object.entries(REACH), ...own]));
  };
  return html`<div class="study stack" ref=${root}>
    <${Form} kind="" ask=${catchIt}>
      <div class="row">
        <button type="submit" id="catch-start" class="primary">Catch</button>
        <div class="study-told" id="catch-told" role="status">
          ${fresh ? html`<${Told} ...${shown} />` : html`<p>${words(told)}</p>`}
        </div>
      </div>
      <${CatchFields} values=${values} field=${field} />
    <//>
    <div class=${`study-sheet stack ${fresh ? '' : 'stale'}`} id="catch-sheet" hidden=${!shown}>
      ${shown && html`<${Sheet} ...${shown} />`}
    </div>
    ${play && html`<${UnderWay} play=${play} values=${values} field=${field} refused=${refused} refuse=${refuse} />`}
    <p class="study-row row">
      <button type="button" id="catch-reach" onClick=${reach}>Map its reach</button>
      <span>Which releases the table catches, over angle and spin: a catch in every cell.</span>
    </p>
  </div>`;
}

/**
 * The run under way: catch it, throw it, juggle it.
 * @param {object} props
 * @param {Page} props.play
 * @param {Record<string, any>} props.values
 * @param {(name: string, hint?: string) => unknown} props.field
 * @param {ProblemError[]} props.refused
 * @param {(errors: ProblemError[]) => void} props.refuse
 */
function UnderWay({ play, values, field, refused, refuse }) {
  const { run } = play;
  const now = () => ({ live: run.active, held: isHeld(play), length: lengthOf(play) });
  const [, tell] = useState('');
  useEffect(() => {
    const changed = () => tell(JSON.stringify(now()));
    run.watch({
      changed,
      struck: changed,
      problem: ({ title, detail, errors }) => {
        if (!play.guidedByPanel || !run.guided) return;
        refuse(errors.length > 0 ? errors : [{ pointer: '', detail: detail || title }]);
      },
    });
  }, []);
  const { live, held, length } = now();
  const usual = (/** @type {Throw} */ name) => Number((THROWS[name] * length).toPrecision(2));
  const value = (/** @type {Throw} */ name) => values[name] ?? usual(name);
  const thrown = (/** @type {Throw} */ name) => field(name, String(usual(name)));
  const act = (/** @type {() => void} */ send) => () => {
    refuse([]);
    send();
  };
  const catchRun = act(() => catchIt(play, inUse(values)));
  const throwRun = act(() => throwIt(play, { height: value('height'), theta: value('theta') }));
  const juggleRun = act(() => juggle(play, [value('low'), value('high')]));
  const said = held ? 'The table holds the body. A throw goes on from there.' : 'Acts from the next strike on.';
  return html`<fieldset class="catch-live">
    <legend>The run under way</legend>
    <p class="study-row row">
      <button type="button" id="catch-run" disabled=${!live || held} onClick=${catchRun}>Catch this run</button>
      <span id="catch-live-told" role="status">${live || held ? said : 'No run is under way.'}</span>
    </p>
    <div class="study-row row">
      <button type="button" id="catch-throw" disabled=${!live} onClick=${throwRun}>Throw</button>
      ${thrown('height')} ${thrown('theta')}
    </div>
    <div class="study-row row">
      <button type="button" id="catch-juggle" disabled=${!live} onClick=${juggleRun}>Juggle</button>
      ${thrown('low')} ${thrown('high')}
    </div>
    <p class="error" id="catch-live-error" role="status">${otherFaults(refused, namesOf(values))}</p>
  </fieldset>`;
}

// The answer in words, numbers, tables and the server's picture, moment by moment through strikes and hold.

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
  // This is the end of a run, but one way not to catch of a catch.
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
  html`<${Table} label="Strategies compared" kind="candidates"
    head=${['strategy', 'verdict', 'contact from', 'tilt', 'speed', 'stroke']}
    children=${all.map((one) => {
      const { tilt, speed, stroke } = one.demand;
      const numbers = [quantity(one.contact_from, 's', 3), quantity(tilt, 'rad', 3), quantity(speed, 'm/s', 3)];
      return html`<${Row} cells=${[described(one), judged(one), ...numbers, quantity(stroke, 'm', 3)]} />`;
    })}
  />`;

/** Each strike with its numbers. @param {{strikes: Catch['strikes']}} props */
const Strikes = ({ strikes: { n, t, theta, alpha, table_velocity: speed, ratio } }) =>
  html`<${Table} label="Strikes" kind="strikes" head=${['n', 't / s', 'θ / rad', 'α / rad', 'w / (m/s)', 'ratio']}
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
    <div class="stack">
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

/** Reads a catch moment by moment, through strikes and hold. @param {Catch} answer @returns {(figure: SVGSVGElement) => Readable} */
const reader =
  ({ strikes, hold }) =>
  (figure) => {
    const striking = [strikes.t, strikes.theta, strikes.x, strikes.alpha, strikes.table_velocity, strikes.clearance];
    const held = [hold.t, hold.theta, hold.x, hold.alpha, hold.table_y_dot, hold.table_y];
    const before = strikes.n.length;
    return readColumns(figure, [...strikes.t, ...hold.t], (item) => {
      const isStrike = item < before;
      const at = isStrike ? item : item - before;
      const [t, theta, x, alpha, speed, height] = (isStrike ? striking : held).map((column) => column[at]);
      return [
        `t ${fixedQuantity(t, 's', 3)}`,
        isStrike ? `strike ${strikes.n[at]}` : 'in contact',
        `θ ${fixedQuantity(theta, 'rad', 4)}`,
        `x ${fixedQuantity(x, 'm', 4)}`,
        `α ${fixedQuantity(alpha, 'rad', 4)}`,
        `w ${fixedQuantity(speed, 'm/s', 4)}`,
        `table at ${fixedQuantity(height, 'm', 4)}`,
      ].join('   ');
    });
  };
