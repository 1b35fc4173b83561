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

/** The place of a pointer in a figure. @param {SVGSVGElement} figure @param {PointerEvent} event */
const placeIn = (figure, { clientX, clientY }) =>
  new DOMPoint(clientX, clientY).matrixTransform(figure.getScreenCTM()?.inverse());

/** A point on a figure goes no farther than this, px of the figure. */
const NEAR = 24;

/**
 * Points of a figure with the values in its data attributes.
 * @param {SVGSVGElement} figure
 * @param {string[]} names of data attributes: with a value for each point of a path, or one for all of them
 * @returns {{x: number, y: number, values: Record<string, string>}[]}
 */
export const pointsOf = (figure, names) =>
  [.../** @type {NodeListOf<SVGPathElement>} */ (figure.querySelectorAll(`path[data-${names[0]}]`))].flatMap((path) => {
    const columns = names.map((name) => (path.dataset[name] ?? '').split(' '));
    const places = (path.getAttribute('d') ?? '').slice(1).split('L');
    return places.map((place, index) => {
      const [x, y] = place.split(' ').map(Number);
      const values = names.map((name, column) => [name, columns[column][index] ?? columns[column][0]]);
      return { x, y, values: Object.fromEntries(values) };
    });
  });

/** Reads points of a figure: a ring marks one. @param {SVGSVGElement} figure @param {{x: number, y: number}[]} points @param {(index: number) => string} words @returns {Readable} */
export function readPoints(figure, points, words) {
  const ring = svg('circle', { class: 'pointed', r: 9, hidden: '' });
  figure.append(ring);
  return {
    nearest: (event) => {
      const place = placeIn(figure, event);
      const distances = points.map(({ x, y }) => Math.hypot(x - place.x, y - place.y));
      const least = Math.min(...distances);
      return least <= NEAR ? distances.lastIndexOf(least) : null;
    },
    moved: (key, at) => movedInRow(key, at, points.length),
    mark: (index) => {
      const point = index === null ? null : points[index];
      ring.toggleAttribute('hidden', !point);
      if (!point) return;
      ring.setAttribute('cx', String(point.x));
      ring.setAttribute('cy', String(point.y));
    },
    words,
  };
}

/**
 * Reads items along the panels of a figure, one below the other or side by side, that share their values along x: a line marks one.
 * @param {SVGSVGElement} figure
 * @param {number[]} items their values along x
 * @param {(item: number) => string} words
 * @returns {Readable}
 */
export function readColumns(figure, items, words) {
  const line = svg('path', { class: 'pointed', hidden: '' });
  const rectangles = /** @type {NodeListOf<SVGRectElement>} */ (figure.querySelectorAll('rect[data-panel]'));
  const panels = [...rectangles].map((rectangle) => {
    const [left, top, width, height] = ['x', 'y', 'width', 'height'].map((name) =>
      Number(rectangle.getAttribute(name)),
    );
    const [low, high] = (rectangle.dataset.x ?? '').split(' ').map(Number);
    return { left, right: left + width, top, bottom: top + height, low, high };
  });
  figure.append(line);
  return {
    nearest: (event) => {
      const { x } = placeIn(figure, event);
      const panel = panels.find(({ left, right }) => x >= left - 8 && x <= right + 8);
      if (!panel || items.length === 0) return null;
      const { left, right, low, high } = panel;
      const value = low + ((x - left) / (right - left)) * (high - low);
      const distances = items.map((item) => Math.abs(item - value));
      return distances.indexOf(Math.min(...distances));
    },
    moved: (key, at) => movedInRow(key, at, items.length),
    mark: (item) => {
      line.toggleAttribute('hidden', item === null);
      if (item === null) return;
      const way = panels.map(({ left, right, top, bottom, low, high }) => {
        const x = (left + ((items[item] - low) / (high - low)) * (right - left)).toFixed(1);
        return `M${x} ${top}V${bottom}`;
      });
      line.setAttribute('d', way.join(''));
    },
    words,
  };
}

/**
 * Reads the curves of a figure.
 * @param {string[]} names of the data attributes with the values
 * @param {(values: Record<string, string>) => string} words of a point
 */
export const readCurves = (names, words) => (/** @type {SVGSVGElement} */ figure) => {
  const points = pointsOf(figure, names);
  return readPoints(figure, points, (index) => words(points[index].values));
};
