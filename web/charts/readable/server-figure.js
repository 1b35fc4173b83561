// A picture by the server as part of the page: coloured by the style sheet, and readable by pointer and keys.

import { asked } from '../../api/client.js';
import { svg } from '../svg.js';
import { movedInRow } from './chart-reader.js';

/** An address of the server from where the page is, behind whatever proxy. @param {string} path */
export const here = (path) => path.replace(/^\//, '');

/** @param {string} path of an SVG @param {AbortSignal} [signal] */
export const serverFigure = async (path, signal) => figureOf(await (await asked(path, { signal })).text());

/** @param {string} text an SVG @returns {SVGSVGElement} */
export function figureOf(text) {
  const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');
  const figure = /** @type {SVGSVGElement} */ (
    /** @type {unknown} */ (document.importNode(parsed.documentElement, true))
  );
  figure.setAttribute('class', 'figure');
  // The box around the figure names it; its title would stand in the way of the pointer.
  for (const name of ['role', 'width', 'height']) figure.removeAttribute(name);
  figure.setAttribute('aria-hidden', 'true');
  for (const element of figure.querySelectorAll(':scope > :is(title, desc)')) element.remove();
  // The page has words of its own around the charts, and paper.
  const { charts } = figure.dataset;
  if (charts) {
    figure.setAttribute('viewBox', charts);
    figure.querySelector(':scope > rect')?.remove();
  }
  return figure;
}

/** Points of a figure with the values in its data attributes. */
export class FigurePoints {
  /** @type {{x: number, y: number, values: Record<string, string>}[]} */
  points = [];
  #figure;
  #ring = svg('circle', { class: 'pointed', r: 9, hidden: '' });

  /**
   * @param {SVGSVGElement} figure
   * @param {string[]} names of data attributes: with a value for each point of a path, or one for all of them
   */
  constructor(figure, names) {
    this.#figure = figure;
    for (const path of /** @type {NodeListOf<SVGPathElement>} */ (figure.querySelectorAll(`path[data-${names[0]}]`))) {
      const columns = names.map((name) => (path.dataset[name] ?? '').split(' '));
      const places = (path.getAttribute('d') ?? '').slice(1).split('L');
      for (const [index, place] of places.entries()) {
        const [x, y] = place.split(' ').map(Number);
        const values = names.map((name, column) => [name, columns[column][index] ?? columns[column][0]]);
        this.points.push({ x, y, values: Object.fromEntries(values) });
      }
    }
    figure.append(this.#ring);
  }

  /** The point next to a place on the screen, or null far from all of them. @param {PointerEvent} event */
  nearest({ clientX, clientY }) {
    const place = new DOMPoint(clientX, clientY).matrixTransform(this.#figure.getScreenCTM()?.inverse());
    let best = null;
    let distance = 24 ** 2;
    for (const [index, { x, y }] of this.points.entries()) {
      const square = (x - place.x) ** 2 + (y - place.y) ** 2;
      if (square <= distance) {
        distance = square;
        best = index;
      }
    }
    return best;
  }

  /** @param {number | null} index */
  mark(index) {
    const point = index === null ? null : this.points[index];
    this.#ring.toggleAttribute('hidden', !point);
    if (!point) return;
    this.#ring.setAttribute('cx', String(point.x));
    this.#ring.setAttribute('cy', String(point.y));
  }

  /** Goes along the points by keys. @param {(index: number) => string} words @returns {Readable} */
  reader(words) {
    return {
      nearest: (event) => this.nearest(event),
      moved: (key, at) => movedInRow(key, at, this.points.length),
      mark: (index) => this.mark(index),
      words,
    };
  }
}

/** Panels of a figure, one below the other or side by side, that share their values along x. */
export class FigureColumns {
  #figure;
  #line = svg('path', { class: 'pointed', hidden: '' });
  /** @type {{left: number, right: number, top: number, bottom: number, low: number, high: number}[]} */
  #panels;

  /** @param {SVGSVGElement} figure */
  constructor(figure) {
    this.#figure = figure;
    const rectangles = /** @type {NodeListOf<SVGRectElement>} */ (figure.querySelectorAll('rect[data-panel]'));
    this.#panels = [...rectangles].map((rectangle) => {
      const [left, top, width, height] = ['x', 'y', 'width', 'height'].map((name) =>
        Number(rectangle.getAttribute(name)),
      );
      const [low, high] = (rectangle.dataset.x ?? '').split(' ').map(Number);
      return { left, right: left + width, top, bottom: top + height, low, high };
    });
    figure.append(this.#line);
  }

  /** The value along x at a place on the screen, or null beside the panels. @param {PointerEvent} event */
  #valueAt({ clientX, clientY }) {
    const { x } = new DOMPoint(clientX, clientY).matrixTransform(this.#figure.getScreenCTM()?.inverse());
    const panel = this.#panels.find(({ left, right }) => x >= left - 8 && x <= right + 8);
    if (!panel) return null;
    const { left, right, low, high } = panel;
    return low + ((x - left) / (right - left)) * (high - low);
  }

  /** @param {number | undefined} value */
  #mark(value) {
    this.#line.toggleAttribute('hidden', value === undefined);
    if (value === undefined) return;
    const way = this.#panels.map(({ left, right, top, bottom, low, high }) => {
      const x = (left + ((value - low) / (high - low)) * (right - left)).toFixed(1);
      return `M${x} ${top}V${bottom}`;
    });
    this.#line.setAttribute('d', way.join(''));
  }

  /** Goes along items by pointer and keys. @param {number[]} values of the items along x @param {(item: number) => string} words @returns {Readable} */
  reader(values, words) {
    return {
      nearest: (event) => {
        const value = this.#valueAt(event);
        if (value === null || values.length === 0) return null;
        const distance = (/** @type {number} */ item) => Math.abs(values[item] - value);
        return values.reduce((best, _, item) => (distance(item) < distance(best) ? item : best), 0);
      },
      moved: (key, at) => movedInRow(key, at, values.length),
      mark: (item) => this.#mark(item === null ? undefined : values[item]),
      words,
    };
  }
}

/**
 * Reads the curves of a figure.
 * @param {string[]} names of the data attributes with the values
 * @param {(values: Record<string, string>) => string} words of a point
 */
export const readCurves = (names, words) => (/** @type {SVGSVGElement} */ figure) => {
  const curves = new FigurePoints(figure, names);
  return curves.reader((index) => words(curves.points[index].values));
};
