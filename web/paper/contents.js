// The chapters of the paper's page: its items, its cases, and the scenes on which usual methods fail.

import { get } from '../api/client.js';
import { sceneQuery } from '../api/scene-query.js';
import { here } from '../charts/readable/server-figure.js';
import { number, quantity } from '../dom/numbers.js';
import { sentence, sign, words } from '../panels/parts.js';
import { html, useEffect } from '../vendor/preact/preact.js';
import { useScan } from './scan.js';
import { Compared, Figure } from './words.js';

/** @typedef {import('contract').PaperItem} PaperItem */
/** @typedef {import('contract').Quantity} Quantity */
/** @typedef {import('contract').Preset} Preset */
/** @typedef {import('contract').Failure} Failure */
/** @typedef {import('../panels/scene-page.js').ScenePage} ScenePage */

/**
 * A part with its ways on: its run, and the request for it.
 * @param {{id: string, title: string, heading?: unknown, run: string, ask?: string, children: unknown}} props
 */
const Article = ({ id, title, heading, run, ask, children }) => html`<article id=${id} aria-labelledby=${`${id}-title`}>
  <h3 id=${`${id}-title`}>${heading ?? words(title)}</h3>
  ${children}
  <p class="actions">
    <a href=${run} aria-label=${`Run it: ${title}`}>Run it</a>
    ${ask && html`<a href=${here(ask)} aria-label=${`Ask the server: ${title}`}>Ask the server</a>`}
  </p>
</article>`;

/** The run of a scene in the place of play. @param {PaperItem['scene'] | Failure['scene']} scene @param {ScenePage} page */
const runOf = (scene, { fields, cases: [usual] }) => `./?${sceneQuery(scene, usual, fields)}`;

/** Name of a quantity beside its symbol; none where it is a path. @param {string} name */
const named = (name) => (/^[a-z_]+\.[a-z_.]+$/.test(name) ? '' : html` <span class="muted">${name}</span>`);

/** @param {{item: PaperItem}} props */
function Checks({ item: { checks, place, title } }) {
  const rows = checks.map(({ quantity: name, symbol, unit, printed, computed, agrees, why }) => ({
    name: html`${sign(symbol)}${named(name)}`,
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

/** @param {{item: PaperItem, run: string}} props */
function Item({ item, run }) {
  const { id, place, title, printed, why, ask, checks, agrees } = item;
  const heading = html`<a class="place" href=${`#${id}`}>${words(place)}</a> ${words(title)}
    ${checks.length > 0 && html`<span class=${`chip ${agrees ? 'same' : 'differs'}`}>${agrees ? 'agrees' : 'differs'}</span>`}`;
  return html`<${Article} id=${id} title=${title} heading=${heading} run=${run} ask=${ask}>
    <p class="printed">${words(printed)}</p>
    <${Checks} item=${item} />
    ${why && html`<p>${sentence(why)}</p>`}
    <${Pictures} item=${item} />
  <//>`;
}

/** @param {string} section */
const anchor = (section) => `section-${section.toLowerCase().replace(/[^a-z0-9]+/g, '-')}`;

/** The items of the paper by their sections, which `listed` hears of as anchors and titles. */
export async function items() {
  /** @type {{items: PaperItem[]}} */
  const { items: all } = await get('v1/paper');
  const sections = [...new Set(all.map(({ section }) => section))];
  const differ = all.filter(({ agrees }) => !agrees).length;
  return (/** @type {{page: ScenePage, listed?: (sections: string[][]) => void}} */ { page, listed }) => {
    useEffect(() => listed?.(sections.map((section) => [anchor(section), section])), []);
    return html`<p>${all.length} items. ${differ} differ from the print, each with the reason.</p>
      ${sections.map(
        (section) => html`<section aria-labelledby=${anchor(section)}>
          <h2 id=${anchor(section)}>${words(section)}</h2>
          ${all
            .filter((item) => item.section === section)
            .map((item) => html`<${Item} key=${item.id} item=${item} run=${runOf(item.scene, page)} />`)}
        </section>`,
      )}`;
  };
}

/** @param {Quantity | undefined} value */
const told = (value) => quantity(value?.value, value?.unit ?? '', 5);

/** @param {{one: Preset, run: string}} props */
function PaperCase({ one: { name, title, shows, printed, computed }, run }) {
  const rows = computed.map((value, index) => {
    const words = value.quantity.replaceAll(/[._]/g, ' ');
    return {
      name: value.symbol ? html`${sign(value.symbol)} <span class="muted">${words}</span>` : words,
      printed: told(printed[index]),
      computed: told(value),
      // A value that differs from the printed one has a reason.
      agrees: printed[index]?.value == null ? null : !value.why,
      why: value.why ?? null,
      where: [printed[index]?.where ?? '', value.where ?? ''],
    };
  });
  return html`<${Article} id=${`case-${name}`} title=${title} run=${run}>
    <p>${sentence(shows)}</p>
    ${
      rows.length > 0
        ? html`<${Compared} label=${`Printed and computed values: ${title}`} rows=${rows} />`
        : html`<p class="muted">The paper prints no number for this case.</p>`
    }
  <//>`;
}

/** The case of the page, or `every` one. @param {{page: ScenePage, every?: boolean}} props */
export function PaperCases({ page: { fields, cases, chosen }, every }) {
  const shown = chosen && !every ? [chosen] : cases.filter(({ computed }) => computed.length > 0);
  return shown.map(
    (one) => html`<${PaperCase} key=${one.name} one=${one} run=${`./?${sceneQuery(one.scene, one, fields)}`} />`,
  );
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
  <p class="muted">${sentence(detail, words)}</p>
</li>`;

/** @param {{failure: Failure, run: string}} props */
const FailureCase = ({
  failure: { name, title, why, says, truth, ask, picture },
  run,
}) => html`<${Article} id=${`failure-${name}`} title=${title} run=${run} ask=${ask}>
  <p class="truth"><strong>In truth: ${words(truth.text)}.</strong> ${sentence(truth.detail, words)}</p>
  <ul class="says" aria-label="What each method says">
    ${says.map((one) => html`<${Claim} says=${one} />`)}
  </ul>
  <p>${sentence(why, words)}</p>
  <a class="picture" href=${here(picture)}>
    <img src=${here(picture)} loading="lazy" width="720" height="542" alt=${`Picture: ${title}. It opens by itself.`} />
  </a>
<//>`;

/** Scenes on which usual methods fail. */
export async function failures() {
  /** @type {{items: Failure[]}} */
  const { items: all } = await get('v1/failures');
  return (/** @type {{page: ScenePage}} */ { page }) =>
    all.map((one) => html`<${FailureCase} key=${one.name} failure=${one} run=${runOf(one.scene, page)} />`);
}
