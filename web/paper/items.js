// The paper item by item: what is printed, what is computed, why they differ, and a way to run it.

import { get } from '../api/client.js';
import { here } from '../charts/readable/server-figure.js';
import { sceneQuery } from '../api/scene-query.js';
import { quantity } from '../dom/numbers.js';
import { symbol } from '../dom/typeset.js';
import { html, useMemo } from '../vendor/preact/preact.js';
import { ScanPlace } from './scan.js';
import { Compared, Figure, Nodes, Sentence, Words } from './words.js';

/** @typedef {import('contract').PaperItem} PaperItem */

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
  const scan = useMemo(() => (kind === 'figure' ? new ScanPlace(place, picture !== null) : null), []);
  return html`<div class="pictures">
    ${picture && html`<${Figure} path=${here(picture)} label=${`Computed: ${title}`} over=${scan?.layer} />`}
    ${scan && html`<details><summary>Lay your scan beside it</summary><${Nodes} nodes=${[scan.element]} /></details>`}
  </div>`;
}

/** @param {{item: PaperItem, run: string}} props */
const Item = ({ item, run }) => html`<article id=${item.id} aria-labelledby=${`${item.id}-title`}>
  <h3 id=${`${item.id}-title`}>
    <a class="place" href=${`#${item.id}`}><${Words} text=${item.place} /></a> <${Words} text=${item.title} />
    ${item.checks.length > 0 && html`<span class=${`chip ${item.agrees ? 'same' : 'differs'}`}>${item.agrees ? 'agrees' : 'differs'}</span>`}
  </h3>
  <p class="printed"><${Words} text=${item.printed} /></p>
  <${Checks} item=${item} />
  ${item.why && html`<p><${Sentence} text=${item.why} /></p>`}
  <${Pictures} item=${item} />
  <p class="actions">
    <a href=${run} aria-label=${`Run it: ${item.title}`}>Run it</a>
    <a href=${here(item.ask)} aria-label=${`Ask the server: ${item.title}`}>Ask the server</a>
  </p>
</article>`;

/** @type {import('./words.js').Load} */
export async function load({ fields, cases }) {
  /** @type {{items: PaperItem[]}} */
  const { items } = await get('v1/paper');
  const sections = [...new Set(items.map(({ section }) => section))];
  const differ = items.filter(({ agrees }) => !agrees).length;
  const run = (/** @type {PaperItem} */ { scene }) => `./?${sceneQuery(scene, cases[0], fields)}`;
  return {
    contents: sections.map((section) => [anchor(section), section]),
    body: html`<p>${items.length} items. ${differ} differ from the print, each with the reason.</p>
      ${sections.map(
        (section) => html`<section aria-labelledby=${anchor(section)}>
          <h2 id=${anchor(section)}><${Words} text=${section} /></h2>
          ${items
            .filter((item) => item.section === section)
            .map((item) => html`<${Item} key=${item.id} item=${item} run=${run(item)} />`)}
        </section>`,
      )}`,
  };
}

/** @param {string} section */
const anchor = (section) => `section-${section.toLowerCase().replace(/[^a-z0-9]+/g, '-')}`;
