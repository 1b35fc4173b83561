// The panel that designs a law α = −K·(x, θ, ẋ, θ̇) for the page's scene by chosen weights.

import { here, readFigure } from '../../charts/readable/server-figure.js';
import { number, quantity } from '../../dom/numbers.js';
import { html, useMemo } from '../../vendor/preact/preact.js';
import { alone } from '../alone.js';
import { Answered, useAnswer } from '../ask.js';
import { Savings, Term, pictured } from '../figures.js';
import { Folded, NO_SCENE, Nodes, Numbers, Row, Table, sentence, sign } from '../parts.js';
import { requestOf, useSettings } from '../settings.js';

/** @typedef {import('contract').Eigenvalue} Eigenvalue */
/** @typedef {import('contract').Controller} Controller */

/** Time without a change before it is asked, ms. */
const QUIET_MS = 300;

/** Names of the state with symbol, usual weight, and unit of the gain. */
const STATES = /** @type {const} */ ([
  ['x', 'x', 1, 'rad/m'],
  ['theta', 'θ', 10, '1'],
  ['x_dot', 'ẋ', 0.1, 'rad·s/m'],
  ['theta_dot', 'θ̇', 0.1, 's'],
]);

/** @param {string} name @param {string} letter @param {number} usual @returns {import('../settings.js').Setting} */
const weight = (name, letter, usual) => ({
  key: `weights.${name}`,
  label: html`of ${sign(letter)}`,
  usual,
  right: (value) => value > 0 || (value === 0 && name !== 'input'),
  must: name === 'input' ? 'a number above 0' : 'a number from 0 on',
});

/** @type {Record<string, import('../settings.js').Setting>} */
const SETTINGS = {
  ...Object.fromEntries(STATES.map(([name, letter, usual]) => [name, weight(name, letter, usual)])),
  input: weight('input', 'α', 10),
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

/** @param {{page: import('../settings.js').Page, open?: boolean}} props `open` while somebody sees it */
export function Design({ page, open = true }) {
  const { values, field } = useSettings(page, 'design', SETTINGS);
  const weights = STATES.map(([name]) => [`weights.state.${name}`, values[name]]);
  const contact = values.contact && { contact: values.contact };
  const request = { ...Object.fromEntries(weights), 'weights.input': values.input, ...contact };
  const path = requestOf('v1/controllers', page.query, request);
  const asked = useAnswer(open ? path : null, QUIET_MS, pictured);
  return html`<div class="study">
    ${!asked.answer && html`<p>A tilt in proportion to the angle leaves the rod circling and drifting. A law that feeds back the whole state brings it to rest in place.</p>`}
    <fieldset class="study-settings">
      <legend>Weights of squared deviations (<${Term} name="lqr" words="LQR" />)</legend>
      ${Object.keys(SETTINGS).map(field)}
    </fieldset>
    ${path === null && html`<p role="status">${NO_SCENE}</p>`}
    <${Answered} asked=${asked} id="design-sheet">
      ${(/** @type {[Controller, SVGSVGElement]} */ found) => html`<${Law} found=${found} path=${asked.of} use=${asked.current && page.take} />`}
    <//>
  </div>`;
}

export const mount = alone('design', Design, SETTINGS);

/** @param {{found: [Controller, SVGSVGElement], path: string, use: false | import('../settings.js').Page['take']}} props */
function Law({ found: [answer, figure], path, use }) {
  const { gain, eigenvalues, open_loop: free, spectral_radius: radius, bounces_per_decade: decade, regions } = answer;
  const [margin] = answer.margins;
  const reader = useMemo(
    () =>
      readFigure(figure, {
        name: 'design',
        label: `Eigenvalues of the closed loop on the unit circle, the largest ${number(radius)}; they are in the table. Beside them, the largest as the gain is scaled.`,
        values: ['factor', 'modulus'],
        words: ({ factor, modulus }) => `gain × ${number(Number(factor))}   max |λ| ${number(Number(modulus), 5)}`,
        hint: 'With keys: left and right scale the gain, page up and page down by a tenth of the way.',
      }),
    [figure],
  );
  const rows = [
    ...STATES.filter(([name]) => name in gain).map(([name, letter, , unit]) => [
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
  return html`<div class="study-sheet">
    <p class="study-act">
      ${use && html`<button type="button" id="design-run" class="primary" onClick=${() => use(answer.scene)}>Use this law</button>`}
      <span role="status">${answer.stable ? 'Every small deviation that is fed back dies out.' : 'This law does not hold: a small deviation grows.'}</span>
    </p>
    <${Nodes} tag="div" nodes=${[reader]} />
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
