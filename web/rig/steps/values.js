// Step 1: the values of the rig. Those that a lab knows first stand open, all others behind a search.

import { Form } from '../../form/form.js';
import { quantity } from '../../dom/numbers.js';
import { html, useEffect, useMemo, useRef } from '../../vendor/preact/preact.js';
import { Cases } from '../../panels/scene-page.js';
import { Step } from '../parts.js';
import { Drawing } from './drawing.js';

/** @typedef {import('../rig.js').Rig} Rig */

/** Fields that a lab knows first. */
const FIRST = [
  'body.contact_distance',
  'body.radius_of_gyration',
  'contact.restitution',
  'contact.friction',
  'table.tilt_gain',
  'release.theta',
  'release.height',
];

/** @param {import('../../api/scene-fields.js').Scene} scene */
const slides = ({ table }) => table?.slide === 'matched';

/** The rig in a line. @param {Rig} rig */
function summary({ scene, chosen }) {
  const { body = {}, contact = {}, table = {} } = scene;
  const parts = [
    body.point ? 'a point mass' : body.vertices ? 'a polygon' : `l ${quantity(body.contact_distance, 'm', 3)}`,
    `e ${quantity(contact.restitution ?? 1, '1', 3)}`,
    `μ ${quantity(contact.friction ?? 0, '1', 3)}`,
    table.feedback ? 'state feedback' : `κ ${quantity(table.tilt_gain, '1', 4)}`,
    ...(slides(scene) ? ['a table that slides along'] : []),
  ];
  return `${chosen ? `${chosen.title}: ` : ''}${parts.join(', ')}`;
}

/** @param {{rig: Rig, verdict: import('../../panels/ask.js').Answer<import('contract').Stability>}} props */
export function Values({ rig, verdict }) {
  const first = useRef(/** @type {HTMLElement | null} */ (null));
  const more = useRef(/** @type {HTMLElement | null} */ (null));
  /** @type {{current: Form | null}} */
  const made = useRef(null);
  const typed = useMemo(() => ({ own: false }), []);
  useEffect(() => {
    if (!first.current || !more.current) return;
    const form = new Form(
      more.current,
      rig.fields,
      (_, final) => {
        const complete = form.typed.complete !== null;
        typed.own = true;
        rig.type(form.typed.typed ?? {}, complete);
        typed.own = false;
        if (!complete) form.complain();
        // The address keeps what was before a drag until it ends.
        if (complete && final) rig.keep(true);
      },
      { first: FIRST, into: first.current },
    );
    first.current.addEventListener('submit', (event) => event.preventDefault());
    made.current = form;
    const fill = () => {
      form.compare(rig.chosen?.scene ?? null);
      if (!typed.own) form.typed.fill(rig.scene);
    };
    fill();
    rig.addEventListener('change', fill);
  }, []);
  const { problem } = verdict;
  useEffect(() => {
    made.current?.blame(problem?.errors ?? []);
  }, [problem]);
  return html`<${Step} n=${1} id="values" title="Your values" open result=${{ tone: 'none', words: summary(rig) }}>
    <${Cases} page=${rig} id="case" label="Begin with" own="values of your own" />
    <div class="values">
      <form class="rig-first" ref=${first} novalidate aria-label="Values that a lab knows first" />
      <${Drawing} scene=${rig.scene} derived=${verdict.answer?.derived ?? rig.chosen?.derived ?? null} />
    </div>
    ${rig.scene.table?.feedback && html`<p class="muted">A state feedback tilts its table, not a tilt gain. Its gains are below, and in step 4.</p>`}
    ${slides(rig.scene) && html`<p class="muted">The table slides along with the foot; the choice is below, under More. <button type="button" onClick=${() => rig.take(rig.with({ 'table.slide': null }))}>Let it stand</button></p>`}
    <details class="more">
      <summary>More: gravity, air, limits and errors of the table, noise</summary>
      <form id="parameters" ref=${more} novalidate aria-label="All other values" />
    </details>
  <//>`;
}
