// The numbers that the paper prints for its cases, beside the computed ones.

import { sceneQuery } from '../api/scene-query.js';
import { quantity } from '../dom/numbers.js';
import { symbol } from '../dom/typeset.js';
import { html } from '../vendor/preact/preact.js';
import { Compared, Nodes, Sentence, Words } from './words.js';

/** @typedef {import('contract').Quantity} Quantity */
/** @typedef {import('contract').Preset} Preset */

/** True when the printed value is the computed one to the printed digits. @param {Quantity['value']} printed @param {Quantity['value']} computed */
function same(printed, computed) {
  if (printed === null || computed === null) return true;
  if (typeof printed === 'string' || typeof computed === 'string') return printed === computed;
  const decimals = (String(printed).split('.')[1] ?? '').length;
  return Math.abs(printed - computed) <= 0.5000001 * 10 ** -decimals;
}

/** @param {Quantity | undefined} value */
const shown = (value) =>
  typeof value?.value === 'string' ? value.value : quantity(value?.value, value?.unit ?? '', 5);

/** @param {{one: Preset, run: string}} props */
function Case({ one: { name, title, shows, printed, computed }, run }) {
  const rows = computed.map((value, index) => {
    const words = value.quantity.replaceAll(/[._]/g, ' ');
    const agrees = !value.why && same(printed[index]?.value ?? null, value.value);
    return {
      name: value.symbol
        ? html`<${Nodes} nodes=${[symbol(value.symbol)]} /> <span class="muted">${words}</span>`
        : words,
      printed: shown(printed[index]),
      computed: shown(value),
      agrees: printed[index]?.value == null ? null : agrees,
      why: value.why ?? null,
      where: [printed[index]?.where ?? '', value.where ?? ''],
    };
  });
  return html`<article id=${`case-${name}`} aria-labelledby=${`case-${name}-title`}>
    <h3 id=${`case-${name}-title`}><${Words} text=${title} /></h3>
    <p><${Sentence} text=${shows} /></p>
    ${rows.length > 0 ? html`<${Compared} label=${`Printed and computed values: ${title}`} rows=${rows} />` : html`<p class="muted">The paper prints no number for this case.</p>`}
    <p class="actions"><a href=${run} aria-label=${`Run it: ${title}`}>Run it</a></p>
  </article>`;
}

/** @type {import('./words.js').Load} */
export async function load({ fields, cases, chosen }) {
  const shown = chosen ? [chosen] : cases.filter(({ computed }) => computed.length > 0);
  return {
    contents: [],
    body: shown.map(
      (one) => html`<${Case} key=${one.name} one=${one} run=${`./?${sceneQuery(one.scene, one, fields)}`} />`,
    ),
  };
}
