// A release that a click in a plane offers: its mark and its impacts in all planes, with a button that releases it.

import { Problem, get } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { styles } from '../../dom/styles.js';

/** @typedef {import('./impact-plot.js').ImpactPlot} ImpactPlot */

/**
 * @typedef {object} GhostParts
 * @property {ImpactPlot[]} plots
 * @property {() => URLSearchParams | null} query what a run would be released with
 * @property {(values: Record<string, number>) => void} launch
 * @property {(words: string) => void} say aloud
 * @property {(answer: import('contract').Trajectory | null) => void} [preview] in the scene
 */

/** Impacts of its own that a ghost shows. */
const SHOWN = 200;
/** A button of these takes Enter for itself. */
const OWN_ENTER = 'a, button, input, select, textarea, summary, dialog, [tabindex]';

export class Ghost {
  #parts;
  #words = h('p', {});
  #release = h('button', { type: 'button', class: 'primary', id: 'ghost-release', click: () => this.release() });
  #element = h(
    'div',
    { class: 'slip ghost', role: 'group', 'aria-label': 'Release offered' },
    this.#words,
    this.#release,
    h('button', { type: 'button', class: 'ghost-drop', 'aria-label': 'Drop it', click: () => this.drop() }, '×'),
  );
  /** @type {{plot: ImpactPlot, at: {x: number, y: number}, values: Record<string, number>, words: string} | null} */
  #offered = null;
  /** @type {AbortController | null} */
  #asking = null;

  /** @param {GhostParts} parts */
  constructor(parts) {
    this.#parts = parts;
    this.#release.append('Release here');
    // They are not the plot's, and the focus is for keys.
    for (const event of ['pointerdown', 'pointermove', 'pointerup'])
      this.#element.addEventListener(event, (one) => one.stopPropagation());
    addEventListener('keydown', (event) => this.#key(event), { capture: true });
    addEventListener('click', ({ target }) => {
      const inside = target instanceof Node && parts.plots.some(({ figure }) => figure.box.contains(target));
      if (!inside) this.drop();
    });
  }

  get offered() {
    return this.#offered;
  }

  /**
   * @param {ImpactPlot} plot that was clicked
   * @param {{x: number, y: number}} at values of the first impact
   * @param {Record<string, number>} values to release with
   * @param {string} words
   */
  offer(plot, at, values, words) {
    this.#offered = { plot, at, values, words };
    this.#words.replaceChildren(...words.split(', ').flatMap((part) => [h('span', {}, part), ' ']));
    void styles('charts/impacts/ghost.css').catch(() => {});
    // At the end that is farther from its mark.
    const { low, high } = plot.frame.y;
    this.#element.classList.toggle('top', at.y < (low + high) / 2);
    plot.figure.box.append(this.#element);
    this.#show(null);
    this.#parts.say(`${words}. Enter releases there, Escape drops it.`);
    void this.#follow(values);
  }

  release() {
    const offered = this.#offered;
    if (!offered) return;
    this.drop();
    this.#parts.launch(offered.values);
    this.#parts.say(`Released anew for a first bounce there: ${offered.words}`);
  }

  drop() {
    if (!this.#offered) return;
    this.#asking?.abort();
    this.#offered = null;
    const focused = this.#element.contains(document.activeElement);
    const box = this.#element.parentElement;
    this.#element.remove();
    if (focused) box?.focus({ preventScroll: true });
    for (const plot of this.#parts.plots) plot.ghost(null);
    this.#parts.preview?.(null);
  }

  /** @param {import('contract').Trajectory['impacts'] | null} impacts */
  #show(impacts) {
    const columns = /** @type {import('./companions.js').Columns | null} */ (impacts);
    for (const plot of this.#parts.plots) {
      const { x, y } = plot.meaning;
      const [across, up] = [columns?.[x.column]?.[0], columns?.[y.column]?.[0]];
      const first = across != null && up != null ? { x: across, y: up } : null;
      const clicked = plot === this.#offered?.plot;
      plot.ghost({ at: clicked ? (this.#offered?.at ?? null) : first, clicked, columns });
    }
  }

  /** Asks for its impacts. @param {Record<string, number>} values */
  async #follow(values) {
    this.#asking?.abort();
    const query = this.#parts.query();
    if (!query) return;
    for (const [path, value] of Object.entries(values)) query.set(`scene.${path}`, String(value));
    this.#asking = new AbortController();
    const { signal } = this.#asking;
    try {
      const answer = await get(`v1/trajectories?${query}&bounces=${SHOWN}`, signal);
      if (signal.aborted) return;
      this.#show(answer.impacts);
      this.#parts.preview?.(answer);
    } catch (error) {
      // Its mark and its words are there all the same; a refusal says why there is no run.
      if (!signal.aborted && error instanceof Problem && error.errors.length > 0)
        this.#words.textContent = error.errors.map(({ detail }) => detail).join(' ');
    }
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (!this.#offered || event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const target = event.target instanceof Element ? event.target : null;
    if (event.key === 'Escape') this.drop();
    else if (event.key === 'Enter' && (target === this.#offered.plot.figure.box || !target?.closest(OWN_ENTER)))
      this.release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
