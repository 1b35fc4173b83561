// The interaction with all charts of the bounces: one selection, one bounce pointed at, a start by a click.

import { updateAddressSoon } from '../../app/address-bar.js';
import { h } from '../../dom/elements.js';
import { contactDistance } from '../../physics/body.js';
import { Selection } from '../../run/selection.js';
import { invalidate } from '../surface.js';
import { theme } from '../theme.js';
import { Ghost, listen } from './plot-pointer.js';

/** @typedef {import('../../app/page.js').Page} Page */

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

  /** @param {HTMLElement} bar over the plots @param {Page} page */
  constructor(bar, page) {
    const { run, view, plots } = page;
    const { impacts } = run;
    const selection = new Selection(impacts);
    this.#page = page;
    this.#selection = selection;
    selection.changed = () => this.#selected();
    bar.append(this.#told, this.#clear, this.#hint, this.#spoken);
    view.under = (surface, scale, scene) => drawContacts(surface, scale, scene, impacts, selection);
    const say = (/** @type {string} */ words) => {
      this.#spoken.textContent = words;
    };
    this.#ghost = new Ghost(page, say);
    const point = (/** @type {number | null} */ place) => {
      for (const one of plots) one.point(place);
    };
    for (const plot of plots) {
      listen(plot, {
        impacts,
        selection,
        ghost: this.#ghost,
        typed: () => page.complete && { ...page.complete, derived: view.drawn.derived },
        fields: page.fields,
        point,
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
    run.watch({
      struck: () => {
        selection.update();
        invalidate(this);
      },
      cleared: () => {
        selection.forget();
        invalidate(this);
      },
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
    for (const view of [...this.#page.plots, this.#page.view]) view.redraw();
    invalidate(this);
    updateAddressSoon(this.#page);
  }

  draw() {
    const { active } = this.#selection;
    this.#clear.hidden = !active;
    const words = active ? this.#selection.words : this.#keyed ? BY_KEYS : BY_POINTER;
    if (this.#told.textContent !== words) this.#told.textContent = words;
    return false;
  }
}

/**
 * The places of the selected contacts along the floor of the scene.
 * @param {import('../surface.js').Surface} surface
 * @param {import('../../scene/camera.js').Scale} scale
 * @param {import('../../api/scene-fields.js').Scene} scene
 * @param {import('../../run/impacts.js').Impacts} impacts
 * @param {Selection} selection
 */
function drawContacts({ context, width }, scale, scene, impacts, selection) {
  const l = contactDistance(scene);
  const top = scale.y(0) + 2;
  const marked = new Set();
  context.beginPath();
  for (const place of selection.places) {
    const x = Math.round(scale.x(impacts.at('x', place) + (l && l * Math.sin(impacts.at('theta', place)))));
    if (!(x > 0 && x < width) || marked.has(x)) continue;
    marked.add(x);
    context.moveTo(x, top);
    context.lineTo(x + 4, top + 8);
    context.lineTo(x - 4, top + 8);
    context.closePath();
  }
  const { accent, ink } = theme();
  context.lineWidth = 1;
  context.fillStyle = accent;
  context.fill();
  context.strokeStyle = ink;
  context.stroke();
}
