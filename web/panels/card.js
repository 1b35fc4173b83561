// The card of a panel: loads the panel's code and styles, and offers to try again.

import { enlarger } from '../export/enlarge-button.js';
import { h, retryButton } from '../dom/elements.js';
import { styles } from '../dom/styles.js';

export { styles };

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/** A turn of a drag; `once` for a step that is all of it. @typedef {'first' | 'more' | 'last' | 'once'} Turn */

/**
 * The page around a panel, as far as the panel knows it.
 * @typedef {object} PanelPage
 * @property {Field[]} fields
 * @property {() => URLSearchParams | null} query what is typed; null while some of it is no value
 * @property {() => Scene} scene the same, as far as it goes
 * @property {() => Case | null} chosen the case that it began with
 * @property {() => URLSearchParams | null} played what the plots show: the run with what was done to it, else what is typed
 * @property {(values: Record<string, number>) => void} launch releases the scene with these values in it
 * @property {(values: Record<string, number>, turn: Turn) => void} [drop] drops the scene with these values at each turn of a drag
 * @property {(scene: Scene, words?: string) => void} play shows another scene and runs it; undo names the words
 * @property {() => void} changed the panel’s part of the address is another one
 * @property {(id: string, link: URLSearchParams) => void} [open] another panel, with this as its part of the address
 * @property {(words: string, holds: boolean | null) => void} [told] the panel’s result in a line; null for one that is neither good nor bad
 * @property {Guide} [guide]
 */

/**
 * The table under a run that is under way: what it does on request.
 * @typedef {object} Guide
 * @property {() => boolean} live there is such a run
 * @property {() => boolean} held the table holds its body
 * @property {() => number} length from the contact point to the centre of gravity, m
 * @property {(watcher: {changed: () => void, problem: (told: {title: string, detail: string, errors: import('contract').ProblemError[]}) => void}) => void} watch
 * @property {(settings: Record<string, string | number>) => void} catchIt
 * @property {(apex: {height: number, theta: number}) => void} throwIt
 * @property {(heights: number[]) => void} juggle
 */

/** A verdict and the scene it is of. @typedef {{answer: import('contract').Stability, scene: URLSearchParams}} Judged */

/**
 * A loaded panel.
 * @typedef {object} Panel
 * @property {() => void} [sceneChanged]
 * @property {() => void} [ask] what waits for a press of a button in the page
 * @property {(judged: Judged) => void} [judged]
 * @property {() => void} [played] what the plots show may be another run
 * @property {() => void} [retell] shows the same in another unit of angles
 * @property {() => URLSearchParams} [query] its part of the page’s address, where it differs from the usual
 * @property {(link: URLSearchParams) => string[]} [restore] from that part; what was dropped of it, in words
 */

/** @typedef {{mount: (root: HTMLElement, page: PanelPage, link: URLSearchParams) => Panel}} Module */

/**
 * @typedef {object} Entry
 * @property {string} id also its folder, its style sheet, its part of the address, and its name under `embed/`
 * @property {string} title
 * @property {string} about
 * @property {boolean} [fills] it fills its place as it is, and is not opened large
 * @property {string[]} [shared] style sheets that it shares with other panels
 * @property {() => Promise<Module>} load
 */

/** A panel of the workbench: the tab in which it stands. @typedef {Entry & {tab: string}} Study */

/**
 * A card for a panel and, once its code and its styles are there, the panel. What fails to load can be asked for again.
 * @param {Entry} entry
 * @param {PanelPage} page
 * @param {() => URLSearchParams} link
 * @param {(panel: Panel) => void} mounted
 */
export function card({ id, title, about, shared = [], fills = false, load }, page, link, mounted) {
  const body = h('div', { id: `${id}-body`, class: 'lazy-body' });
  const element = h(
    'section',
    { class: 'card lazy', id, 'aria-labelledby': `${id}-title` },
    h('div', { class: 'card-head' }, h('h2', { id: `${id}-title` }, title), h('p', { class: 'muted' }, about)),
    body,
  );
  if (!fills) element.firstElementChild?.append(enlarger(element, title));
  const bring = async () => {
    try {
      const [module] = await Promise.all([load(), ...[...shared, `panels/${id}/${id}.css`].map(styles)]);
      body.replaceChildren();
      mounted(module.mount(body, page, link()));
    } catch {
      body.replaceChildren(h('p', { class: 'muted' }, 'This part did not load.'), retryButton(bring));
    }
  };
  return { element, body, bring };
}
