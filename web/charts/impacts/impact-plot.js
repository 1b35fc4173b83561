// A plot with one mark per impact, drawn on without starting over. Its maker gives the meaning of its axes.

import { Figure } from '../figure.js';
import { MARGIN, disc, drawAxes, include, line, roundRange, text, toX, toY } from '../axes.js';
import { drawDot } from '../marks.js';
import { theme } from '../theme.js';
import { CanvasView, invalidate } from '../surface.js';
import { paced } from '../../dom/debounce.js';
import { fixedIn, fixedQuantity } from '../../dom/numbers.js';
import { quantityOf } from '../../run/quantities.js';
import { Companions } from './companions.js';
import { drawPixels } from './dense-dots.js';

/** @typedef {import('../axes.js').Frame} Frame */
/** @typedef {import('../../run/impacts.js').Impacts} Impacts */
/** @typedef {import('../../run/impacts.js').Column} Column */

/**
 * @typedef {object} Axis
 * @property {import('../../run/impacts.js').Lasting} column
 * @property {boolean} [symmetric] about zero
 * @property {number} [span] least span, so that rounding does not look like motion
 * @property {number} [from] a low end that stays
 */

/**
 * @typedef {object} Meaning
 * @property {string} id
 * @property {string} title
 * @property {string | Node} about
 * @property {Axis} x
 * @property {Axis} y
 * @property {Column[]} listed in the table of its numbers, after the bounce and its time
 * @property {string} hint while there is nothing
 * @property {string} [lacking] when impacts have no such values
 * @property {string} spoken what it shows, for those who do not see it
 * @property {() => {value: number, name: string}[]} [levels] horizontal lines worth comparing with
 * @property {'angle' | 'velocity'} [start] which part of a first impact a place in it is
 */

const AXES = /** @type {const} */ (['x', 'y']);
/** More dots than these are drawn pixel by pixel, and small. */
const MANY = 20_000;
/** Least time between two drawings of new impacts, ms. */
const PACE_MS = 100;
/** Scales stay while what they hold takes more than this share of them. */
const STAYS = 0.45;

const nothing = () => ({ x: { low: Infinity, high: -Infinity }, y: { low: Infinity, high: -Infinity } });

export class ImpactPlot extends CanvasView {
  figure;
  meaning;
  /** @type {Frame} */
  frame = { left: 0, top: 0, width: 0, height: 0, x: { low: 0, high: 1 }, y: { low: 0, high: 1 } };
  /** The impacts that stand out. @type {import('../../run/selection.js').Selection | null} */
  selection = null;
  /** Draws over the dots. @type {((context: CanvasRenderingContext2D) => void) | null} */
  over = null;
  /** There are new impacts. */
  struck = paced(PACE_MS, () => invalidate(this));
  #companions;
  /** The impact that the reader looks at; the newest one without. @type {number | null} */
  #shown = null;
  #impacts;
  #drawn = 0;
  /** @type {number | null} */
  #pointed = null;
  /** True while the hint stands where impacts go. */
  #hinting = false;
  #many = false;
  #extent = nothing();

  /** @param {Impacts} impacts @param {Meaning} meaning */
  constructor(impacts, meaning) {
    /** @type {Column[]} */
    const listed = ['n', 't', ...meaning.listed];
    const columns = listed.map((column) => quantityOf(column).name);
    const figure = new Figure(meaning.id, meaning.title, meaning.about, columns, (most) => {
      const { begin, end } = impacts;
      return Array.from({ length: Math.min(most, end - begin) }, (_, row) =>
        listed.map((column) => {
          const { unit } = quantityOf(column);
          const value = impacts.at(column, end - 1 - row);
          return unit === '1' ? value : fixedIn(value, unit, column === 't' ? 4 : 6);
        }),
      );
    });
    super(figure.box, 2);
    this.figure = figure;
    this.#impacts = impacts;
    this.meaning = meaning;
    this.#companions = new Companions(this, impacts);
  }

  /** An impact in words. @param {number} place */
  readout(place) {
    const { x, y } = this.meaning;
    const axes = [x.column, y.column].filter((column) => column !== 'n');
    const own = axes.map((column) => {
      const { sign, unit, decimals } = quantityOf(column);
      return `${sign} ${fixedQuantity(this.#impacts.at(column, place), unit, decimals)}`;
    });
    return [`n ${this.#impacts.at('n', place)}`, ...own].join('   ');
  }

  clear() {
    this.#extent = nothing();
    this.#pointed = null;
    this.#shown = null;
    this.#drawn = 0;
    this.redraw();
  }

  /** @param {number | null} place */
  point(place) {
    if (place === this.#pointed) return;
    this.#pointed = place;
    invalidate(this);
  }

  /** Marks the impact of the time shown, in place of the newest. @param {number | null} place */
  show(place) {
    if (place === this.#shown) return;
    this.#shown = place;
    invalidate(this);
  }

  /** Impacts to come, as rings that give way to the dots of the run. @param {import('./companions.js').RunState | null} run */
  preview(run) {
    this.#companions.preview = run;
    invalidate(this);
  }

  /** Runs to compare with. @param {import('./companions.js').Reference[]} references */
  references(references) {
    this.#companions.references = references;
    this.redraw();
  }

  /** A release that is only offered. @param {import('./companions.js').Offered | null} ghost */
  ghost(ghost) {
    this.#companions.ghost = ghost;
    invalidate(this);
  }

  /** The place of an impact, px. @param {number} place */
  at(place) {
    const { x, y } = this.meaning;
    return [toX(this.frame, this.#impacts.at(x.column, place)), toY(this.frame, this.#impacts.at(y.column, place))];
  }

  /** @override */
  draw() {
    const { begin, end } = this.#impacts;
    if (end < this.#drawn) this.#drawn = begin;
    this.#extend(Math.max(begin, this.#drawn));
    this.selection?.update();
    const many = end - begin > MANY;
    const vacant = end === 0 && this.#companions.none;
    const scales = this.#scales();
    const { frame } = this;
    const moved = AXES.some((axis) => scales[axis].low !== frame[axis].low || scales[axis].high !== frame[axis].high);
    if (this.stale || moved || many !== this.#many || vacant !== this.#hinting) {
      this.#many = many;
      this.#hinting = vacant;
      this.#paper(scales);
    }
    this.#dots(Math.max(begin, this.#drawn), end);
    this.#drawn = end;
    this.#highlight();
    const { spoken } = this.meaning;
    this.figure.name(() =>
      [
        end === 0 ? `${spoken}: nothing yet` : `${spoken}. ${end} impacts; the last: ${this.readout(end - 1)}`,
        ...this.#companions.words,
      ].join('. '),
    );
    this.figure.list();
    return false;
  }

  /** @param {number} from the first impact that is new */
  #extend(from) {
    for (const axis of AXES) {
      const extent = this.#extent[axis];
      for (let place = from; place < this.#impacts.end; place += 1)
        include(extent, this.#impacts.at(this.meaning[axis].column, place));
    }
  }

  /** @param {number} from @param {number} to */
  #dots(from, to) {
    const [surface] = this.layers;
    const { selection } = this;
    if (to - from > MANY) return drawPixels(surface, this, this.#impacts);
    for (let place = from; place < to; place += 1) {
      const [x, y] = this.at(place);
      if (Number.isNaN(x) || Number.isNaN(y)) continue;
      drawDot(
        surface.context,
        this.#impacts.at('series', place),
        x,
        y,
        !selection?.active ? 'plain' : selection.has(place) ? 'selected' : 'receded',
        this.#many,
      );
    }
  }

  /** The scales that hold what there is: those of now while that fits well, since rings and dots come and go. */
  #scales() {
    const extent = structuredClone(this.#extent);
    for (const { value } of this.meaning.levels?.() ?? []) include(extent.y, value);
    this.#companions.extend(extent);
    const { frame } = this;
    const stays = frame.width > 0 && (!this.stale || this.#companions.rings);
    /** @param {'x' | 'y'} axis */
    const range = (axis) => {
      const wish = this.meaning[axis];
      const held = extent[axis];
      const wanted =
        held.high >= held.low
          ? roundRange(held, wish)
          : roundRange({ low: 0, high: 0 }, { ...wish, span: wish.span || 1 });
      const now = frame[axis];
      const fits = now.low <= held.low && now.high >= held.high;
      return stays && fits && wanted.high - wanted.low > STAYS * (now.high - now.low) ? now : wanted;
    };
    return { x: range('x'), y: range('y') };
  }

  /** The empty plot. @param {{x: import('../axes.js').Range, y: import('../axes.js').Range}} scales */
  #paper(scales) {
    const [{ context, width: all, height: high }] = this.layers;
    const { x, y, hint, lacking, levels } = this.meaning;
    const { left, top } = MARGIN;
    const width = Math.max(1, all - left - MARGIN.right);
    const height = Math.max(1, high - top - MARGIN.bottom);
    this.frame = { left, top, width, height, ...scales };
    context.clearRect(0, 0, all, high);
    drawAxes(context, this.frame, quantityOf(x.column).name, quantityOf(y.column).name);
    const { good, muted } = theme();
    for (const { value, name } of levels?.() ?? []) {
      const at = toY(this.frame, value);
      line(context, good, left, at, left + width, at, [5, 4]);
      text(context, name, left + width, top - 6, { colour: good, size: 11, align: 'right', baseline: 'bottom' });
    }
    const lacks = this.#impacts.end > 0 && AXES.some((axis) => !(this.#extent[axis].high >= this.#extent[axis].low));
    if (lacks || this.#hinting)
      text(context, lacks && lacking ? lacking : hint, left + width / 2, top + height / 2 - 14, {
        colour: muted,
        size: 12,
        align: 'center',
        baseline: 'middle',
        widest: width - 16,
      });
    this.#companions.drawUnder(context);
    this.#drawn = 0;
    this.stale = false;
  }

  #highlight() {
    const { context, width, height } = this.layers[1];
    context.clearRect(0, 0, width, height);
    this.#companions.drawOver(context);
    this.over?.(context);
    const { begin, end } = this.#impacts;
    const place = [this.#pointed, this.#shown].find((one) => one !== null && one >= begin && one < end) ?? end - 1;
    if (place < 0) return this.figure.read('');
    const [x, y] = this.at(place);
    const { left, top, width: w, height: h } = this.frame;
    const { muted, surface, strike } = theme();
    if (Number.isFinite(x) && Number.isFinite(y)) {
      context.lineWidth = 1;
      line(context, muted, left, Math.round(y) + 0.5, left + 5, Math.round(y) + 0.5);
      line(context, muted, Math.round(x) + 0.5, top + h - 5, Math.round(x) + 0.5, top + h);
      if (place === this.#pointed) {
        line(context, muted, left, y, left + w, y, [2, 3]);
        line(context, muted, x, top, x, top + h, [2, 3]);
      }
      disc(context, x, y, 5, { fill: surface, stroke: strike, width: 2 });
    }
    this.figure.read(this.readout(place));
  }
}
