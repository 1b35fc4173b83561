// The verdict in words with the numbers that carry it. Not for asking the server.

import { h, prose, symbol } from '../../dom/dom.js';
import { number, quantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Stability} Stability */

/** What is beyond the linear map, once its code is there: nothing of the first look. @type {typeof import('./evidence.js').evidence | null} */
let evidence = null;

/** @type {Record<string, string>} */
const DECIDERS = {
  linear: 'the linear map',
  nonlinear: 'the run',
  boundary: 'the boundary',
  lyapunov: 'the third order',
};

/** How sure, in a sign that does not need its colour. @param {string | null} verdict */
function kind(verdict) {
  if (verdict === null) return 'none';
  if (verdict.startsWith('unstable') || /this run ended/.test(verdict)) return 'unstable';
  return /^(bounded|weakly unstable)/.test(verdict) ? 'beyond' : 'stable';
}

const SIGNS = { none: '–', unstable: '▲', beyond: '◆', stable: '●' };

export class Verdict {
  #root;
  /** @type {Stability | null} */
  #newest = null;
  // Only the words are spoken, not the table of numbers at every turn of a knob.
  #spoken = h('p', { class: 'unseen', role: 'status' });

  /** @param {HTMLElement} root */
  constructor(root) {
    this.#root = root;
    this.#root.before(this.#spoken);
    this.#root.append(h('p', { class: 'muted' }, 'Waiting for the server…'));
  }

  /** What is shown is about to be replaced. @param {boolean} busy */
  busy(busy) {
    this.#root.setAttribute('aria-busy', String(busy));
  }

  /** @param {string} words @param {() => void} [retry] */
  fail(words, retry) {
    this.busy(false);
    this.#newest = null;
    this.#spoken.textContent = `No verdict. ${words}`;
    this.#root.replaceChildren(
      h('p', { class: 'verdict-words none' }, h('span', { class: 'sign', 'aria-hidden': 'true' }, '–'), ' No verdict'),
      h('p', { class: 'muted' }, words),
      retry ? h('button', { type: 'button', click: retry }, 'Try again') : '',
    );
  }

  /** @param {Stability} answer @param {() => Promise<Stability>} measureBasin */
  show(answer, measureBasin) {
    this.busy(false);
    this.#newest = answer;
    if (!evidence) {
      void import('./evidence.js').then(
        (module) => {
          evidence = module.evidence;
          if (this.#newest === answer) this.show(answer, measureBasin);
        },
        () => null,
      );
    }
    const {
      verdict,
      decided_by: decider,
      reason,
      agree,
      linear,
      boundary,
      lyapunov,
      loss_of_stability: losses,
      nonlinear,
      drift_speed: drift,
      notes,
    } = answer;
    const manner = kind(verdict);
    const words = verdict === null ? 'No verdict' : verdict[0].toUpperCase() + verdict.slice(1);
    this.#spoken.textContent = `Verdict: ${words}`;
    /** @type {[Node | string, string | Node, string?][]} */
    const rows = [];
    const gain = linear?.tilt_gain;
    if (gain) {
      rows.push([symbol('κ'), number(gain.value), 'tilt gain']);
      if (gain.critical != null) rows.push([symbol('κ_c'), number(gain.critical, 5), 'critical gain']);
      if (gain.margin_above != null)
        rows.push([
          'margin',
          `${number(gain.margin_below, 3)} · ${number(gain.margin_above, 3)}`,
          'to lower · upper end',
        ]);
    }
    if (linear?.residue != null) rows.push([symbol('R'), number(linear.residue), `residue: ${linear.class}`]);
    if (linear?.rotation != null)
      rows.push([
        symbol('σ'),
        `${quantity(linear.rotation, 'rad')} (${quantity((linear.rotation * 180) / Math.PI, '°')})`,
        'rotation a bounce',
      ]);
    if (linear?.spectral_radius != null) rows.push(['max |λ|', number(linear.spectral_radius, 5), 'spectral radius']);
    const energy = linear?.energy_gain;
    if (energy && energy.value !== 0)
      rows.push([
        symbol('κ_E'),
        `${quantity(energy.value, 's²/m²')} of ${number(energy.upper)}`,
        `energy gain: λ ${number(energy.eigenvalue)}`,
      ]);
    if (boundary?.coefficient != null)
      rows.push([symbol('C'), number(boundary.coefficient, 3), `boundary: ${boundary.kind}`]);
    if (lyapunov) {
      const escape = lyapunov.escape_impacts;
      rows.push([
        symbol('ℓ'),
        quantity(lyapunov.coefficient, '/rad²', 3),
        `swing: ${lyapunov.kind}${escape === null ? '' : `, leaves in about ${number(escape, 3)} impacts`}`,
      ]);
    }
    for (const { parameter, value, kind: manner, swing, heights } of losses ?? []) {
      if (parameter === 'table.tilt_gain') continue;
      const settles =
        swing !== null
          ? `, here to ±${quantity(swing, 'rad', 3)}`
          : heights
            ? `, here to ${heights.map((height) => quantity(height, 'm', 3)).join(' and ')} in turn`
            : '';
      const name =
        parameter === 'table.feedback' ? ['gains ×', number(value, 4)] : [symbol('κ_E'), quantity(value, 's²/m²', 4)];
      rows.push([name[0], name[1], `stability is lost there: ${manner}${settles}`]);
    }
    if (drift != null) rows.push([symbol('c'), quantity(drift, 'm/s', 3), 'drift of the whole']);
    if (nonlinear)
      rows.push([
        'max |θ|',
        quantity(nonlinear.max_theta, 'rad'),
        `${number(nonlinear.impacts, 6)} impacts: ${nonlinear.outcome}`,
      ]);
    const asked = nonlinear?.demand;
    if (asked) {
      rows.push([
        'tilt',
        `${quantity(asked.tilt, 'rad', 3)} · ${quantity(asked.tilt_rate, 'rad/s', 3)}`,
        'most tilt · tilt rate asked',
      ]);
      if (asked.speed > 0 || asked.stroke > 0)
        rows.push([
          'stroke',
          `${quantity(asked.stroke, 'm', 3)} · ${quantity(asked.speed, 'm/s', 3)}`,
          'most stroke · speed asked',
        ]);
    }
    const open = [...this.#root.querySelectorAll('details[open]')].map(({ className }) => className);
    this.#root.replaceChildren(
      h(
        'p',
        { class: `verdict-words ${manner}` },
        h('span', { class: 'sign', 'aria-hidden': 'true' }, SIGNS[manner]),
        ` ${words}`,
      ),
      reason ? h('p', { class: 'reason' }, ...prose(reason[0].toUpperCase() + reason.slice(1))) : '',
      h(
        'p',
        { class: 'chips' },
        decider ? h('span', { class: 'chip' }, `decided by ${DECIDERS[decider] ?? decider}`) : '',
        agree === null
          ? ''
          : h(
              'span',
              { class: `chip ${agree ? '' : 'caution'}` },
              agree ? 'linear map and run agree' : 'linear map and run disagree',
            ),
      ),
      h(
        'dl',
        { class: 'numbers' },
        ...rows.map(([name, value, meaning]) =>
          h('div', {}, h('dt', {}, name), h('dd', {}, value), h('dd', { class: 'muted' }, meaning ?? '')),
        ),
      ),
      evidence?.(answer, measureBasin) ?? '',
      h(
        'details',
        { class: 'model' },
        h('summary', {}, `Model: ${answer.model.name.replaceAll('_', ' ')}`),
        h('p', { class: 'muted' }, ...prose(answer.model.reason)),
        ...notes.map((note) => h('p', { class: 'muted' }, ...prose(note))),
      ),
    );
    // What somebody opened stays open while the numbers in it change.
    for (const details of this.#root.querySelectorAll('details')) details.open = open.includes(details.className);
  }
}
