// One item of the paper: a line that unfolds to the printed formula, the computed values, the picture and the reader's scan.

import { wordsOf } from '../../api/client.js';
import { serverFigure } from '../../charts/readable/server-figure.js';
import { h } from '../../dom/elements.js';
import { quantity } from '../../dom/numbers.js';
import { row, table } from '../../dom/tables.js';
import { marked, prose, symbol } from '../../dom/typeset.js';
import { ScanPlace } from './scan.js';

/** @typedef {import('contract').PaperItem} PaperItem */

/** From where the page is, behind whatever proxy. @param {string} path */
const here = (path) => path.replace(/^\//, '');

/** @param {string} words */
const sentence = (words) => prose(/^[a-z]{2}/.test(words) ? words[0].toUpperCase() + words.slice(1) : words);

export class ItemView {
  element;
  #item;
  #page;
  #details;
  #body = h('div', { class: 'reading-body' });
  #numbers = h('div');
  #filled = false;

  /**
   * @param {PaperItem} item
   * @param {import('../card.js').PanelPage} page
   * @param {(open: boolean) => void} turned
   */
  constructor(item, page, turned) {
    this.#item = item;
    this.#page = page;
    const { place, title, agrees, checks } = item;
    const drawn = checks.length === 0;
    const mark = h(
      'span',
      { class: `reading-mark ${agrees ? 'same' : 'differs'}` },
      drawn ? 'drawn' : agrees ? '= agrees' : '≠ differs',
    );
    this.#details = h(
      'details',
      {
        id: `reading-${item.id}`,
        toggle: () => {
          if (this.#details.open) this.#fill();
          turned(this.#details.open);
        },
      },
      h(
        'summary',
        {},
        h('span', { class: 'reading-place' }, ...marked(place)),
        h('span', { class: 'reading-title' }, ...marked(title)),
        mark,
      ),
      this.#body,
    );
    this.element = h('li', {}, this.#details);
  }

  open() {
    this.#details.open = true;
  }

  /** Shows the numbers anew, in the unit of angles that the page shows. */
  redraw() {
    if (this.#filled) this.#numbers.replaceChildren(...this.#checks());
  }

  /** Builds the unfolded part once; its picture is asked for only then. */
  #fill() {
    if (this.#filled) return;
    this.#filled = true;
    const { printed, why, ask, title, scene, kind } = this.#item;
    this.#numbers.replaceChildren(...this.#checks());
    this.#body.append(
      h('p', { class: 'reading-printed' }, h('span', { class: 'muted' }, 'Printed: '), ...marked(printed)),
      this.#numbers,
    );
    if (why) this.#body.append(h('p', {}, ...sentence(why), /[.!?]$/.test(why) ? '' : '.'));
    if (this.#item.picture) this.#body.append(this.#pictures(this.#item.picture));
    else if (kind === 'figure') this.#body.append(new ScanPlace(this.#item.place).element);
    this.#body.append(
      h(
        'p',
        { class: 'actions' },
        h(
          'button',
          { type: 'button', 'aria-label': `Run it: ${title}`, click: () => this.#page.play(scene) },
          'Run it',
        ),
        h('a', { href: here(ask), 'aria-label': `Ask the server: ${title}` }, 'Ask the server'),
      ),
    );
  }

  #checks() {
    const { checks, place } = this.#item;
    if (checks.length === 0) return [];
    const rows = checks.flatMap(({ quantity: name, symbol: sign, unit, printed, computed, agrees, why }) => {
      const cells = [
        printed === null ? 'in words' : quantity(printed, unit, 5),
        quantity(computed, unit, 5),
        h('span', { class: agrees ? 'same' : 'differs' }, agrees ? '=' : '≠'),
      ];
      const named = /^[a-z_]+\.[a-z_.]+$/.test(name) ? [] : [' ', h('span', { class: 'muted' }, name)];
      const line = row([symbol(sign), ...named], cells);
      return why ? [line, h('tr', { class: 'why' }, h('td', { colspan: 4 }, ...sentence(why), '.'))] : [line];
    });
    const head = ['Quantity', 'Printed', 'Computed', h('span', { class: 'unseen' }, 'Equal')];
    return [table(`Printed and computed: ${place}`, head, h('tbody', {}, ...rows), 'reading-checks')];
  }

  /** The computed picture, and a place for the reader's own scan. @param {string} path */
  #pictures(path) {
    const picture = h('div', { class: 'reading-picture', role: 'img', 'aria-label': `Computed: ${this.#item.title}` });
    const scan = this.#item.kind === 'figure' ? new ScanPlace(this.#item.place, picture) : null;
    picture.append(h('p', { class: 'muted' }, 'The picture is being drawn…'));
    serverFigure(here(path), AbortSignal.timeout(60_000)).then(
      (figure) => picture.replaceChildren(figure, ...(scan ? [scan.layer] : [])),
      (error) => picture.replaceChildren(h('p', { class: 'error' }, wordsOf(error))),
    );
    return h('div', { class: 'reading-pictures' }, picture, scan?.element);
  }
}
