// Scenes on which a usual method is wrong: what each method says, what is true, and why.

import { get } from '../api/client.js';
import { here } from '../charts/readable/server-figure.js';
import { sceneQuery } from '../api/scene-query.js';
import { number, quantity } from '../dom/numbers.js';
import { html } from '../vendor/preact/preact.js';
import { Sentence, Words } from './words.js';

/** @typedef {import('contract').Failure} Failure */

/** So near to 1 that only the distance tells anything. @param {number} value */
const nearOne = (value) => value !== 1 && Math.abs(value - 1) < 1e-6;

/** @param {number} value @param {string | null} unit */
const valued = (value, unit) =>
  nearOne(value) && unit === null
    ? `1 ${value > 1 ? '+' : '\u2212'} ${number(Math.abs(value - 1), 3)}`
    : quantity(value, unit);

/** @param {{says: Failure['says'][number]}} props */
const Claim = ({ says: { method, text, value, unit, right, detail } }) => html`<li class=${right ? 'right' : 'wrong'}>
  <p>
    <span class="sign" aria-hidden="true">${right ? '✓' : '✗'}</span> <${Words} text=${method} />:${' '}
    <strong><${Words} text=${text} /></strong>${value === null ? '' : ` (${valued(value, unit)})`}${' '}
    <span class="chip">${right ? 'right' : 'wrong'}</span>
  </p>
  <p class="muted"><${Sentence} text=${detail} full /></p>
</li>`;

/** @param {{failure: Failure, run: string}} props */
const Case = ({
  failure: { name, title, why, says, truth, ask, picture },
  run,
}) => html`<article id=${`failure-${name}`} aria-labelledby=${`failure-${name}-title`}>
  <h3 id=${`failure-${name}-title`}><${Words} text=${title} /></h3>
  <p class="truth"><strong>In truth: <${Words} text=${truth.text} />.</strong> <${Sentence} text=${truth.detail} full /></p>
  <ul class="says" aria-label="What each method says">
    ${says.map((one) => html`<${Claim} says=${one} />`)}
  </ul>
  <p><${Sentence} text=${why} full /></p>
  <a class="picture" href=${here(picture)}>
    <img src=${here(picture)} loading="lazy" width="720" height="542" alt=${`Picture: ${title}. It opens by itself.`} />
  </a>
  <p class="actions">
    <a href=${run} aria-label=${`Run it: ${title}`}>Run it</a>
    <a href=${here(ask)} aria-label=${`Ask the server: ${title}`}>Ask the server</a>
  </p>
</article>`;

/** @type {import('./words.js').Load} */
export async function load({ fields, cases }) {
  /** @type {{items: Failure[]}} */
  const { items } = await get('v1/failures');
  const run = (/** @type {Failure} */ { scene }) => `./?${sceneQuery(scene, cases[0], fields)}`;
  return {
    contents: [],
    body: items.map((failure) => html`<${Case} key=${failure.name} failure=${failure} run=${run(failure)} />`),
  };
}
