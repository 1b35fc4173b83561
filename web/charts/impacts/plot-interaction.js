// The interaction with all charts of the impacts: one selection, one impact pointed at, a start by a click, a lab's own impacts.

import { Ghost } from './ghost.js';
import { Selection } from '../../run/selection.js';
import { drawContacts } from './overlay.js';
import { byId, h } from '../../dom/elements.js';
import { invalidate } from '../surface.js';
import { listen } from './plot-pointer.js';
import { notice } from '../../dom/notices.js';
import { styles } from '../../dom/styles.js';

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
 * @property {{bar: HTMLElement, show: () => void}} measured the place of a lab's own impacts
 * @property {() => void} follow shows anew what belongs to the typed scene
 * @property {() => import('../../api/scene-fields.js').Scene} drawn the typed scene with what follows from it
 */

const BY_POINTER = 'Drag over a plot to select impacts; click in a plane to place a release there.';
const MEASURED =
  'Impacts that were measured, as CSV or TSV: they are drawn over the run, with the residual of each. The file stays in this browser, unless you press Fit in the tab Fit. It may also be dropped anywhere on the page.';
const BY_KEYS =
  'Left and right go from impact to impact, with Shift they select; Enter offers a release whose first impact is that one, a second Enter releases it; Escape drops it and clears the selection.';

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
  #load = h(
    'button',
    { type: 'button', id: 'measured-load', click: () => this.#file.click() },
    'Load measured impacts…',
  );
  #file = h('input', {
    type: 'file',
    id: 'measured-file',
    accept: '.csv,.tsv,.txt,text/csv,text/tab-separated-values',
    hidden: true,
    change: () => {
      void this.take(this.#file.files?.[0]);
      this.#file.value = '';
    },
  });
  #example = h(
    'button',
    {
      type: 'button',
      id: 'measured-example',
      click: async () => {
        const { EXAMPLE } = await import('../../panels/measured/example.js');
        void this.take(new File([EXAMPLE], 'an example of case 1'));
      },
    },
    'Show an example',
  );
  #hint = h('p', { class: 'unseen', id: 'impacts-hint' }, BY_KEYS);
  // Spoken when keys move or a selection is made; a pointer's way over a chart is not.
  #spoken = h('p', { class: 'unseen', role: 'status', id: 'impacts-spoken' });
  /** @type {import('../../panels/measured/panel.js').MeasuredPanel | null} */
  #measured = null;
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
    page.measured.bar.append(h('p', {}, MEASURED), this.#load, this.#file, this.#example);
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
    const root = byId('charts');
    // Wherever on the page: a file beside the charts is meant for them, not for the browser.
    const over = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files') ?? false;
    addEventListener('dragover', (event) => {
      if (!over(event)) return;
      event.preventDefault();
      root.classList.add('awaited');
    });
    addEventListener('dragleave', (event) => {
      if (!event.relatedTarget) root.classList.remove('awaited');
    });
    addEventListener('drop', (event) => {
      root.classList.remove('awaited');
      if (!over(event)) return;
      event.preventDefault();
      void this.take(event.dataTransfer?.files[0]);
    });
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
    this.#measured?.struck();
  }

  /** The impacts are those of another run. */
  cleared() {
    this.#selection.forget();
    invalidate(this);
    this.#measured?.struck();
  }

  /** Reads measured impacts. @param {File | undefined} file @param {string} [about] where it comes from */
  async take(file, about) {
    if (!file) return;
    let parts;
    try {
      parts = await Promise.all([
        import('../../panels/measured/panel.js'),
        import('../../panels/measured/file.js'),
        this.#measured ?? styles('panels/measured/measured.css'),
      ]);
    } catch {
      return notice('measured', ['What reads measured impacts did not load.'], { caution: true });
    }
    const [{ MeasuredPanel }, { measured }] = parts;
    this.#measured ??= new MeasuredPanel(this.#page.measured.bar, this.#page);
    this.#page.measured.show();
    await measured.take(file, about);
  }

  draw() {
    const { active, places } = this.#selection;
    const { begin, end } = this.#page.run.impacts;
    this.#clear.hidden = !active;
    const words = active ? `${places.length} of ${end - begin} impacts selected` : this.#keyed ? BY_KEYS : BY_POINTER;
    if (this.#told.textContent !== words) this.#told.textContent = words;
    return false;
  }
}
