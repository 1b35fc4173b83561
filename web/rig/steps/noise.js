// Step 6: how many of many runs last when the table errs at random.

import { html, useState } from '../../vendor/preact/preact.js';
import { RIG_PANELS } from '../panels.js';
import { PanelPlace, Step } from '../parts.js';

/** @param {{shared: import('../parts.js').Shared}} props */
export function Noise({ shared: { rig, page, dropped } }) {
  const [words, told] = useState('How many of many runs last when the table errs at random');
  return html`<${Step} n=${6} id="noise" title="Under noise" result=${{ tone: 'none', words }}>
    ${(/** @type {boolean} */ open) => html`<${PanelPlace} entry=${RIG_PANELS.survival} rig=${rig} page=${{ ...page, told }} dropped=${dropped} follows=${open} />`}
  <//>`;
}
