// Step 5: measured bounces, over the run of the rig's values, and what they tell of them.

import { number } from '../../dom/numbers.js';
import { measured } from '../../panels/measured/file.js';
import { html, render, useEffect, useState } from '../../vendor/preact/preact.js';
import { RIG_PANELS } from '../panels.js';
import { PanelPlace, Step } from '../parts.js';
import { Overlay } from './overlay.js';

/** The file in a line. @returns {NonNullable<import('../parts.js').Result>} */
function fileWords() {
  const { name, reading, refusal } = measured;
  if (reading) return { tone: 'none', words: `${name}: ${number(reading.impacts.length, 7)} bounces` };
  return { tone: 'none', words: refusal ? `${name}: ${refusal}` : 'Drop a CSV file anywhere on the page' };
}

/** @param {{shared: import('../parts.js').Shared}} props */
export function Measurements({ shared: { rig, page, dropped } }) {
  const [result, tell] = useState(fileWords());
  useEffect(() => measured.watch(() => tell(fileWords())), []);
  /** @type {import('../../panels/card.js').PanelPage} */
  const own = {
    ...page,
    told: (words, holds) =>
      tell({ tone: holds === null ? 'none' : holds ? 'stable' : 'unstable', words: `${measured.name}: ${words}` }),
  };
  // The file comes first, the run of it next, and the fit after both.
  const mounted = (/** @type {unknown} */ _, /** @type {HTMLElement} */ root) => {
    const place = document.createElement('div');
    root.querySelector('.fit-data')?.after(place);
    render(html`<${Overlay} rig=${rig} />`, place);
  };
  return html`<${Step} n=${5} id="measurements" title="Your measurements" result=${result}>
    <${PanelPlace} entry=${RIG_PANELS.fit} rig=${rig} page=${own} dropped=${dropped} mounted=${mounted} />
  <//>`;
}
