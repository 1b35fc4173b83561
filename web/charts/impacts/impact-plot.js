// A plot with one mark per impact, drawn on without starting over. Its maker gives the meaning of its axes.

import { Figure } from '../figure.js';
import { MARGIN, drawAxes, include, line, roundRange, toX, toY } from '../axes.js';
import { drawDot } from '../marks.js';
import { SANS, theme, onThemeChange } from '../theme.js';
import { invalidate, surfaces } from '../surface.js';

/** @typedef {import('../axes.js').Frame} Frame @typedef {import('./meaning.js').Axis} Axis @typedef {import('./meaning.js').Meaning} Meaning */

/** More dots than these are drawn pixel by pixel, and small. */
export const MANY = 20_000;

export class ImpactPlot {
  figure;
  meaning;
  /** The canvases, the lowest first. @type {import('../surface.js').Surface[]} */
  layers;
  /** @type {Frame} */
  frame = { left: 0, top: 0, width: 0, height: 0, x: { low: 0, high: 1 }, y: { low: 0, high: 1 } };
  /** The impacts that stand out. @type {import('../../run/selection.js').Selection | null} */
  selection = null;
  /** Draws over the dots. @type {((context: CanvasRenderingContext2D) => void) | null} */
  over = null;
  /** The impact that the reader looks at; the newest one without. @type {number | null} */
  #shown = null;
  #impacts;
  #drawn = 0;
  /** @type {number | null} */
  #pointed = null;
  #stale = true;
  /** True while the hint stands where impacts go. */
  #hinting = false;
  /** Draws many dots at once, where that is loaded. @type {typeof import('./dense-dots.js').drawPixels | null} */
  #pixels = null;
  #many = false;
  /** Marks of others than the run; their module comes with the first of them. @type {import('./companions.js').Companions | null} */
  #companions = null;
  /** @type {{x: import('../axes.js').Range, y: import('../axes.js').Range}} */
  #extent = ImpactPlot.#nothing();

  static #nothing() {
    return { x: { low: Infinity, high: -Infinity }, y: { low: Infinity, high: -Infinity } };
  }

  /**
   * @param {import('../../run/impacts.js').Impacts} impacts
   * @param {Meaning} meaning
   */
  constructor(impacts, meaning) {
    this.#impacts = impacts;
    this.meaning = meaning;
    this.figure = new Figure(meaning.id, meaning.title, meaning.about, {
      head: meaning.head,
      rows: () => this.#rows(),
    });
    this.layers = surfaces(this.figure.box, 2, () => this.redraw());
    onThemeChange(() => this.redraw());
  }

  #rows() {
    const rows = [];
    for (let place = this.#impacts.end - 1; place >= this.#impacts.begin && rows.length < 50; place -= 1)
      rows.push(this.meaning.cells(this.#impacts, place));
    return rows;
  }

  /** Everything anew in the next frame. */
  redraw() {
    this.#stale = true;
    invalidate(this);
  }

  clear() {
    this.#extent = ImpactPlot.#nothing();
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

  /** Impacts to come, as rings that give way to the dots of the run. @param {import('./companions.js').Columns | null} columns */
  preview = (columns) => this.#beside('preview', columns);

  /** Runs to compare with. @param {import('./companions.js').Reference[]} references */
  references = (references) => this.#beside('references', references);

  /** A release that is only offered. @param {import('./companions.js').Offered | null} ghost */
  ghost = (ghost) => this.#beside('ghost', ghost);

  /** @param {'preview' | 'references' | 'ghost'} kind @param {any} marks */
  async #beside(kind, marks) {
    const late = await import('./companions.js').catch(() => null);
    if (!late) return;
    this.#companions ??= new late.Companions(this, this.#impacts);
    this.#companions[kind] = marks;
    if (this.#companions.fits(kind, this.#scales()) && this.#hinting === this.#vacant) invalidate(this);
    else this.redraw();
  }

  /** True when there is no dot, nor a ring, nor another run. */
  get #vacant() {
    return this.#impacts.end === 0 && !this.#companions?.rings && !this.#companions?.references.length;
  }

  /** The place of an impact, px. @param {number} place */
  at(place) {
    const { x, y } = this.meaning;
    return [toX(this.frame, this.#impacts.at(x.column, place)), toY(this.frame, this.#impacts.at(y.column, place))];
  }

  /** @param {number} from @returns {boolean} whether all of it lies within the frame */
  #extend(from) {
    let inside = true;
    for (const axis of /** @type {const} */ (['x', 'y'])) {
      const extent = this.#extent[axis];
      for (let place = from; place < this.#impacts.end; place += 1) {
        const value = this.#impacts.at(this.meaning[axis].column, place);
        if (value < extent.low) extent.low = value;
        if (value > extent.high) extent.high = value;
      }
      if (extent.low < this.frame[axis].low || extent.high > this.frame[axis].high) inside = false;
    }
    return inside;
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    const { begin, end } = this.#impacts;
    if (end < this.#drawn) this.#drawn = begin;
    if (!this.#extend(Math.max(begin, this.#drawn)) || this.#hinting !== this.#vacant) this.#stale = true;
    this.selection?.update();
    const many = end - begin > MANY;
    if (many !== this.#many) {
      this.#many = many;
      this.#stale = true;
    }
    if (this.#stale) this.#paper();
    this.#dots(Math.max(begin, this.#drawn), end);
    this.#drawn = end;
    this.#highlight();
    this.figure.name(now_ms, () =>
      [
        end === 0
          ? `${this.meaning.spoken}: nothing yet`
          : `${this.meaning.spoken}. ${end} impacts; the last: ${this.meaning.readout(this.#impacts, end - 1)}`,
        ...(this.#companions?.words ?? []),
      ].join('. '),
    );
    this.figure.list(now_ms);
    return false;
  }

  /** @param {number} from @param {number} to */
  #dots(from, to) {
    const [surface] = this.layers;
    const { selection } = this;
    if (to - from > MANY) {
      if (this.#pixels) return this.#pixels(surface, this, this.#impacts, selection);
      void import('./dense-dots.js').then(
        ({ drawPixels }) => {
          this.#pixels = drawPixels;
          this.redraw();
        },
        () => {},
      );
    }
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

  /** The scales that hold what there is. */
  #scales() {
    const extent = structuredClone(this.#extent);
    for (const { value } of this.meaning.levels?.() ?? []) include(extent.y, value);
    this.#companions?.extend(extent);
    /** @param {'x' | 'y'} axis */
    const range = (axis) => {
      const wish = this.meaning[axis];
      const { low, high } = extent[axis];
      return high >= low
        ? roundRange({ low, high }, wish)
        : roundRange({ low: 0, high: 0 }, { ...wish, span: wish.span || 1 });
    };
    const wanted = { x: range('x'), y: range('y') };
    return this.#companions?.steady(wanted, extent) ?? wanted;
  }

  /** The empty plot with its scales. */
  #paper() {
    const { context, width, height } = this.layers[0];
    const { x, y, hint, lacking, levels } = this.meaning;
    this.frame = {
      left: MARGIN.left,
      top: MARGIN.top,
      width: Math.max(1, width - MARGIN.left - MARGIN.right),
      height: Math.max(1, height - MARGIN.top - MARGIN.bottom),
      ...this.#scales(),
    };
    context.clearRect(0, 0, width, height);
    drawAxes(context, this.frame, x.name, y.name);
    const colours = theme();
    for (const { value, name } of levels?.() ?? []) {
      const at = toY(this.frame, value);
      context.setLineDash([5, 4]);
      line(context, colours.good, this.frame.left, at, this.frame.left + this.frame.width, at);
      context.setLineDash([]);
      context.font = `11px ${SANS}`;
      context.fillStyle = colours.good;
      context.textAlign = 'right';
      context.textBaseline = 'bottom';
      context.fillText(name, this.frame.left + this.frame.width, this.frame.top - 6);
    }
    this.#hinting = this.#vacant;
    const lacks =
      this.#impacts.end > 0 &&
      !(this.#extent.x.high >= this.#extent.x.low && this.#extent.y.high >= this.#extent.y.low);
    if (lacks || this.#hinting) {
      context.font = `12px ${SANS}`;
      context.fillStyle = colours.muted;
      context.textAlign = 'center';
      context.textBaseline = 'middle';
      context.fillText(
        lacks && lacking ? lacking : hint,
        this.frame.left + this.frame.width / 2,
        this.frame.top + this.frame.height / 2 - 14,
        this.frame.width - 16,
      );
    }
    this.#companions?.drawUnder(context);
    this.#drawn = 0;
    this.#stale = false;
  }

  #highlight() {
    const { context, width, height } = this.layers[1];
    context.clearRect(0, 0, width, height);
    this.#companions?.drawOver(context);
    this.over?.(context);
    const { begin, end } = this.#impacts;
    const place = [this.#pointed, this.#shown].find((one) => one !== null && one >= begin && one < end) ?? end - 1;
    if (place < 0) return this.figure.read('');
    const [x, y] = this.at(place);
    const { left, top, width: w, height: h } = this.frame;
    const colours = theme();
    if (Number.isFinite(x) && Number.isFinite(y)) {
      context.lineWidth = 1;
      line(context, colours.muted, left, Math.round(y) + 0.5, left + 5, Math.round(y) + 0.5);
      line(context, colours.muted, Math.round(x) + 0.5, top + h - 5, Math.round(x) + 0.5, top + h);
      if (place === this.#pointed) {
        context.setLineDash([2, 3]);
        line(context, colours.muted, left, y, left + w, y);
        line(context, colours.muted, x, top, x, top + h);
        context.setLineDash([]);
      }
      context.beginPath();
      context.arc(x, y, 5, 0, 2 * Math.PI);
      context.fillStyle = colours.surface;
      context.fill();
      context.lineWidth = 2;
      context.strokeStyle = colours.strike;
      context.stroke();
    }
    this.figure.read(this.meaning.readout(this.#impacts, place));
  }
}
