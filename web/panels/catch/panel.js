// The panel that catches the body of the page's scene, tells how, and catches, throws and juggles in the run under way.

import { THROWN } from '../../physics/body.js';
import { html, useEffect, useLayoutEffect, useRef, useState } from '../../vendor/preact/preact.js';
import { useAnswer } from '../ask.js';
import { pictured } from '../figures.js';
import { Form, NO_SCENE, words } from '../parts.js';
import { otherFaults, refusalOf, requestOf, useSettings } from '../settings.js';
import { Sheet, Told } from './answer.js';
import { CATCH, CatchFields, inUse, namesOf } from './settings.js';

/** @typedef {import('contract').ProblemError} ProblemError */

/** Heights of throws in distances from contact point to centre of gravity, and the angle. */
const THROWS = { height: THROWN, theta: 0, low: 1.5, high: THROWN };
/** @typedef {keyof typeof THROWS} Throw */

/** @type {Record<string, import('../settings.js').Setting>} */
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

/** @param {{page: import('../settings.js').Page}} props */
export function CatchBody({ page }) {
  const { guide, query } = page;
  const [wanted, want] = useState(/** @type {string | null} */ (null));
  const asked = useAnswer(wanted, 0, pictured);
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
  return html`<div class="study" ref=${root}>
    <${Form} kind="" ask=${catchIt}>
      <div class="study-act">
        <button type="submit" id="catch-start" class="primary">Catch</button>
        <div class="study-told" id="catch-told" role="status">
          ${fresh ? html`<${Told} ...${shown} />` : html`<p>${words(told)}</p>`}
        </div>
      </div>
      <${CatchFields} values=${values} field=${field} />
    <//>
    <div class=${`study-sheet ${fresh ? '' : 'stale'}`} id="catch-sheet" hidden=${!shown}>
      ${shown && html`<${Sheet} ...${shown} />`}
    </div>
    ${guide && html`<${UnderWay} guide=${guide} values=${values} field=${field} refused=${refused} refuse=${refuse} />`}
    <p class="study-row">
      <button type="button" id="catch-reach" onClick=${reach}>Map its reach</button>
      <span>Which releases the table catches, over angle and spin: a catch in every cell.</span>
    </p>
  </div>`;
}

/**
 * The run under way: catch it, throw it, juggle it.
 * @param {object} props
 * @param {import('../settings.js').Guide} props.guide
 * @param {Record<string, any>} props.values
 * @param {(name: string, hint?: string) => unknown} props.field
 * @param {ProblemError[]} props.refused
 * @param {(errors: ProblemError[]) => void} props.refuse
 */
function UnderWay({ guide, values, field, refused, refuse }) {
  const now = () => ({ live: guide.live(), held: guide.held(), length: guide.length() });
  const [, tell] = useState('');
  useEffect(
    () =>
      guide.watch({
        changed: () => tell(JSON.stringify(now())),
        problem: ({ title, detail, errors }) =>
          refuse(errors.length > 0 ? errors : [{ pointer: '', detail: detail || title }]),
      }),
    [],
  );
  const { live, held, length } = now();
  const usual = (/** @type {Throw} */ name) => Number((THROWS[name] * length).toPrecision(2));
  const value = (/** @type {Throw} */ name) => values[name] ?? usual(name);
  const thrown = (/** @type {Throw} */ name) => field(name, String(usual(name)));
  const act = (/** @type {() => void} */ send) => () => {
    refuse([]);
    send();
  };
  const catchIt = act(() => guide.catchIt(inUse(values)));
  const throwIt = act(() => guide.throwIt({ height: value('height'), theta: value('theta') }));
  const juggle = act(() => guide.juggle([value('low'), value('high')]));
  const said = held ? 'The table holds the body. A throw goes on from there.' : 'Acts from the next strike on.';
  return html`<fieldset class="catch-live">
    <legend>The run under way</legend>
    <p class="study-row">
      <button type="button" id="catch-run" disabled=${!live || held} onClick=${catchIt}>Catch this run</button>
      <span id="catch-live-told" role="status">${live || held ? said : 'No run is under way.'}</span>
    </p>
    <div class="study-row">
      <button type="button" id="catch-throw" disabled=${!live} onClick=${throwIt}>Throw</button>
      ${thrown('height')} ${thrown('theta')}
    </div>
    <div class="study-row">
      <button type="button" id="catch-juggle" disabled=${!live} onClick=${juggle}>Juggle</button>
      ${thrown('low')} ${thrown('high')}
    </div>
    <p class="error" id="catch-live-error" role="status">${otherFaults(refused, namesOf(values))}</p>
  </fieldset>`;
}
