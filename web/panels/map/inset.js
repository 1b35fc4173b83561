// The run of a cell that was chosen: how it ends, its impacts in a plane, and a button that releases it.

import { Problem, get, wordsOf } from '../../api/client.js';
import { MARGIN, drawAxes, include, roundRange, toX, toY } from '../../charts/axes.js';
import { invalidate, surfaces } from '../../charts/surface.js';
import { LatestRequest } from '../../api/latest-request.js';
import { drawDot } from '../../charts/marks.js';
import { h } from '../../dom/elements.js';
import { number } from '../../dom/numbers.js';
import { onThemeChange } from '../../charts/theme.js';

/** Impacts that the picture shows, and more of a run that falls later. */
const SHOWN = 400;
const MOST_SHOWN = 2000;

/** @typedef {{x: number[], y: number[], names: [string, string]}} Dots */

/**
 * @typedef {object} Chosen
 * @property {string[]} place the values of its fields in words
 * @property {string[]} value the map's own words for it
 * @property {URLSearchParams | null} query its scene; null while some of that is no value, and for a catch, which is not the scene’s run
 * @property {number} ends the bounce at which it falls; not finite where it does not
 * @property {() => void} release
 */

export class Inset {
  element;
  #heading = h('h3', {});
  #words = h('p', { class: 'map-inset-words' });
  #time = h('p', { class: 'muted' });
  #box = h('div', { class: 'map-inset-plane', role: 'img' });
  #surface;
  /** @type {Dots | null} */
  #dots = null;
  #latest = new LatestRequest();
  #release;
  #closed;
  /** @type {Chosen | null} */
  #chosen = null;

  /** @param {() => void} closed */
  constructor(closed) {
    this.#closed = closed;
    this.#release = h(
      'button',
      { type: 'button', class: 'primary', id: 'map-release', click: () => this.#chosen?.release() },
      'Release here',
    );
    this.element = h(
      'section',
      { class: 'slip map-inset', id: 'map-inset', 'aria-label': 'The run of the chosen cell', hidden: true },
      h(
        'div',
        { class: 'map-inset-head' },
        this.#heading,
        h('button', { type: 'button', id: 'map-inset-close', 'aria-label': 'Close', click: () => this.close() }, '×'),
      ),
      this.#words,
      this.#box,
      this.#time,
      this.#release,
    );
    [this.#surface] = surfaces(this.#box, 1, () => invalidate(this));
    onThemeChange(() => invalidate(this));
  }

  get open() {
    return !this.element.hidden;
  }

  /** @param {Chosen} chosen @param {'left' | 'right'} side of the map where it hides less */
  async show(chosen, side) {
    const { place, value, query, ends } = chosen;
    this.#chosen = chosen;
    this.element.hidden = false;
    this.element.classList.toggle('right', side === 'right');
    // On a phone it stands below the map.
    this.element.scrollIntoView({ block: 'nearest' });
    this.#heading.textContent = place.join('   ');
    const [headline, ...rest] = value;
    this.#words.replaceChildren(h('strong', {}, sentence(headline)), rest.length > 0 ? `: ${rest.join(', ')}` : '');
    this.#release.disabled = headline === 'no such scene';
    this.#time.textContent = '';
    this.#dots = null;
    this.#box.hidden = this.#time.hidden = !query;
    this.#box.setAttribute('aria-label', 'Its impacts are on their way');
    invalidate(this);
    const signal = this.#latest.next();
    if (!query || this.#release.disabled) return;
    const impacts = Number.isFinite(ends) ? Math.min(MOST_SHOWN, Math.max(1, ends)) : SHOWN;
    try {
      const answer = await get(`v1/trajectories?${query}&bounces=${impacts}`, signal);
      if (signal.aborted) return;
      this.#take(answer, Number.isFinite(ends));
    } catch (error) {
      if (signal.aborted) return;
      this.#time.textContent = error instanceof Problem ? wordsOf(error) : 'The server does not answer.';
    }
  }

  /** @param {any} answer @param {boolean} falls */
  #take({ impacts, outcome }, falls) {
    const turns = impacts.theta.some((/** @type {number | null} */ value) => value !== null);
    const [x, y] = turns ? ['theta', 'theta_dot'] : ['x_dot', 'y_dot'];
    this.#dots = {
      x: impacts[x],
      y: impacts[y],
      names: turns ? ['θ / rad', 'θ̇ / rad/s'] : ['ẋ / m/s', 'ẏ / m/s'],
    };
    const count = impacts.n.length;
    const last = impacts.t.at(-1);
    this.#time.textContent = falls
      ? `${number(outcome.t ?? last, 3)}\u202fs after its release.`
      : `Shown: its first ${number(count, 7)} bounces, ${number(last, 3)}\u202fs.`;
    this.#box.setAttribute('aria-label', `${turns ? 'Angle' : 'Velocity'} plane with its ${count} impacts`);
    invalidate(this);
  }

  close() {
    if (!this.open) return;
    this.#latest.cancel();
    this.element.hidden = true;
    this.#closed();
  }

  draw() {
    const { context, width, height } = this.#surface;
    context.clearRect(0, 0, width, height);
    const dots = this.#dots;
    if (!dots || width === 0) return false;
    const extent = { x: { low: Infinity, high: -Infinity }, y: { low: Infinity, high: -Infinity } };
    for (const value of dots.x) include(extent.x, value);
    for (const value of dots.y) include(extent.y, value);
    const frame = {
      left: MARGIN.left,
      top: MARGIN.top,
      width: Math.max(1, width - MARGIN.left - MARGIN.right),
      height: Math.max(1, height - MARGIN.top - MARGIN.bottom),
      x: roundRange(extent.x, { span: 0.02 }),
      y: roundRange(extent.y, { span: 0.02 }),
    };
    drawAxes(context, frame, ...dots.names);
    for (const [index, value] of dots.x.entries())
      drawDot(context, 0, toX(frame, value), toY(frame, dots.y[index]), 'plain', dots.x.length > 300);
    return false;
  }
}

/** @param {string} words */
const sentence = (words) => words.charAt(0).toUpperCase() + words.slice(1);
