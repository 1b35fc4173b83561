// The card of a panel: loads the panel's code and styles, and offers to try again.

import { enlarger } from '../export/enlarge.js';
import { h, retryButton } from '../dom/elements.js';
import { styles } from '../dom/styles.js';

export { styles };

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/**
 * The page around a panel, as far as the panel knows it.
 * @typedef {object} PanelPage
 * @property {Field[]} fields
 * @property {() => URLSearchParams | null} query what is typed; null while some of it is no value
 * @property {() => Scene} scene the same, as far as it goes
 * @property {(values: Record<string, number>) => void} launch releases the scene with these values in it
 * @property {(values: Record<string, number>, first: boolean) => void} [drop] drops the scene with these values, at the first turn of a drag and at others
 * @property {(scene: Scene, words?: string) => void} play shows another scene and runs it; undo names the words
 * @property {() => void} changed the panel’s part of the address is another one
 * @property {(id: string, link: URLSearchParams) => void} [open] another panel, with this as its part of the address
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
 * @property {() => void} [retell] shows the same in another unit of angles
 * @property {() => URLSearchParams} [query] its part of the page’s address, where it differs from the usual
 * @property {(link: URLSearchParams) => string[]} [restore] from that part; what was dropped of it, in words
 */

/** @typedef {{mount: (root: HTMLElement, page: PanelPage, link: URLSearchParams) => Panel}} Module */

/**
 * @typedef {object} Entry
 * @property {string} id also the beginning of its parts of the address, and its name under `embed/`
 * @property {string} title
 * @property {string} about
 * @property {boolean} [fills] it fills its place as it is, and is not opened large
 * @property {string[]} sheets its style sheets
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
export function card({ id, title, about, sheets, fills = false, load }, page, link, mounted) {
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
      const [module] = await Promise.all([load(), ...sheets.map(styles)]);
      body.replaceChildren();
      mounted(module.mount(body, page, link()));
    } catch {
      body.replaceChildren(h('p', { class: 'muted' }, 'This part did not load.'), retryButton(bring));
    }
  };
  return { element, body, bring };
}
