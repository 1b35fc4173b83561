// Marks beside the run's own dots: impacts to come, runs to compare with, a release that is only offered.

import { shownUnit } from '../../dom/units.js';
import { quantityOf } from '../../run/quantities.js';
import { include, toX, toY } from '../axes.js';
import { drawMark } from '../marks.js';
import { CanvasView, invalidate } from '../surface.js';

/** An impact by its number, in the values of the axes. @typedef {{n: number, x: number, y: number}} Point */

const SYMBOLS = '●■◆▲';
/** The radius of a ring, px. */
const RING = 2.2;
/** Width of a mark in the legend, and room after its words, px. */
const MARK = 11;
const APART = 10;
const LEGEND = { size: 11 };
/** Numbers of one run and of its preview differ by no more than this, of their size: they are the same bounce. */
const SAME = 1e-9;

/** @param {number} a @param {number} b */
const alike = (a, b) => Math.abs(a - b) <= SAME * Math.max(1, Math.abs(a), Math.abs(b));

/** A plot of impacts, with those of other runs. */
export class ComparingPlot extends CanvasView {
  impacts;
  /** @type {Meaning} */
  meaning;
  /** @type {Frame} */
  frame = { left: 0, top: 0, width: 0, height: 0, x: { low: 0, high: 1 }, y: { low: 0, high: 1 } };
  /** @type {(Reference & {points: Point[]})[]} */
  #references = [];
  /** @type {Point[]} */
  #preview = [];
  /** @type {(Offered & {points: Point[]}) | null} */
  #ghost = null;

  /** @param {HTMLElement} box @param {Impacts} impacts @param {Meaning} meaning */
  constructor(box, impacts, meaning) {
    super(box, 2);
    this.impacts = impacts;
    this.meaning = meaning;
  }

  /** Shows impacts to come, as rings that give way to the dots of the run. @param {RunState | null} run */
  preview(run) {
    this.#preview = this.#points(run);
    invalidate(this);
  }

  /** Shows runs to compare with. @param {Reference[]} references */
  references(references) {
    this.#references = references.map((one) => ({ ...one, points: this.#points(one.run, one.from) }));
    this.redraw();
  }

  /** Shows a release that is only offered. @param {Offered | null} ghost */
  ghost(ghost) {
    this.#ghost = ghost && { ...ghost, points: this.#points(ghost.run) };
    invalidate(this);
  }

  /** True while there are rings. */
  get rings() {
    return this.#preview.length > 0 || this.#ghost !== null;
  }

  /** True while there is nothing but the run itself. */
  get alone() {
    return !this.rings && this.#references.length === 0;
  }

  /** The other runs in words, for those who do not see them. */
  get others() {
    const { length } = this.#preview;
    return [
      ...(length > 0 ? [`Rings: the next ${length} bounces of a fresh release of this setting`] : []),
      ...this.#references.map(({ label }) => `Also the dots of ${label}`),
      ...(this.#ghost ? ['A release is offered'] : []),
    ];
  }

  /** The impacts that have a place in this plot. @param {RunState | null} run @param {number} [from] the first of them */
  #points(run, from = 0) {
    const { x, y } = this.meaning;
    /** @type {Point[]} */
    const points = [];
    for (let place = from; run && place < run.impacts.end; place += 1) {
      const at = (/** @type {Column} */ column) => run.impacts.at(column, place);
      const point = { n: at('n'), x: at(x.column), y: at(y.column) };
      if (!Number.isNaN(point.x + point.y)) points.push(point);
    }
    return points;
  }

  /** Widens scales by the other runs. A ghost does where nothing else is: under a click they would run away. @param {{x: Interval, y: Interval}} extent */
  extendByOthers(extent) {
    const hold = (/** @type {Point[]} */ points) => {
      for (const { x, y } of points) {
        include(extent.x, x);
        include(extent.y, y);
      }
    };
    hold(this.#preview);
    for (const { points } of this.#references) hold(points);
    if (extent.x.low > extent.x.high && this.#ghost && !this.#ghost.at) hold(this.#ghost.points);
  }

  /** Under the dots. @param {Surface} surface */
  drawUnder(surface) {
    const { frame } = this;
    surface.faintly(0.6, () => {
      for (const { symbol, colour, points } of this.#references)
        for (const { x, y } of points)
          drawMark(surface, SYMBOLS.indexOf(symbol), toX(frame, x), toY(frame, y), 2.2, colour);
    });
  }

  /** Over the dots: rings, which change more often than those. @param {Surface} surface */
  drawOver(surface) {
    const { frame } = this;
    const { context } = surface;
    const ghost = this.#ghost;
    surface.within(frame, () => {
      context.beginPath();
      for (const point of ghost?.points ?? this.#toCome()) {
        const [x, y] = [toX(frame, point.x), toY(frame, point.y)];
        context.moveTo(x + RING, y);
        context.arc(x, y, RING, 0, 2 * Math.PI);
      }
      surface.faintly(0.7, () => surface.stroke(ghost ? 'accent' : 'muted'));
      const at = ghost?.at ?? ghost?.points[0];
      if (!at) return;
      const [x, y] = [toX(frame, at.x), toY(frame, at.y)];
      surface.disc(x, y, 8, { fill: 'surface', stroke: 'accent', width: 2, dashes: [4, 3] });
      surface.line('accent', x - 4, y, x + 4, y, { width: 2 });
      surface.line('accent', x, y - 4, x, y + 4, { width: 2 });
    });
    this.#drawLegend(surface, (ghost?.points ?? this.#preview).length);
  }

  /** Impacts of the preview where the run has no dot of its own yet. */
  #toCome() {
    const { begin, end } = this.impacts;
    const { x, y } = this.meaning;
    const first = end > begin ? this.impacts.at('n', begin) : Infinity;
    return this.#preview.filter((point) => {
      const own = point.n - first + begin;
      if (own < begin || own >= end) return true;
      return !alike(this.impacts.at(x.column, own), point.x) || !alike(this.impacts.at(y.column, own), point.y);
    });
  }

  /** The names of the marks, left of the name of the axis. @param {Surface} surface @param {number} count of rings */
  #drawLegend(surface, count) {
    const { frame, meaning } = this;
    const y = frame.top + frame.height + 27;
    let x = frame.left - 36;
    const axis = surface.widthOf(shownUnit(quantityOf(meaning.x.column).name), { italic: true });
    const room = frame.left + frame.width - axis - x;
    const widthOf = (/** @type {string} */ words) => MARK + surface.widthOf(words, LEGEND) + APART;
    const name = (/** @type {string} */ words) => {
      surface.text(words, x + MARK, y + 0.5, { colour: 'muted', ...LEGEND, baseline: 'middle' });
      x += widthOf(words);
    };
    if (count > 0) {
      const fresh = this.impacts.end > 0 ? 'a fresh release' : `next ${count} impacts`;
      const words = this.#ghost ? `next ${count} if released here` : fresh;
      const left = this.#references.reduce((rest, { label }) => rest - widthOf(label), room);
      surface.disc(x + 4, y, RING + 0.6, { stroke: this.#ghost ? 'accent' : 'muted' });
      // The longest words that leave the name of the axis its place.
      name([words, `next ${count}`, 'next'].find((one) => widthOf(one) <= left) ?? '');
    }
    for (const { symbol, colour, label } of this.#references) {
      drawMark(surface, SYMBOLS.indexOf(symbol), x + 4, y, 3, colour);
      name(label);
    }
  }
}
