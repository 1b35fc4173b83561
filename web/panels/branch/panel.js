// The panel of the orbits of period 2 about the critical gain: the server’s branch diagram and its changes.

import { Problem, wordsOf } from '../../api/client.js';
import { LatestRequest } from '../../api/latest-request.js';
import { marginOf } from '../../api/answers.js';
import { readFigure } from '../../charts/readable/server-figure.js';
import { debounce } from '../../dom/debounce.js';
import { explained, term } from '../../dom/glossary.js';
import { number, quantity } from '../../dom/numbers.js';
import { shownValue } from '../../dom/units.js';
import { html, render } from '../../vendor/preact/preact.js';
import { Savings, pictured } from '../figures.js';
import { Nodes, Row, Table, brief, words } from '../parts.js';

/** @typedef {import('contract').BranchChange} Change */

const GAIN = 'table.tilt_gain';
/** The part of the stable interval that is shown to each side of its end. */
const SHOWN = 0.4;
/** The orbit from which the branch is followed, rad: small, so that it is near κ_c. */
const BEGIN = 0.02;

/** The answer first, by the kind of the boundary. @type {Record<string, string>} */
const HEADLINES = {
  soft: 'Just beyond its largest tilt gain this body still holds on, in a small swing.',
  hard: 'Beyond its largest tilt gain nothing holds this body: it falls.',
  other: 'Where balance is lost, orbits of two bounces branch off.',
};
/** @type {Record<string, string>} */
const MEANINGS = {
  soft: 'They branch off beyond it and hold what falls: a {soft|soft boundary}',
  hard: 'They lie below it and are unstable, so what leaves upright is thrown out: a {hard|hard boundary}',
};

const SWING = ' that swing from side to side. ';

/** @type {import('../card.js').Module['mount']} */
export const mount = (root) => new Branch(root);

/** The reason why a scene has no such orbits, if it is known without a request. @param {import('contract').Stability} answer */
function reasonAgainst(answer) {
  const { below, above } = marginOf(answer, GAIN) ?? {};
  if ('point' in answer.scene.body) return 'A point mass has no angle to swing by.';
  if ((answer.scene.table.program?.length ?? 0) > 1)
    return 'These orbits have bounces of one height, and this body is juggled to several.';
  return below && above ? null : 'This scene has no critical gain, so nothing branches off there.';
}

class Branch {
  #root;
  #near = false;
  /** @type {import('../card.js').Judged | null} */
  #wanted = null;
  #shown = '';
  #latest = new LatestRequest();

  /** @param {HTMLElement} root */
  constructor(root) {
    this.#root = root;
    new IntersectionObserver(
      (entries) => {
        this.#near = entries.some(({ isIntersecting }) => isIntersecting);
        void this.#refresh();
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  /** @param {import('../card.js').Judged} judged */
  judged(judged) {
    this.#wanted = judged;
    this.#soon();
  }

  retell() {
    this.#shown = '';
    this.#soon();
  }

  #soon = debounce(300, () => void this.#refresh());

  async #refresh() {
    if (!this.#wanted || !this.#near) return;
    const { answer, scene } = this.#wanted;
    const against = reasonAgainst(answer);
    if (against) {
      this.#shown = '';
      this.#latest.cancel();
      return this.#say(against);
    }
    const critical = marginOf(answer, GAIN)?.above?.limit ?? 0;
    const span = SHOWN * (critical - (marginOf(answer, GAIN)?.below?.limit ?? 0));
    const [from, to] = [critical - span, critical + span].map((end) => Number(end.toPrecision(4)));
    const asked = { family: 'symmetric', theta: BEGIN, 'sweep.field': GAIN, 'sweep.from': from, 'sweep.to': to };
    const query = new URLSearchParams(scene);
    for (const [key, value] of Object.entries(asked)) query.set(key, String(value));
    const path = `v1/periodic-orbits?${query}`;
    if (path === this.#shown) return;
    this.#shown = path;
    const signal = this.#latest.next();
    try {
      const [orbits, figure] = await pictured(path, signal);
      this.#draw(path, figure, orbits.changes, answer.boundary, critical);
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof Problem && error.status < 500)
        return this.#say(`There is no branch to show: ${error.message}.`);
      const again = () => {
        this.#shown = '';
        void this.#refresh();
      };
      this.#say(wordsOf(error), html`<p><button type="button" onClick=${again}>Try again</button></p>`);
    }
  }

  /** @param {string} text @param {unknown} [more] */
  #say(text, more) {
    render(html`<p class="muted" role="status" key="told">${words(text)}</p>${more}`, this.#root);
  }

  /**
   * @param {string} path
   * @param {SVGSVGElement} figure
   * @param {Change[]} changes
   * @param {import('contract').Stability['boundary']} boundary
   * @param {number} critical
   */
  #draw(path, figure, changes, boundary, critical) {
    const kind = boundary?.kind ?? '';
    const birth = ` = ${number(critical, 5)} the upright bounce gives birth to `;
    const meaning = MEANINGS[kind] ? [...explained(MEANINGS[kind]), ` (C = ${number(boundary?.coefficient, 3)}).`] : [];
    const head = [
      'Change',
      html`<${Nodes} nodes=${[term('kappa')]} />`,
      'θ / rad',
      html`<${Nodes} nodes=${[term('residue')]} />`,
    ];
    render(
      html`<p class="answer" role="status" key="answer">
          <strong>${HEADLINES[kind] ?? HEADLINES.other}</strong>
          <${Nodes} nodes=${[' At ', term('kappa-critical'), birth, term('orbit', 'orbits'), SWING, ...meaning]} />
        </p>
        <${Nodes} tag="div" nodes=${[readable(figure, critical)]} />
        <details>
          <summary>Changes along the branch (${changes.length})</summary>
          <${Table} label="Changes along the branch" kind="changes" head=${head} children=${changes.map(rowOf)} />
        </details>
        <p class="actions" id="branch-links"><${Savings} id="branch" title="Orbits of period 2" path=${path} /></p>`,
      this.#root,
    );
  }
}

/** The diagram with its values by pointer and keys. @param {SVGSVGElement} figure @param {number} critical */
const readable = (figure, critical) =>
  readFigure(figure, {
    name: 'branch',
    label: `Branch diagram: largest angle of the orbits of period 2 against the tilt gain, about the critical gain ${number(critical)}. Its points of change are in the table.`,
    values: ['value', 'theta', 'stable'],
    words: ({ value, theta, stable }) =>
      `κ ${number(Number(value), 6)}   largest |θ| ${quantity(tiny(Number(theta)), 'rad')}   ${stable === 'true' ? 'stable' : 'unstable'}`,
    hint: 'With keys: left and right go along the branch, page up and page down by a tenth of it.',
  });

/** @param {Change} change */
const rowOf = ({ kind, value, theta, residue, detail }) =>
  html`<${Row}
    cells=${[[kind.replaceAll('_', ' '), html`<span class="muted">${brief(detail)}</span>`], number(value, 5), number(shownValue(tiny(theta), 'rad')), residue === null ? '–' : number(tiny(residue), 3)]}
  />`;

/** Zero for a value that is rounding. @param {number} value */
const tiny = (value) => (Math.abs(value) < 1e-9 ? 0 : value);
