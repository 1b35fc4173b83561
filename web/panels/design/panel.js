// The panel that designs a law α = −K·(x, θ, ẋ, θ̇) for the page's scene by chosen weights.

import { here, readCurves } from '../../charts/readable/server-figure.js';
import { number, quantity } from '../../dom/numbers.js';
import { html } from '../../vendor/preact/preact.js';
import { Answered, useAnswer } from '../ask.js';
import { Picture, Savings, pictured } from '../figures.js';
import { Term } from '../glossary.js';
import { Folded, NO_SCENE, Numbers, Row, Table, sentence, sign } from '../parts.js';
import { requestOf, useSettings } from '../settings.js';
import { GAINS } from '../verdict/facts.js';

/** @import { Eigenvalue, Controller } from 'contract' */

/** The usual weights of deviations. */
const WEIGHTS = { x: 1, theta: 10, x_dot: 0.1, theta_dot: 0.1 };

/** @param {string} letter @param {number} usual @param {string} key @param {boolean} [free] it may be 0 @returns {Setting} */
const weight = (letter, usual, key, free = true) => ({
  key,
  label: html`of ${sign(letter)}`,
  usual,
  right: (value) => value > 0 || (value === 0 && free),
  must: free ? 'a number from 0 on' : 'a number above 0',
});

/** @type {Record<string, Setting>} */
const SETTINGS = {
  ...Object.fromEntries(
    GAINS.map(([name, letter]) => [`weights.state.${name}`, weight(letter, WEIGHTS[name], `weights.${name}`)]),
  ),
  'weights.input': weight('α', 10, 'weights.input', false),
  contact: {
    label: 'Contact',
    usual: '',
    choices: { '': 'As the scene’s', frictionless: 'Frictionless', stick: 'Sticks' },
  },
};

/** @param {Eigenvalue | undefined} eigenvalue */
const complex = (eigenvalue) => {
  if (!eigenvalue) return '–';
  const { re, im } = eigenvalue;
  return im === 0 ? number(re) : `${number(re)} ${im < 0 ? '\u2212' : '+'} ${number(Math.abs(im))} i`;
};

/** @param {{page: PanelPage, open?: boolean}} props `open` while somebody sees it */
export function Design({ page, open = true }) {
  const { values, field } = useSettings(page, 'design', SETTINGS);
  const path = requestOf('v1/controllers', page.query, values);
  const asked = useAnswer(open ? path : null, { ask: pictured });
  return html`<div class="study stack">
    ${!asked.answer && html`<p>A tilt in proportion to the angle leaves the rod circling and drifting. A law that feeds back the whole state brings it to rest in place.</p>`}
    <fieldset class="study-settings row">
      <legend>Weights of squared deviations (<${Term} name="lqr" words="LQR" />)</legend>
      ${Object.keys(SETTINGS).map((name) => field(name))}
    </fieldset>
    ${path === null && html`<p role="status">${NO_SCENE}</p>`}
    <${Answered} asked=${asked} id="design-sheet">
      ${(/** @type {[Controller, SVGSVGElement]} */ found) => html`<${Law} found=${found} path=${asked.of} use=${asked.current && page.take} />`}
    <//>
  </div>`;
}

const readGains = readCurves(
  ['factor', 'modulus'],
  ({ factor, modulus }) => `gain × ${number(Number(factor))}   max |λ| ${number(Number(modulus), 5)}`,
);

/** @param {{found: [Controller, SVGSVGElement], path: string, use: false | PanelPage['take']}} props */
function Law({ found: [answer, figure], path, use }) {
  const { gain, eigenvalues, open_loop: free, spectral_radius: radius, bounces_per_decade: decade, regions } = answer;
  const [margin] = answer.margins;
  const sinks = answer.y_dot_change !== null;
  const rows = [
    ...GAINS.filter(([name]) => name in gain).map(([name, letter, unit]) => [
      sign(`K_${letter}`),
      quantity(gain[name], unit, 5),
      `gain of ${letter}`,
    ]),
    [html`<${Term} name="spectral-radius" />`, number(radius), 'largest factor per bounce'],
    ['decade', number(decade), 'bounces to a tenth'],
    [
      html`<${Term} name="gain-margin" words="margin" />`,
      margin ? `${number(margin.below?.limit)} to ${number(margin.above?.limit)}` : '–',
      'factors on the whole gain that still hold',
    ],
    ['contact', answer.contact, 'that the law is for'],
    [html`<${Term} name="riccati" words="residual" />`, number(answer.residual, 2), 'of the Riccati equation'],
  ];
  const region = (/** @type {string} */ name, /** @type {string | null | undefined} */ address) =>
    address && html`<a href=${`${here(address)}&format=svg`}>${name}</a>`;
  const [closed, open] = [eigenvalues, free];
  return html`<div class="study-sheet stack">
    <p class="row">
      ${use && html`<button type="button" id="design-run" class="primary" onClick=${() => use(answer.scene)}>Use this law</button>`}
      <span role="status">${answer.stable ? `Every small deviation that is fed back dies out${sinks ? ', but nothing holds the height' : ''}.` : 'This law does not hold: a small deviation grows.'}</span>
    </p>
    <${Picture} name="design" figure=${figure} read=${readGains}
      label=${`Eigenvalues of the closed loop on the unit circle, the largest ${number(radius)}; they are in the table. Beside them, the largest as the gain is scaled.`}
      hint="With keys: left and right scale the gain, page up and page down by a tenth of the way." />
    <div>
      <${Numbers} id="design-gains" rows=${rows} />
      ${
        (regions?.designed || regions?.proportional) &&
        html`<p class="actions" id="design-regions">What it survives: ${region('with the law', regions.designed)} ${region('with the tilt gain', regions.proportional)}</p>`
      }
      <${Folded} title="Eigenvalues">
        <${Table} label="Eigenvalues" kind="eigenvalues" head=${['λ of the closed loop', '|λ|', 'λ without a law', '|λ|']}>
          ${(closed.length > open.length ? closed : open).map((_, index) => html`<${Row} cells=${[closed, open].flatMap((all) => [complex(all[index]), number(all[index]?.modulus)])} />`)}
        <//>
      <//>
      ${answer.notes.length > 0 && html`<${Folded} title="Notes">${answer.notes.map((note) => html`<p class="muted small">${sentence(note)}</p>`)}<//>`}
      <p class="actions" id="design-links"><${Savings} id="design" title="Design a controller" path=${path} /></p>
    </div>
  </div>`;
}
