// The panels below the fold: their names, what each shows in a sentence, and how one is brought. Not for what is in them.

import { enlarger } from '../export/enlarge-button.js';
import { h } from '../dom/dom.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/**
 * What a panel knows of where it stands.
 * @typedef {object} Page
 * @property {Field[]} fields
 * @property {() => URLSearchParams | null} query what is typed; null while some of it is no value
 * @property {() => Scene} scene the same, as far as it goes
 * @property {() => Case | null} chosen the case that it began with
 * @property {() => URLSearchParams | null} played what the plots show: the run with what was done to it, else what is typed
 * @property {(values: Record<string, number>) => void} launch releases the scene with these values in it
 * @property {(scene: Scene) => void} play shows another scene and runs it
 * @property {() => void} changed the panel’s part of the address is another one
 */

/** A verdict and the scene it is of. @typedef {{answer: import('contract').Stability, scene: URLSearchParams}} Judged */

/**
 * What stands in its place.
 * @typedef {object} Panel
 * @property {() => void} [sceneChanged]
 * @property {() => void} [ask] what waits for a press of a button in the page
 * @property {(judged: Judged) => void} [judged]
 * @property {() => void} [played] what the plots show may be another run
 * @property {() => URLSearchParams} [query] its part of the page’s address, where it differs from the usual
 * @property {(link: URLSearchParams) => string[]} [restore] from that part; what was dropped of it, in words
 */

/** @typedef {{mount: (root: HTMLElement, page: Page, link: URLSearchParams) => Panel}} Module */

/**
 * @typedef {object} Entry
 * @property {string} id also its folder, its style sheet, its part of the address, and its name under `embed/`
 * @property {string} title
 * @property {string} about
 * @property {boolean} [half] shares its row
 * @property {() => Promise<Module>} load
 */

/** @type {Entry[]} */
export const PANELS = [
  {
    id: 'map',
    title: 'Stability map',
    about: 'Which scenes keep their balance, beside this one: a run in every cell.',
    load: () => import('./map/panel.js'),
  },
  {
    id: 'survival',
    title: 'Survival under noise',
    about: 'How long runs of this scene last when the table errs.',
    load: () => import('./survival/panel.js'),
  },
  {
    id: 'ladder',
    title: 'Which model does it need',
    about: 'The same scene by every simpler model, and what each leaves out.',
    load: () => import('./ladder/panel.js'),
  },
  {
    id: 'design',
    title: 'Design a controller',
    about: 'A law that brings this scene to rest in place.',
    load: () => import('./design/panel.js'),
  },
  {
    id: 'branch',
    title: 'Orbits of period 2',
    about: 'What the boundary of stability gives birth to.',
    load: () => import('./branch/panel.js'),
  },
  {
    id: 'precision',
    title: 'Speed against accuracy',
    about: 'What this scene costs by each method, and how far it ends from the truth.',
    load: () => import('./precision/panel.js'),
  },
  {
    id: 'paper',
    title: 'Printed and computed',
    about: 'The numbers of the paper beside those of the server.',
    half: true,
    load: () => import('./paper/panel.js'),
  },
  {
    id: 'calls',
    title: 'The same from the API',
    about: 'What this page shows, as commands.',
    half: true,
    load: () => import('./calls/panel.js'),
  },
  {
    id: 'gallery',
    title: 'Where usual methods fail',
    about: 'Scenes on which they are wrong, with what is true.',
    load: () => import('./gallery/panel.js'),
  },
];

/** @param {string} path @returns {Promise<void>} */
export function styles(path) {
  return new Promise((resolve, reject) => {
    document.head.append(
      h('link', { rel: 'stylesheet', href: path, load: () => resolve(), error: () => reject(new Error(path)) }),
    );
  });
}

/**
 * A card for a panel and, once its code and its styles are there, the panel. What fails to load can be asked for again.
 * @param {Entry} entry
 * @param {Page} page
 * @param {() => URLSearchParams} link
 * @param {(panel: Panel) => void} mounted
 */
export function card({ id, title, about, half, load }, page, link, mounted) {
  const body = h('div', { id: `${id}-body`, class: 'lazy-body' });
  const element = h(
    'section',
    { class: `card lazy${half ? ' half' : ''}`, id, 'aria-labelledby': `${id}-title` },
    h('div', { class: 'card-head' }, h('h2', { id: `${id}-title` }, title), h('p', { class: 'muted' }, about)),
    body,
  );
  element.firstElementChild?.append(enlarger(element, title));
  const bring = async () => {
    try {
      const [module] = await Promise.all([load(), styles(`panels/${id}/${id}.css`)]);
      body.replaceChildren();
      mounted(module.mount(body, page, link()));
    } catch {
      body.replaceChildren(
        h('p', { class: 'muted' }, 'This part did not load.'),
        h('button', { type: 'button', click: bring }, 'Try again'),
      );
    }
  };
  return { element, body, bring };
}

/** All of them, each brought when it comes near. */
export class Panels {
  /** @type {Map<string, Panel>} */
  #mounted = new Map();
  #link = new URLSearchParams();
  /** @type {Judged | null} */
  #judged = null;
  #dropped;

  /**
   * @param {HTMLElement} main
   * @param {Page} page
   * @param {(id: string, what: string[]) => void} dropped parts of a link that a panel could not keep
   */
  constructor(main, page, dropped) {
    this.#dropped = dropped;
    /** @type {HTMLElement | null} */
    let row = null;
    for (const entry of PANELS) {
      const { element, body, bring } = card(
        entry,
        page,
        () => this.#link,
        (panel) => {
          this.#mounted.set(entry.id, panel);
          this.#restore(entry.id, panel);
          if (this.#judged) panel.judged?.(this.#judged);
        },
      );
      if (entry.half) (row ??= main.appendChild(h('div', { class: 'notes' }))).append(element);
      else main.append(element);
      new IntersectionObserver(
        (entries, observer) => {
          if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
          observer.disconnect();
          void bring();
        },
        { rootMargin: '100px 0px' },
      ).observe(body);
    }
  }

  /** One that has its place already takes its part of the address as well. @param {string} id @param {Panel} panel */
  join(id, panel) {
    this.#mounted.set(id, panel);
  }

  /** @param {string} id @param {Panel} panel */
  #restore(id, panel) {
    this.#dropped(id, panel.restore?.(this.#link) ?? []);
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    this.#link = link;
    for (const [id, panel] of this.#mounted) this.#restore(id, panel);
  }

  /** Their parts of the page’s address: of those that are not there yet as the link had it. */
  query() {
    const query = new URLSearchParams();
    for (const [key, value] of this.#link) if (!this.#mounted.get(key.split('.')[0])?.query) query.append(key, value);
    for (const panel of this.#mounted.values())
      for (const [key, value] of panel.query?.() ?? []) query.append(key, value);
    return query;
  }

  played() {
    for (const panel of this.#mounted.values()) panel.played?.();
  }

  sceneChanged() {
    for (const panel of this.#mounted.values()) panel.sceneChanged?.();
  }

  /** @param {Judged} judged */
  judged(judged) {
    this.#judged = judged;
    for (const panel of this.#mounted.values()) panel.judged?.(judged);
  }
}
