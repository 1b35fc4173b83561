// The server's picture of a catch with its values by pointer and keys, moment by moment through strikes and hold.

import { ChartReader, movedInRow } from '../../charts/readable/chart-reader.js';
import { svg } from '../../charts/svg.js';
import { h } from '../../dom/elements.js';
import { fixedQuantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Catch} Catch */
/** A plot of the figure: its box, and the places of its curves' first and last moment. @typedef {{left: number, right: number, top: number, bottom: number, first: number, last: number}} Plot */

/** Width of the lines of a grid; curves are wider. */
const GRID_LINE = 1;

/** The moments of a catch in their order. @param {Catch} answer */
function momentsOf({ strikes, hold }) {
  const struck = strikes.t.map((t, index) => ({
    t,
    words: `strike ${strikes.n[index]}`,
    theta: strikes.theta[index],
    x: strikes.x[index],
    alpha: strikes.alpha[index],
    speed: strikes.table_velocity[index],
  }));
  const held = hold.t.map((t, index) => ({
    t,
    words: 'in contact',
    theta: hold.theta[index],
    x: hold.x[index],
    alpha: hold.alpha[index],
    speed: hold.table_y_dot[index],
  }));
  return [...struck, ...held];
}

/** @param {SVGSVGElement} figure @returns {Plot[]} */
function plotsOf(figure) {
  /** @type {Map<string, {box: DOMRect, xs: number[]}>} */
  const plots = new Map();
  const number = (/** @type {Element} */ element, /** @type {string} */ name) => Number(element.getAttribute(name));
  for (const box of figure.querySelectorAll('rect')) {
    const [x, y, width, height] = ['x', 'y', 'width', 'height'].map((name) => number(box, name));
    plots.set(`${x} ${y}`, { box: new DOMRect(x, y, width, height), xs: [] });
  }
  for (const path of figure.querySelectorAll('path')) {
    if (number(path, 'stroke-width') <= GRID_LINE) continue;
    const places = [...(path.getAttribute('d') ?? '').matchAll(/[ML]([\d.-]+) ([\d.-]+)/g)];
    const [x, y] = places[0]?.slice(1).map(Number) ?? [NaN, NaN];
    for (const { box, xs } of plots.values())
      if (x >= box.left && x <= box.right && y >= box.top && y <= box.bottom)
        xs.push(...places.map((place) => Number(place[1])));
  }
  return [...plots.values()]
    .filter(({ xs }) => xs.length > 1)
    .map(({ box: { left, right, top, bottom }, xs }) => ({
      left,
      right,
      top,
      bottom,
      first: xs.reduce((one, other) => Math.min(one, other)),
      last: xs.reduce((one, other) => Math.max(one, other)),
    }));
}

/** @param {SVGSVGElement} figure @param {Catch} answer @param {string} label */
export function catchPicture(figure, answer, label) {
  const moments = momentsOf(answer);
  const plots = plotsOf(figure);
  const line = svg('path', { class: 'pointed', hidden: '' });
  figure.append(line);
  const { strikes } = answer;
  const [first, last] = [moments[0]?.t ?? 0, moments.at(-1)?.t ?? 0];
  const flown = strikes.t.map((t, index) => t + (strikes.flight_time[index] ?? 0));
  // Curves of the body go from the release to the end of its last flight, that of the table, the last one, from strike to strike.
  const placeAt = (/** @type {Plot} */ plot, /** @type {number} */ t) => {
    const [begin, end] = plot === plots.at(-1) ? [first, last] : [0, Math.max(last, ...flown.slice(-1))];
    return plot.first + ((t - begin) / (end - begin || 1)) * (plot.last - plot.first);
  };
  const reader = new ChartReader('catch', label);
  reader.box.append(figure);
  reader.box.classList.add('figure-box');
  reader.read({
    nearest: ({ clientX, clientY }) => {
      const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(figure.getScreenCTM()?.inverse());
      const plot = plots.find(({ left, right, top, bottom }) => x >= left && x <= right && y >= top && y <= bottom);
      if (!plot || moments.length === 0) return null;
      const away = (/** @type {number} */ index) => Math.abs(placeAt(plot, moments[index].t) - x);
      return moments.reduce((best, _, index) => (away(index) < away(best) ? index : best), 0);
    },
    moved: (key, at) => (moments.length > 0 ? movedInRow(key, at, 0, moments.length - 1) : undefined),
    mark: (index) => {
      line.toggleAttribute('hidden', index === null);
      if (index === null) return;
      line.setAttribute(
        'd',
        plots.map((plot) => `M${placeAt(plot, moments[index].t).toFixed(1)} ${plot.top}V${plot.bottom}`).join(''),
      );
    },
    words: (index) => {
      const { t, words, theta, x, alpha, speed } = moments[index];
      return `t ${fixedQuantity(t, 's', 3)}   ${words}   θ ${fixedQuantity(theta, 'rad', 4)}   x ${fixedQuantity(x, 'm', 4)}   α ${fixedQuantity(alpha, 'rad', 4)}   w ${fixedQuantity(speed, 'm/s', 4)}`;
    },
  });
  const hint = h(
    'p',
    { class: 'muted small', id: 'catch-hint' },
    'With keys: left and right go through strikes and hold, page up and page down by a tenth.',
  );
  return h('div', { class: 'catch-figure' }, reader.box, reader.readout, reader.spoken, hint);
}
