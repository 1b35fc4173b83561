// The panel of speed against accuracy: every method on the page's scene. It measures on request only, since that keeps a core busy.

import { movedInRow } from '../../charts/readable/chart-reader.js';
import { figureOf, pointsOf, readPoints } from '../../charts/readable/server-figure.js';
import { svg } from '../../charts/svg.js';
import { number, quantity } from '../../dom/numbers.js';
import { html, useEffect, useMemo, useState } from '../../vendor/preact/preact.js';
import { TaskButtons, TaskTold, useTask } from '../ask.js';
import { Picture, Savings } from '../figures.js';
import { Folded, Form, NO_SCENE, Row, Table, words } from '../parts.js';
import { useSettings, whole } from '../settings.js';

/** @import { Precision, PrecisionPoint as Point } from 'contract' */

const PROMISE =
  'Eleven methods with all their settings, one after the other: about three seconds, longer while the server has other work.';
const CHANGED = 'The scene has changed; measure again.';

/** @type {Record<string, string>} */
const AXES = { time: 'Clock time', evaluations: 'Evaluations', steps: 'Steps' };
const SETTINGS = {
  bounces: whole('Contacts', 100, 1000, 'impacts'),
  axis: { label: 'Across', usual: 'time', choices: AXES },
};
const HEAD = [
  'Method',
  'Setting',
  'ns/bounce',
  'quartiles',
  'steps',
  'evaluations',
  'error / m or m/s',
  'best',
  'outcome',
];

/** @param {Point} point @param {number | null} count */
const each = ({ outcome: { bounces } }, count) => (bounces > 0 && count !== null ? count / bounces : null);

/** @param {Point} point */
const setting = ({ setting: told }) => (told ? `${told.name} ${quantity(told.value, told.unit, 2)}` : '');

/** @param {Point} point */
const spread = ({ spread_ns_per_bounce: told }) => (told ? `${number(told[0])} to ${number(told[1])}` : '');

/** @typedef {{answer: Precision, pictures: Record<string, string>, request: string, scene: string}} Shown */

/** @param {{page: PanelPage}} props */
export function SpeedAgainstAccuracy({ page }) {
  const { values, field } = useSettings(page, 'precision', SETTINGS);
  const task = useTask('Measuring', 'parts');
  const [shown, show] = useState(/** @type {Shown | null} */ (null));
  const scene = String(page.query);
  const ask = async () => {
    if (!page.query) return task.say(NO_SCENE);
    const request = `${scene}&bounces=${values.bounces}`;
    const found = await task.ask(`v1/precision?${request}`);
    if (!found) return;
    show({ answer: found.end, pictures: found.pictures, request, scene });
    const { kind, bounces } = found.end.reference.outcome;
    task.say(`Measured over ${number(bounces)} bounces in ${number(task.took, 2)} s: ${kind.replaceAll('_', ' ')}.`);
  };
  useEffect(() => {
    if (task.active) task.stop(CHANGED);
    else task.say(shown ? CHANGED : PROMISE);
  }, [scene]);
  useEffect(() => {
    if (page.unattended) void ask();
  }, [page.unattended]);
  return html`<div class="study stack">
    <${Form} ask=${ask}>
      ${field('bounces')}${field('axis')}
      <${TaskButtons} name="precision" task=${task} start="Measure" />
      <${TaskTold} name="precision" task=${task} />
    <//>
    ${shown && html`<${Sheet} shown=${shown} axis=${values.axis} stale=${shown.scene !== scene} />`}
  </div>`;
}

/** @param {{shown: Shown, axis: string, stale: boolean}} props */
function Sheet({ shown: { answer, pictures, request }, axis, stale }) {
  const { methods, points, notes, reference } = answer;
  const title = (/** @type {string} */ name) => methods.find((method) => method.name === name)?.title ?? name;
  const { figure, places, drawn } = useMemo(() => {
    const picture = figureOf(pictures[axis]);
    const own = pointsOf(picture, ['point']);
    return { figure: picture, places: own, drawn: own.map(({ values }) => points[Number(values.point)]) };
  }, [pictures, axis]);
  const read = () => ({
    ...readPoints(figure, places, (index) => pointWords(drawn[index], title(drawn[index].method))),
    moved: (/** @type {string} */ key, /** @type {number | null} */ at) => moved(drawn, key, at),
  });
  /** A method's symbol, as the chart has it; empty for one that is not drawn. @param {string} method */
  const symbol = (method) => {
    const { x, y } = places[drawn.findIndex((point) => point.method === method)] ?? { x: 0, y: 0 };
    const mark = figure.querySelector(`[data-mark="${method}"]`)?.cloneNode(true);
    const box = `${x - 8} ${y - 8} 16 16`;
    return svg('svg', { class: 'figure', viewBox: box, 'aria-hidden': 'true' }, ...(mark ? [mark] : []));
  };
  const missing = (/** @type {string} */ name) => {
    const own = points.filter(({ method }) => method === name);
    if (own.some(({ error }) => error !== null)) return '';
    return name === 'extended' ? 'the reference' : `not drawn: ${own[0]?.reason ?? 'no run'}`;
  };
  const front =
    axis === 'steps'
      ? 'Steps of different methods are different work, so there is no front.'
      : 'Nothing lies below and left of the front.';
  return html`<div class=${`study-sheet stack precision-sheet ${stale ? 'stale' : ''}`}>
    <${Picture} name="precision" figure=${figure} read=${read}
      label=${`Speed against accuracy: error over ${AXES[axis].toLowerCase()}, ${drawn.length} points`}
      hint=${`${front} The dotted line is the rounding of one number. With keys: left and right go from point to point, up and down from method to method.`} />
    <${Folded} title="Methods">
      <ul class="methods" aria-label="Methods">
        ${methods.map(({ name, title: said, about }) => html`<li><span ref=${(/** @type {HTMLElement | null} */ place) => place?.replaceChildren(symbol(name))} /><span>${said}<span class="note">${words([about, missing(name)].filter(Boolean).join('; '))}</span></span></li>`)}
      </ul>
    <//>
    <${Folded} title="Numbers">
      <${Table} label="Numbers: speed against accuracy" head=${HEAD}>
        ${points.map((point) => html`<${Row} cells=${cellsOf(point, title(point.method))} />`)}
      <//>
    <//>
    <${Folded} title="How it was measured">
      <p class="muted">Errors are the largest of |ρδθ|, |δẋ|, |δẏ| and |ρδθ̇| just before bounce ${number(reference.outcome.bounces)}, from the run with 31 digits.</p>
      ${notes.map((note) => html`<p class="muted">${words(note)}</p>`)}
    <//>
    <p class="actions" id="precision-links">Measured anew as <${Savings} id="precision" title="Speed against accuracy" path=${`v1/precision?${request}&axis=${axis}`} /></p>
  </div>`;
}

/** @param {Point} point @param {string} title of its method */
function cellsOf(point, title) {
  const best = [point.pareto && 'time', point.pareto_evaluations && 'evaluations'].filter(Boolean).join(', ');
  return [
    title,
    setting(point),
    number(point.cost_ns_per_bounce),
    spread(point) || '–',
    number(point.steps, 7),
    number(point.evaluations, 9),
    number(point.error, 3),
    best,
    words(point.reason ?? point.outcome.kind),
  ];
}

/** @param {Point} point @param {string} title of its method */
function pointWords(point, title) {
  const quartiles = spread(point);
  return [
    title,
    setting(point),
    `${number(point.cost_ns_per_bounce)} ns a bounce${quartiles && ` (${quartiles})`}`,
    `${number(each(point, point.steps))} steps`,
    point.evaluations === null ? '' : `${number(each(point, point.evaluations))} evaluations`,
    `error ${number(point.error, 3)}`,
  ]
    .filter((part) => part)
    .join('   ');
}

/** The point that a key leads to: up and down go from method to method. @param {Point[]} drawn @param {string} key @param {number | null} at */
function moved(drawn, key, at) {
  const turns = [...drawn.keys()].filter((index) => drawn[index].method !== drawn[index - 1]?.method);
  const own = turns.findLast((index) => index <= (at ?? 0)) ?? 0;
  if (at !== null && key === 'ArrowDown') return turns.find((index) => index > at) ?? at;
  if (at !== null && key === 'ArrowUp') return turns.findLast((index) => index < own) ?? 0;
  const along = { ArrowDown: 'ArrowRight', ArrowUp: 'ArrowLeft' }[key] ?? key;
  return movedInRow(along, at, drawn.length);
}
