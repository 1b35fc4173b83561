// Marks beside the run's own dots: impacts to come, runs to compare with, a release that is only offered.

import { axisNameWidth, disc, fontOf, include, line, text, toX, toY } from '../axes.js';
import { quantityOf } from '../../run/quantities.js';
import { drawMark } from '../marks.js';
import { theme } from '../theme.js';

/** @typedef {import('../axes.js').Range} Range */
/** @typedef {{x: Range, y: Range}} Scales */
/** @typedef {import('../../run/run-state.js').RunState} RunState */
/** @typedef {{frame: import('../axes.js').Frame, meaning: Record<'x' | 'y', {column: import('../../run/impacts.js').Lasting}>}} Plot on which they are drawn */
/** @typedef {{n: number, x: number, y: number}} Point an impact by its number, in the values of the axes */

/**
 * A run to compare with.
 * @typedef {object} Reference
 * @property {RunState} run
 * @property {number} [from] the first impact that is shown
 * @property {string} symbol one of ●■◆▲
 * @property {import('../../scene/bodies.js').RodColour} colour
 * @property {string} label
 */

/**
 * A release that is offered.
 * @typedef {object} Offered
 * @property {{x: number, y: number} | null} at the place of its first impact; null while that is not known
 * @property {boolean} clicked true in the plot that was clicked
 * @property {RunState | null} run null while it is awaited
 */

const SYMBOLS = '●■◆▲';
/** The radius of a ring, px. */
const RING = 2.2;
/** Width of a mark in the legend, and room after its words, px. */
const MARK = 11;
const APART = 10;
/** Numbers of one run and of its preview differ by no more than this, of their size: they are the same bounce. */
const SAME = 1e-9;

export class Companions {
  #plot;
  #impacts;
  /** @type {(Reference & {points: Point[]})[]} */
  #references = [];
  /** @type {Point[]} */
  #preview = [];
  /** @type {(Offered & {points: Point[]}) | null} */
  #ghost = null;

  /** @param {Plot} plot @param {import('../../run/impacts.js').Impacts} impacts */
  constructor(plot, impacts) {
    this.#plot = plot;
    this.#impacts = impacts;
  }

  /** @param {RunState | null} run */
  set preview(run) {
    this.#preview = this.#points(run);
  }

  /** @param {Reference[]} references */
  set references(references) {
    this.#references = references.map((one) => ({ ...one, points: this.#points(one.run, one.from) }));
  }

  /** @param {Offered | null} ghost */
  set ghost(ghost) {
    this.#ghost = ghost && { ...ghost, points: this.#points(ghost.run) };
  }

  /** True while there are rings. */
  get rings() {
    return this.#preview.length > 0 || this.#ghost !== null;
  }

  get none() {
    return !this.rings && this.#references.length === 0;
  }

  /** The marks in words, for those who do not see them. */
  get words() {
    const { length } = this.#preview;
    return [
      ...(length > 0 ? [`Rings: the next ${length} bounces of a fresh release of this setting`] : []),
      ...this.#references.map(({ label }) => `Also the dots of ${label}`),
      ...(this.#ghost ? ['A release is offered'] : []),
    ];
  }

  /** The impacts that have a place in this plot. @param {RunState | null} run @param {number} [from] the first of them @returns {Point[]} */
  #points(run, from = 0) {
    const { x, y } = this.#plot.meaning;
    const rows = Array.from({ length: run?.impacts.end ?? 0 }, (_, place) =>
      /** @type {RunState} */ (run).impacts.row(place),
    );
    const points = rows.slice(from).map((row) => ({ n: row.n, x: row[x.column], y: row[y.column] }));
    return points.filter((point) => !Number.isNaN(point.x + point.y));
  }

  /** Widens the scales by all marks. A ghost does where nothing else is: under a click they would run away. @param {Scales} extent */
  extend(extent) {
    const hold = (/** @type {Point[]} */ points) => {
      for (const { x, y } of points) {
        include(extent.x, x);
        include(extent.y, y);
      }
    };
    hold(this.#preview);
    for (const { points } of this.#references) hold(points);
    if (extent.x.low > extent.x.high && this.#ghost && !this.#ghost.clicked) hold(this.#ghost.points);
  }

  /** Under the dots. @param {CanvasRenderingContext2D} context */
  drawUnder(context) {
    const { frame } = this.#plot;
    context.globalAlpha = 0.6;
    for (const one of this.#references)
      for (const { x, y } of one.points)
        drawMark(context, SYMBOLS.indexOf(one.symbol), toX(frame, x), toY(frame, y), 2.2, theme()[one.colour]);
    context.globalAlpha = 1;
  }

  /** Over the dots: rings, which change more often than those. @param {CanvasRenderingContext2D} context */
  drawOver(context) {
    const { frame } = this.#plot;
    const { accent, muted, surface } = theme();
    const ghost = this.#ghost;
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.width, frame.height);
    context.clip();
    context.beginPath();
    for (const point of ghost ? ghost.points : this.#toCome()) {
      const [x, y] = [toX(frame, point.x), toY(frame, point.y)];
      context.moveTo(x + RING, y);
      context.arc(x, y, RING, 0, 2 * Math.PI);
    }
    context.lineWidth = 1;
    context.strokeStyle = ghost ? accent : muted;
    context.globalAlpha = 0.7;
    context.stroke();
    context.globalAlpha = 1;
    if (ghost?.at) {
      const [x, y] = [toX(frame, ghost.at.x), toY(frame, ghost.at.y)];
      context.setLineDash([4, 3]);
      disc(context, x, y, 8, { fill: surface, stroke: accent, width: 2 });
      context.setLineDash([]);
      line(context, accent, x - 4, y, x + 4, y);
      line(context, accent, x, y - 4, x, y + 4);
    }
    context.restore();
    this.#legend(context, (ghost?.points ?? this.#preview).length);
  }

  /** Impacts of the preview where the run has no dot of its own yet. */
  #toCome() {
    const { begin, end } = this.#impacts;
    const { x, y } = this.#plot.meaning;
    const first = end > begin ? this.#impacts.at('n', begin) : Infinity;
    return this.#preview.filter((point) => {
      const own = point.n - first + begin;
      return !(
        own >= begin &&
        own < end &&
        alike(this.#impacts.at(x.column, own), point.x) &&
        alike(this.#impacts.at(y.column, own), point.y)
      );
    });
  }

  /** The names of the marks, left of the name of the axis. @param {CanvasRenderingContext2D} context @param {number} count of rings */
  #legend(context, count) {
    const { frame, meaning } = this.#plot;
    const { accent, muted } = theme();
    const size = 11;
    const y = frame.top + frame.height + 27;
    let x = frame.left - 36;
    const room = frame.left + frame.width - axisNameWidth(context, quantityOf(meaning.x.column).name) - x;
    context.font = fontOf({ size });
    const widthOf = (/** @type {string} */ words) => MARK + context.measureText(words).width + APART;
    /** @param {(x: number) => void} mark @param {string} words */
    const entry = (mark, words) => {
      mark(x + 4);
      text(context, words, x + MARK, y + 0.5, { colour: muted, size, baseline: 'middle' });
      x += widthOf(words);
    };
    if (count > 0) {
      const fresh = this.#impacts.end > 0 ? 'a fresh release' : `next ${count} impacts`;
      const words = this.#ghost ? `next ${count} if released here` : fresh;
      const left = this.#references.reduce((rest, { label }) => rest - widthOf(label), room);
      // The longest words that leave the name of the axis its place.
      const fitting = [words, `next ${count}`, 'next'].find((one) => widthOf(one) <= left) ?? '';
      entry((at) => disc(context, at, y, RING + 0.6, { stroke: this.#ghost ? accent : muted }), fitting);
    }
    for (const one of this.#references)
      entry((at) => drawMark(context, SYMBOLS.indexOf(one.symbol), at, y, 3, theme()[one.colour]), one.label);
  }
}

/** @param {number} a @param {number} b */
const alike = (a, b) => Math.abs(a - b) <= SAME * Math.max(1, Math.abs(a), Math.abs(b));
