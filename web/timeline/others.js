// The runs beside the live one: their dots in the planes, and their rods on its stage and clock.

/**
 * @typedef {object} Other
 * @property {import('../run/run-state.js').RunState} run
 * @property {Record<string, (number | null)[]>} columns of its impacts, those to show
 * @property {string} symbol
 * @property {import('../scene/bodies.js').RodColour} colour of its dots and its rod
 * @property {string} label
 * @property {boolean} staged its rod is drawn too
 */

export class Others {
  /** @type {Map<string, Other>} */
  #others = new Map();
  #view;
  #plots;

  /** @param {import('../scene/scene-view.js').SceneView} view @param {import('../charts/impacts/impact-plot.js').ImpactPlot[]} plots */
  constructor(view, plots) {
    this.#view = view;
    this.#plots = plots;
  }

  /** @param {string} id @param {Other | null} other */
  set(id, other) {
    if (!other && !this.#others.has(id)) return;
    if (other) this.#others.set(id, other);
    else this.#others.delete(id);
    const all = [...this.#others.values()];
    for (const plot of this.#plots)
      plot.references(all.map(({ columns, symbol, colour, label }) => ({ columns, symbol, colour, label })));
    this.#view.others = all.filter(({ staged }) => staged);
    this.#view.redraw();
  }
}
