// The panel of the orbits of period 2 about the critical gain: the server’s branch diagram and its changes.

import { readFigure, serverFigure } from '../../charts/readable/server-figure.js';
import { row, table } from '../../dom/tables.js';
import { LatestRequest } from '../../api/latest-request.js';
import { Problem, get, wordsOf } from '../../api/client.js';
import { marginOf } from '../../api/margins.js';
import { actions } from '../../export/save-actions.js';
import { h, retryButton } from '../../dom/elements.js';
import { explained, term } from '../../dom/glossary.js';
import { marked, prose } from '../../dom/typeset.js';
import { shownUnit, shownValue } from '../../dom/units.js';
import { debounce } from '../../dom/debounce.js';
import { number, quantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Stability} Stability */
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

/** @type {import('../card.js').Module['mount']} */
export const mount = (root) => new Branch(root);

class Branch {
  #root;
  #near = false;
  /** @type {{answer: Stability, scene: URLSearchParams} | null} */
  #wanted = null;
  #shown = '';
  #latest = new LatestRequest();

  /** @param {HTMLElement} root */
  constructor(root) {
    this.#root = root;
    new IntersectionObserver(
      (entries) => {
        this.#near = entries.some(({ isIntersecting }) => isIntersecting);
        if (this.#near) void this.#refresh();
      },
      { rootMargin: '100px 0px' },
    ).observe(root);
  }

  /** @param {{answer: Stability, scene: URLSearchParams}} judged */
  judged(judged) {
    this.#wanted = judged;
    this.#soon();
  }

  retell() {
    this.#shown = '';
    this.#soon();
  }

  #soon = debounce(300, () => {
    if (this.#near) void this.#refresh();
  });

  async #refresh() {
    if (!this.#wanted) return;
    const { answer, scene } = this.#wanted;
    const { below, above } = marginOf(answer, 'table.tilt_gain') ?? {};
    const point = 'point' in answer.scene.body;
    if (point || !below || !above) {
      this.#shown = '';
      return this.#say(
        point
          ? 'A point mass has no angle to swing by.'
          : 'This scene has no critical gain, so nothing branches off there.',
      );
    }
    const query = new URLSearchParams(scene);
    const span = SHOWN * (above.limit - below.limit);
    const [from, to] = [above.limit - span, above.limit + span].map((end) => Number(end.toPrecision(4)));
    for (const [key, value] of Object.entries({
      family: 'symmetric',
      theta: BEGIN,
      'sweep.field': GAIN,
      'sweep.from': from,
      'sweep.to': to,
    }))
      query.set(key, String(value));
    const path = `v1/periodic-orbits?${query}`;
    if (path === this.#shown) return;
    this.#shown = path;
    const signal = this.#latest.next();
    try {
      const [orbits, figure] = await Promise.all([get(path, signal), serverFigure(`${path}&format=svg`, signal)]);
      this.#draw(path, figure, orbits.changes, answer, above.limit);
    } catch (error) {
      if (signal.aborted) return;
      const again = h(
        'p',
        {},
        retryButton(() => {
          this.#shown = '';
          void this.#refresh();
        }),
      );
      if (error instanceof Problem && error.status < 500) this.#say(`There is no branch to show: ${error.message}.`);
      else this.#say(wordsOf(error), again);
    }
  }

  /** @param {string} words @param {...Node} more */
  #say(words, ...more) {
    this.#latest.cancel();
    this.#root.replaceChildren(h('p', { class: 'muted', role: 'status' }, ...marked(words)), ...more);
  }

  /**
   * @param {string} path
   * @param {SVGSVGElement} figure
   * @param {Change[]} changes
   * @param {Stability} answer
   * @param {number} critical
   */
  #draw(path, figure, changes, { boundary }, critical) {
    const kind = boundary?.kind ?? '';
    const words = MEANINGS[kind];
    this.#root.replaceChildren(
      h(
        'p',
        { class: 'answer', role: 'status' },
        h('strong', {}, HEADLINES[kind] ?? HEADLINES.other),
        ' At ',
        term('kappa-critical'),
        ` = ${number(critical, 5)} the upright bounce gives birth to `,
        term('orbit', 'orbits'),
        ' that swing from side to side. ',
        ...(words ? [...explained(words), ` (C = ${number(boundary?.coefficient, 3)}).`] : []),
      ),
      readable(figure, critical),
      h(
        'details',
        {},
        h('summary', {}, `Changes along the branch (${changes.length})`),
        table(
          'Changes along the branch',
          ['Change', term('kappa'), shownUnit('θ / rad'), term('residue')],
          h('tbody', {}, ...changes.map(rowOf)),
          'changes',
        ),
      ),
      h(
        'p',
        { class: 'actions' },
        ...actions({
          id: 'branch',
          title: 'Orbits of period 2',
          path,
          formats: ['svg', 'png', 'csv', 'arrow', 'json'],
        }),
      ),
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
  row(
    [kind.replaceAll('_', ' '), h('span', { class: 'muted' }, ...prose(detail))],
    [number(value, 5), number(shownValue(tiny(theta), 'rad')), residue === null ? '–' : number(tiny(residue), 3)],
  );

/** Zero for a value that is rounding. @param {number} value */
const tiny = (value) => (Math.abs(value) < 1e-9 ? 0 : value);
