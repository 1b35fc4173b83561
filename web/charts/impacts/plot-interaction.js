// The interaction with all charts of the bounces: one selection, one bounce pointed at, a start by a click.

import { Ghost } from './ghost.js';
import { Selection } from '../../run/selection.js';
import { drawContacts } from './overlay.js';
import { h } from '../../dom/elements.js';
import { invalidate } from '../surface.js';
import { listen } from './plot-pointer.js';

/**
 * @typedef {object} InteractionParts
 * @property {import('../../run/run.js').Run} run
 * @property {import('../../scene/scene-view.js').SceneView} view
 * @property {import('./impact-plot.js').ImpactPlot[]} plots
 * @property {() => import('../../api/scene-fields.js').Scene | null} typed what a run would be released with; null while some of it is no value
 * @property {() => URLSearchParams | null} query the same as a query
 * @property {import('../../api/scene-fields.js').Field[]} fields
 * @property {(values: Record<string, number>) => void} launch
 * @property {() => void} changed what the address says
 * @property {() => void} follow shows anew what belongs to the typed scene
 * @property {() => import('../../api/scene-fields.js').Scene} drawn the typed scene with what follows from it
 */

const BY_POINTER = 'Drag over a plot to select bounces; click in a plane to place a release there.';
const BY_KEYS =
  'Left and right go from bounce to bounce, with Shift they select; Enter offers a release whose first bounce is that one, a second Enter releases it; Escape drops it and clears the selection.';

export class PlotInteraction {
  #page;
  #selection;
  #ghost;
  #told = h('span', { id: 'brush-told' }, BY_POINTER);
  #clear = h(
    'button',
    { type: 'button', id: 'brush-clear', hidden: true, click: () => this.#selection.set([]) },
    'Clear',
  );
  #hint = h('p', { class: 'unseen', id: 'impacts-hint' }, BY_KEYS);
  // Spoken when keys move or a selection is made; a pointer's way over a chart is not.
  #spoken = h('p', { class: 'unseen', role: 'status', id: 'impacts-spoken' });
  /** True while keys go to one of the plots. */
  #keyed = false;

  /** @param {HTMLElement} bar over the plots @param {InteractionParts} page */
  constructor(bar, page) {
    const {
      run: { impacts },
      view,
      plots,
    } = page;
    this.#page = page;
    const selection = new Selection(impacts);
    this.#selection = selection;
    selection.changed = () => this.#selected();
    bar.append(this.#told, this.#clear, this.#hint, this.#spoken);
    view.under = (surface, scale, scene) => drawContacts(surface, scale, scene, impacts, selection);
    const say = (/** @type {string} */ words) => {
      this.#spoken.textContent = words;
    };
    this.#ghost = new Ghost({
      ...page,
      plots,
      say,
      // Without a ghost the scene shows the flights of what is typed.
      preview: (answer) => (answer ? void view.preview(answer) : page.follow()),
    });
    for (const plot of plots) {
      listen(plot, {
        ...page,
        impacts,
        selection,
        ghost: this.#ghost,
        point: (place) => {
          for (const one of plots) one.point(place);
        },
        say,
      });
      const { box } = plot.figure;
      box.setAttribute('aria-describedby', this.#hint.id);
      // A pointer does not give the focus.
      for (const event of ['focus', 'blur'])
        box.addEventListener(event, () => {
          this.#keyed = event === 'focus';
          invalidate(this);
        });
    }
  }

  /** Drops an offered release, which belongs to the scene before. */
  sceneChanged() {
    this.#ghost.drop();
  }

  query() {
    return this.#selection.query();
  }

  /** @param {URLSearchParams} link */
  restore(link) {
    return this.#selection.restore(link);
  }

  /** The selection is another one. */
  #selected() {
    const { plots, view, changed } = this.#page;
    for (const plot of plots) plot.redraw();
    view.redraw();
    invalidate(this);
    changed();
  }

  /** There are new impacts. */
  struck() {
    this.#selection.update();
    invalidate(this);
  }

  /** The impacts are those of another run. */
  cleared() {
    this.#selection.forget();
    invalidate(this);
  }

  draw() {
    const { active, places } = this.#selection;
    const { begin, end } = this.#page.run.impacts;
    this.#clear.hidden = !active;
    const words = active ? `${places.length} of ${end - begin} bounces selected` : this.#keyed ? BY_KEYS : BY_POINTER;
    if (this.#told.textContent !== words) this.#told.textContent = words;
    return false;
  }
}
