// The panel of the orbits of period 2 about the critical gain: the server’s branch diagram and its changes.

import { marginOf } from '../../api/answers.js';
import { readCurves } from '../../charts/readable/server-figure.js';
import { number, quantity } from '../../dom/numbers.js';
import { shownValue } from '../../dom/units.js';
import { html } from '../../vendor/preact/preact.js';
import { Answered, useAnswer } from '../ask.js';
import { Picture, Savings, pictured } from '../figures.js';
import { Term } from '../glossary.js';
import { Folded, Row, Table, brief, useNear } from '../parts.js';
import { requestOf } from '../settings.js';

/** @import { BranchChange as Change } from 'contract' */

const GAIN = 'table.tilt_gain';
/** The part of the stable interval that is shown to each side of its end. */
const SHOWN = 0.4;
/** The orbit from which the branch is followed, rad: small, so that it is near κ_c. */
const BEGIN = 0.02;
/** The answer first, by the kind of the boundary. @type {Record<string, string>} */
const HEADLINES = {
  soft: 'Just beyond its largest tilt gain this body still holds on, in a small swing.',
  hard: 'Beyond its largest tilt gain nothing holds this body: it falls.',
  other: 'Where balance is lost, orbits of two bounces branch off.',
};

/** Words on the boundary, by its kind. @type {Record<string, string>} */
const MEANINGS = {
  soft: 'They branch off beyond it and hold what falls',
  hard: 'They lie below it and are unstable, so what leaves upright is thrown out',
};

/** The reason why a scene has no such orbits, if it is known without a request. @param {Stability} answer */
function reasonAgainst(answer) {
  const { below, above } = marginOf(answer, GAIN) ?? {};
  if ('point' in answer.scene.body) return 'A point mass has no angle to swing by.';
  if ((answer.scene.table.program?.length ?? 0) > 1)
    return 'These orbits have bounces of one height, and this body is juggled to several.';
  return below && above ? null : 'This scene has no critical gain, so nothing branches off there.';
}

/** The request for the branch about the critical gain. @param {URLSearchParams | null} query @param {Stability} answer */
function branchOf(query, answer) {
  const { below, above } = marginOf(answer, GAIN) ?? {};
  const critical = above?.limit ?? 0;
  const span = SHOWN * (critical - (below?.limit ?? 0));
  const [from, to] = [critical - span, critical + span].map((end) => Number(end.toPrecision(4)));
  const sweep = { 'sweep.field': GAIN, 'sweep.from': from, 'sweep.to': to };
  return requestOf('v1/periodic-orbits', query, { family: 'symmetric', theta: BEGIN, ...sweep });
}

/** @param {{page: PanelPage}} props */
export function Branch({ page: { query } }) {
  const [place, near] = useNear();
  const verdict = useAnswer(near ? requestOf('v1/stability', query, {}) : null);
  /** @type {Stability | null} */
  const judged = verdict.current ? verdict.answer : null;
  const against = judged && reasonAgainst(judged);
  const asked = useAnswer(judged && !against ? branchOf(query, judged) : null, { quiet_ms: 0, ask: pictured });
  return html`<div class="study stack" ref=${place}>
    ${
      against
        ? html`<p class="muted" role="status">${against}</p>`
        : html`<${Answered} asked=${verdict}>${(/** @type {Stability} */ answer) => html`<${Answered} asked=${asked}>
            ${(/** @type {[import('contract').PeriodicOrbits, SVGSVGElement]} */ [orbits, figure]) => html`<${Diagram} changes=${orbits.changes} figure=${figure} answer=${answer} path=${asked.of} />`}
          <//>`}<//>`
    }
  </div>`;
}

/** @param {{changes: Change[], figure: SVGSVGElement, answer: Stability, path: string}} props */
function Diagram({ changes, figure, answer, path }) {
  const kind = answer.boundary?.kind ?? '';
  const critical = marginOf(answer, GAIN)?.above?.limit;
  const head = ['Change', html`<${Term} name="kappa" />`, 'θ / rad', html`<${Term} name="residue" />`];
  return html`<p class="answer" role="status">
      <strong>${HEADLINES[kind] ?? HEADLINES.other}</strong> At <${Term} name="kappa-critical" />${` = ${number(critical, 5)} the upright bounce gives birth to `}
      <${Term} name="orbit" words="orbits" /> that swing from side to side.
      ${MEANINGS[kind] && html` ${MEANINGS[kind]}: a <${Term} name=${kind} words=${`${kind} boundary`} />${` (C = ${number(answer.boundary?.coefficient, 3)}).`}`}
    </p>
    <${Picture} name="branch" figure=${figure} read=${readBranch}
      label=${`Branch diagram: largest angle of the orbits of period 2 against the tilt gain, about the critical gain ${number(critical)}. Its points of change are in the table.`}
      hint="With keys: left and right go along the branch, page up and page down by a tenth of it." />
    <${Folded} title=${`Changes along the branch (${changes.length})`}>
      <${Table} label="Changes along the branch" kind="changes" head=${head} children=${changes.map(rowOf)} />
    <//>
    <p class="actions" id="branch-links"><${Savings} id="branch" title="Orbits of period 2" path=${path} /></p>`;
}

const readBranch = readCurves(
  ['value', 'theta', 'stable'],
  ({ value, theta, stable }) =>
    `κ ${number(Number(value), 6)}   largest |θ| ${quantity(tiny(Number(theta)), 'rad')}   ${stable === 'true' ? 'stable' : 'unstable'}`,
);

/** @param {Change} change */
const rowOf = ({ kind, value, theta, residue, detail }) =>
  html`<${Row}
    cells=${[[kind.replaceAll('_', ' '), html`<span class="note">${brief(detail)}</span>`], number(value, 5), number(shownValue(tiny(theta), 'rad')), residue === null ? '–' : number(tiny(residue), 3)]}
  />`;

/** Zero for a value that is rounding. @param {number} value */
const tiny = (value) => (Math.abs(value) < 1e-9 ? 0 : value);
