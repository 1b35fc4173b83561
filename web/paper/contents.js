// The chapters of the paper's page: its items, its cases, and the scenes on which usual methods fail.

import { get } from '../api/client.js';
import { sceneQuery } from '../api/scene-query.js';
import { here } from '../charts/readable/server-figure.js';
import { number, quantity } from '../dom/numbers.js';
import { symbol } from '../dom/typeset.js';
import { Nodes, words } from '../panels/parts.js';
import { html } from '../vendor/preact/preact.js';
import { useScan } from './scan.js';
import { Compared, Figure, Sentence } from './words.js';

/** @typedef {import('contract').PaperItem} PaperItem */
/** @typedef {import('contract').Quantity} Quantity */
/** @typedef {import('contract').Preset} Preset */
/** @typedef {import('contract').Failure} Failure */
/** @typedef {import('./words.js').Load} Load */

/** Ways on from a part: its run, and the request for it. @param {{title: string, run: string, ask?: string}} props */
const Ways = ({ title, run, ask }) => html`<p class="actions">
  <a href=${run} aria-label=${`Run it: ${title}`}>Run it</a>
  ${ask && html`<a href=${here(ask)} aria-label=${`Ask the server: ${title}`}>Ask the server</a>`}
</p>`;

/** Name of a quantity beside its symbol; none where it is a path. @param {string} name */
const named = (name) => (/^[a-z_]+\.[a-z_.]+$/.test(name) ? '' : html` <span class="muted">${name}</span>`);

/** @param {{item: PaperItem}} props */
function Checks({ item: { checks, place, title } }) {
  const rows = checks.map(({ quantity: name, symbol: sign, unit, printed, computed, agrees, why }) => ({
    name: html`<${Nodes} nodes=${[symbol(sign)]} />${named(name)}`,
    printed: printed === null ? 'in words' : quantity(printed, unit, 5),
    computed: quantity(computed, unit, 5),
    agrees,
    why,
  }));
  return rows.length > 0 && html`<${Compared} label=${`Printed and computed: ${place}, ${title}`} rows=${rows} />`;
}

/** The computed picture, and a place for the reader's own scan. @param {{item: PaperItem}} props */
function Pictures({ item: { kind, picture, place, title } }) {
  const { layer, element } = useScan(place, picture !== null);
  return html`<div class="pictures">
    ${picture && html`<${Figure} path=${here(picture)} label=${`Computed: ${title}`} over=${layer} />`}
    ${kind === 'figure' && html`<details><summary>Lay your scan beside it</summary>${element}</details>`}
  </div>`;
}

/** @param {{agrees: boolean}} props */
const Agreement = ({ agrees }) =>
  agrees ? html`<span class="chip same">agrees</span>` : html`<span class="chip differs">differs</span>`;

/** @param {{item: PaperItem, run: string}} props */
const Item = ({ item, run }) => html`<article id=${item.id} aria-labelledby=${`${item.id}-title`}>
  <h3 id=${`${item.id}-title`}>
    <a class="place" href=${`#${item.id}`}>${words(item.place)}</a> ${words(item.title)}
    ${item.checks.length > 0 && html`<${Agreement} agrees=${item.agrees} />`}
  </h3>
  <p class="printed">${words(item.printed)}</p>
  <${Checks} item=${item} />
  ${item.why && html`<p><${Sentence} text=${item.why} /></p>`}
  <${Pictures} item=${item} />
  <${Ways} title=${item.title} run=${run} ask=${item.ask} />
</article>`;

/** @param {string} section */
const anchor = (section) => `section-${section.toLowerCase().replace(/[^a-z0-9]+/g, '-')}`;

/** @type {Load} */
export async function items({ fields, cases }) {
  /** @type {{items: PaperItem[]}} */
  const { items: all } = await get('v1/paper');
  const sections = [...new Set(all.map(({ section }) => section))];
  const differ = all.filter(({ agrees }) => !agrees).length;
  const run = (/** @type {PaperItem} */ { scene }) => `./?${sceneQuery(scene, cases[0], fields)}`;
  return {
    contents: sections.map((section) => [anchor(section), section]),
    body: html`<p>${all.length} items. ${differ} differ from the print, each with the reason.</p>
      ${sections.map(
        (section) => html`<section aria-labelledby=${anchor(section)}>
          <h2 id=${anchor(section)}>${words(section)}</h2>
          ${all
            .filter((item) => item.section === section)
            .map((item) => html`<${Item} key=${item.id} item=${item} run=${run(item)} />`)}
        </section>`,
      )}`,
  };
}

/** @param {Quantity | undefined} value */
const told = (value) => quantity(value?.value, value?.unit ?? '', 5);

/** @param {{one: Preset, run: string}} props */
function PaperCase({ one: { name, title, shows, printed, computed }, run }) {
  const rows = computed.map((value, index) => {
    const words = value.quantity.replaceAll(/[._]/g, ' ');
    return {
      name: value.symbol
        ? html`<${Nodes} nodes=${[symbol(value.symbol)]} /> <span class="muted">${words}</span>`
        : words,
      printed: told(printed[index]),
      computed: told(value),
      // A value that differs from the printed one has a reason.
      agrees: printed[index]?.value == null ? null : !value.why,
      why: value.why ?? null,
      where: [printed[index]?.where ?? '', value.where ?? ''],
    };
  });
  return html`<article id=${`case-${name}`} aria-labelledby=${`case-${name}-title`}>
    <h3 id=${`case-${name}-title`}>${words(title)}</h3>
    <p><${Sentence} text=${shows} /></p>
    ${
      rows.length > 0
        ? html`<${Compared} label=${`Printed and computed values: ${title}`} rows=${rows} />`
        : html`<p class="muted">The paper prints no number for this case.</p>`
    }
    <${Ways} title=${title} run=${run} />
  </article>`;
}

/** @type {Load} */
export async function cases({ fields, cases: all, chosen }) {
  const shown = chosen ? [chosen] : all.filter(({ computed }) => computed.length > 0);
  return {
    contents: [],
    body: shown.map(
      (one) => html`<${PaperCase} key=${one.name} one=${one} run=${`./?${sceneQuery(one.scene, one, fields)}`} />`,
    ),
  };
}

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
    <span class="sign" aria-hidden="true">${right ? '✓' : '✗'}</span> ${words(method)}:${' '}
    <strong>${words(text)}</strong>${value === null ? '' : ` (${valued(value, unit)})`}${' '}
    <span class="chip">${right ? 'right' : 'wrong'}</span>
  </p>
  <p class="muted"><${Sentence} text=${detail} full /></p>
</li>`;

/** @param {{failure: Failure, run: string}} props */
const FailureCase = ({
  failure: { name, title, why, says, truth, ask, picture },
  run,
}) => html`<article id=${`failure-${name}`} aria-labelledby=${`failure-${name}-title`}>
  <h3 id=${`failure-${name}-title`}>${words(title)}</h3>
  <p class="truth"><strong>In truth: ${words(truth.text)}.</strong> <${Sentence} text=${truth.detail} full /></p>
  <ul class="says" aria-label="What each method says">
    ${says.map((one) => html`<${Claim} says=${one} />`)}
  </ul>
  <p><${Sentence} text=${why} full /></p>
  <a class="picture" href=${here(picture)}>
    <img src=${here(picture)} loading="lazy" width="720" height="542" alt=${`Picture: ${title}. It opens by itself.`} />
  </a>
  <${Ways} title=${title} run=${run} ask=${ask} />
</article>`;

/** @type {Load} */
export async function failures({ fields, cases }) {
  /** @type {{items: Failure[]}} */
  const { items: all } = await get('v1/failures');
  const run = (/** @type {Failure} */ { scene }) => `./?${sceneQuery(scene, cases[0], fields)}`;
  return {
    contents: [],
    body: all.map((failure) => html`<${FailureCase} key=${failure.name} failure=${failure} run=${run(failure)} />`),
  };
}
