// The groups of the settings: their titles, their fields, and which of them are open.

import { h } from '../dom/elements.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */

/** The fields that come first and never fold. */
export const FIRST = ['table.tilt_gain', 'release.theta', 'contact.restitution', 'contact.friction', 'noise.timing_sd'];

/** Titles of the groups, by the start of a path. */
const GROUPS = /** @type {const} */ ([
  ['release.', 'Release'],
  ['body.', 'Body'],
  ['table.feedback.', 'Feedback'],
  ['table.limits.', 'Limits'],
  ['table.', 'Table'],
  ['noise.', 'Noise'],
]);
/** Fields without a group of their own. */
const REST = 'World';
const ORDER = ['Release', 'Body', 'Table', 'Feedback', 'Limits', 'Noise', REST];

/** @param {Field} field */
const titleOf = ({ field }) => GROUPS.find(([start]) => field.startsWith(start))?.[1] ?? REST;

/** The fields by group, in their order; those that come first have the title ''. @param {Field[]} fields @param {string[]} leading @returns {[string, Field[]][]} */
export function grouped(fields, leading) {
  const first = leading.flatMap((path) => fields.find((field) => field.field === path) ?? []);
  const rest = fields.filter((field) => !first.includes(field));
  const groups = ORDER.map(
    (title) => /** @type {[string, Field[]]} */ ([title, rest.filter((one) => titleOf(one) === title)]),
  );
  return [['', first], ...groups.filter(([, members]) => members.length > 0)];
}

const STORED = 'equipoise.groups';

/** The groups that the reader left open; a browser may refuse to store anything. @returns {string[]} */
function stored() {
  try {
    const titles = JSON.parse(localStorage.getItem(STORED) ?? '[]');
    return Array.isArray(titles) ? titles : [];
  } catch {
    return [];
  }
}

/** @param {string[]} titles */
function store(titles) {
  try {
    localStorage.setItem(STORED, JSON.stringify(titles));
  } catch {
    /* lasts for this visit only */
  }
}

/** A group that folds, and says how many of its fields differ from the case. */
export class Group {
  element;
  #count = h('span', { class: 'differing' });
  #title;
  /** Open by the reader's wish. */
  #wanted;
  /** Open by itself: while a search finds something in it, or when a field began to differ. */
  #opening = false;
  #differing = 0;
  #searching = false;

  /** @param {string} title @param {HTMLElement[]} rows */
  constructor(title, rows) {
    this.#title = title;
    this.#wanted = stored().includes(title);
    const id = `group-${title.toLowerCase()}`;
    const summary = h('summary', { id }, title, ' ', this.#count);
    this.element = h(
      'details',
      { class: 'group' },
      summary,
      h('div', { role: 'group', 'aria-labelledby': id }, ...rows),
    );
    this.#open(this.#wanted);
    this.element.addEventListener('toggle', () => {
      if (this.#opening === this.element.open || this.#searching) return;
      this.#opening = this.element.open;
      this.#wanted = this.element.open;
      const others = stored().filter((one) => one !== title);
      store(this.#wanted ? [...others, title] : others);
    });
  }

  /** @param {boolean} open */
  #open(open) {
    this.#opening = open;
    this.element.open = open;
  }

  /** Counts the fields that differ; a group opens when the first of them begins to. @param {number} count */
  differ(count) {
    if (count === this.#differing) return;
    const begins = this.#differing === 0;
    this.#differing = count;
    this.#count.replaceChildren(
      ...(count === 0 ? [] : [`(${count}•)`, h('span', { class: 'unseen' }, ' changed from the case')]),
    );
    if (begins && !this.#searching) this.#open(true);
  }

  /** Shows the group for a search that found so many of its fields; null when there is no search. @param {number | null} found */
  search(found) {
    this.#searching = found !== null;
    this.element.hidden = found === 0;
    if (found) this.element.open = true;
    else if (found === null) this.#open(this.#wanted || this.#differing > 0);
  }

  get title() {
    return this.#title;
  }

  /** Opens the group so that one of its fields can be reached. */
  reveal() {
    this.element.open = true;
  }
}
