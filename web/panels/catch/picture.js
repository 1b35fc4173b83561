// The server's picture of a catch with its values by pointer and keys, moment by moment through strikes and hold.

import { ChartReader, movedInRow } from '../../charts/readable/chart-reader.js';
import { FigureColumns } from '../../charts/readable/server-figure.js';
import { h } from '../../dom/elements.js';
import { fixedQuantity } from '../../dom/numbers.js';

/** @typedef {import('contract').Catch} Catch */

/** The moments of a catch in their order. @param {Catch} answer */
function momentsOf({ strikes, hold }) {
  const struck = strikes.t.map((t, index) => ({
    t,
    words: `strike ${strikes.n[index]}`,
    theta: strikes.theta[index],
    x: strikes.x[index],
    alpha: strikes.alpha[index],
    speed: strikes.table_velocity[index],
    height: strikes.clearance[index],
  }));
  const held = hold.t.map((t, index) => ({
    t,
    words: 'in contact',
    theta: hold.theta[index],
    x: hold.x[index],
    alpha: hold.alpha[index],
    speed: hold.table_y_dot[index],
    height: hold.table_y[index],
  }));
  return [...struck, ...held];
}

/** @param {SVGSVGElement} figure @param {Catch} answer @param {string} label */
export function catchPicture(figure, answer, label) {
  const moments = momentsOf(answer);
  const columns = new FigureColumns(figure);
  const reader = new ChartReader('catch', label);
  reader.box.append(figure);
  reader.box.classList.add('figure-box');
  reader.read({
    nearest: (event) => {
      const time = columns.valueAt(event);
      if (time === null || moments.length === 0) return null;
      const away = (/** @type {number} */ index) => Math.abs(moments[index].t - time);
      return moments.reduce((best, _, index) => (away(index) < away(best) ? index : best), 0);
    },
    moved: (key, at) => (moments.length > 0 ? movedInRow(key, at, 0, moments.length - 1) : undefined),
    mark: (index) => columns.mark(index === null ? null : moments[index].t),
    words: (index) => {
      const { t, words, theta, x, alpha, speed, height } = moments[index];
      return [
        `t ${fixedQuantity(t, 's', 3)}`,
        words,
        `θ ${fixedQuantity(theta, 'rad', 4)}`,
        `x ${fixedQuantity(x, 'm', 4)}`,
        `α ${fixedQuantity(alpha, 'rad', 4)}`,
        `w ${fixedQuantity(speed, 'm/s', 4)}`,
        `table at ${fixedQuantity(height, 'm', 4)}`,
      ].join('   ');
    },
  });
  const hint = h(
    'p',
    { class: 'muted small', id: 'catch-hint' },
    'With keys: left and right go through strikes and hold, page up and page down by a tenth.',
  );
  return h('div', { class: 'catch-figure' }, reader.box, reader.readout, reader.spoken, hint);
}
