// Marks beside the run's own dots: impacts to come, runs to compare with, a release that is only offered.

import { axisNameWidth, include, line, toX, toY } from '../axes.js';
import { SANS, theme } from '../theme.js';
import { drawMark } from '../marks.js';

/** @typedef {import('../axes.js').Range} Range */
/** @typedef {{frame: import('../axes.js').Frame, meaning: Record<'x' | 'y', {column: import('../../run/impacts.js').Lasting, name: string}>}} Plot on which they are drawn */
/** @typedef {Record<string, ArrayLike<number | null> | undefined>} Columns of impacts, as `/v1/trajectories` answers */

/**
 * A run to compare with.
 * @typedef {object} Reference
 * @property {Columns} columns
 * @property {number | string} symbol one of ●■◆▲, or its number
 * @property {string} colour of the style sheet, without its dashes, or any other
 * @property {string} label
 */

/**
 * A release that is offered.
 * @typedef {object} Offered
 * @property {{x: number, y: number} | null} at the place of its first impact; null while that is not known
 * @property {boolean} clicked true in the plot that was clicked
 * @property {Columns | null} columns of its own impacts; null while they are awaited
 */

const SYMBOLS = '●■◆▲';
/** Scales stay while what they hold takes more than this share of them. */
const STAYS = 0.45;
/** The radius of a ring, px. */
const RING = 2.2;
/** Width of a mark in the legend, and room after its words, px. */
const MARK = 11;
const APART = 10;
/** Numbers of one run and of its preview differ by no more than this, of their size: they are the same bounce. */
const SAME = 1e-9;

export class Companions {
  /** @type {Reference[]} */
  references = [];
  /** @type {Columns | null} */
  #preview = null;
  /** Impacts of the preview that have a place in this plot. */
  #count = 0;
  /** @type {Offered | null} */
  ghost = null;
  #plot;
  #impacts;
  /** Places of the preview's rings that the run has not reached, for so many impacts. @type {{of: Columns | null, end: number, places: number[]}} */
  #ahead = { of: null, end: -1, places: [] };

  /** @param {Plot} plot @param {import('../../run/impacts.js').Impacts} impacts */
  constructor(plot, impacts) {
    this.#plot = plot;
    this.#impacts = impacts;
  }

  /** @param {Columns | null} columns */
  set preview(columns) {
    this.#preview = columns;
    this.#count = 0;
    const { across, up, count } = this.#pair(columns) ?? { across: [], up: [], count: 0 };
    for (let place = 0; place < count; place += 1) if (across[place] != null && up[place] != null) this.#count += 1;
  }

  /** True while there are rings. */
  get rings() {
    return this.#count > 0 || this.ghost !== null;
  }

  /** The marks in words, for those who do not see them. */
  get words() {
    return [
      ...(this.#count > 0 ? [`Rings: the next ${this.#count} bounces of a fresh release of this setting`] : []),
      ...this.references.map(({ label }) => `Also the dots of ${label}`),
      ...(this.ghost ? ['A release is offered'] : []),
    ];
  }

  /** The two columns of this plot. @param {Columns | null} columns */
  #pair(columns) {
    const { x, y } = this.#plot.meaning;
    const [across, up] = [columns?.[x.column], columns?.[y.column]];
    return across && up ? { across, up, count: Math.min(across.length, up.length) } : null;
  }

  /** Widens the scales by all marks. A ghost does where nothing else is: under a click they would run away. @param {{x: Range, y: Range}} extent */
  extend(extent) {
    this.#hold(extent, this.#preview);
    for (const { columns } of this.references) this.#hold(extent, columns);
    if (extent.x.low > extent.x.high && !this.ghost?.clicked) this.#hold(extent, this.ghost?.columns ?? null);
  }

  /**
   * Scales that stay while rings come and go within them.
   * @param {{x: Range, y: Range}} wanted
   * @param {{x: Range, y: Range}} extent of what there is
   */
  steady(wanted, extent) {
    const { frame } = this.#plot;
    if (!this.rings || frame.width === 0) return wanted;
    /** @param {'x' | 'y'} axis */
    const range = (axis) => {
      const [now, next, held] = [frame[axis], wanted[axis], extent[axis]];
      const holds = now.low <= held.low && now.high >= held.high;
      return holds && next.high - next.low > STAYS * (now.high - now.low) ? now : next;
    };
    return { x: range('x'), y: range('y') };
  }

  /** True when marks of this kind do not need the plot to be drawn anew. @param {string} kind @param {{x: Range, y: Range}} scales */
  fits(kind, { x, y }) {
    const { frame } = this.#plot;
    const same = (/** @type {Range} */ a, /** @type {Range} */ b) => a.low === b.low && a.high === b.high;
    return (kind === 'preview' || kind === 'ghost') && same(x, frame.x) && same(y, frame.y);
  }

  /** @param {{x: Range, y: Range}} extent @param {Columns | null} columns */
  #hold(extent, columns) {
    const { across, up, count } = this.#pair(columns) ?? { across: [], up: [], count: 0 };
    for (let place = 0; place < count; place += 1) {
      const [x, y] = [across[place] ?? NaN, up[place] ?? NaN];
      if (Number.isNaN(x + y)) continue;
      include(extent.x, x);
      include(extent.y, y);
    }
  }

  /** Under the dots. @param {CanvasRenderingContext2D} context */
  drawUnder(context) {
    const { frame } = this.#plot;
    context.lineWidth = 1.5;
    for (const one of this.references) {
      const pair = this.#pair(one.columns);
      context.fillStyle = colourOf(one);
      context.globalAlpha = 0.6;
      for (let place = 0; place < (pair?.count ?? 0); place += 1) {
        const [x, y] = [pair?.across[place] ?? NaN, pair?.up[place] ?? NaN];
        if (Number.isNaN(x + y)) continue;
        drawMark(context, shapeOf(one), toX(frame, x), toY(frame, y), 2.2);
        context.fill();
      }
      context.globalAlpha = 1;
    }
  }

  /** Over the dots: rings, which change more often than those. @param {CanvasRenderingContext2D} context */
  drawOver(context) {
    const { frame } = this.#plot;
    const { ghost } = this;
    const colours = theme();
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.width, frame.height);
    context.clip();
    const pair = this.#pair(ghost ? ghost.columns : this.#preview);
    if (pair) this.#rings(context, pair, ghost ? colours.accent : colours.muted, ghost ? null : this.#toCome());
    if (ghost?.at) {
      const [x, y] = [toX(frame, ghost.at.x), toY(frame, ghost.at.y)];
      context.lineWidth = 2;
      context.strokeStyle = colours.accent;
      context.fillStyle = colours.surface;
      context.setLineDash([4, 3]);
      context.beginPath();
      context.arc(x, y, 8, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      context.setLineDash([]);
      line(context, colours.accent, x - 4, y, x + 4, y);
      line(context, colours.accent, x, y - 4, x, y + 4);
    }
    context.restore();
    this.#legend(context, ghost ? (pair?.count ?? 0) : this.#count);
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {{across: ArrayLike<number | null>, up: ArrayLike<number | null>, count: number}} pair
   * @param {string} colour
   * @param {number[] | null} places all of them where null
   */
  #rings(context, { across, up, count }, colour, places) {
    const { frame } = this.#plot;
    context.beginPath();
    for (let index = 0; index < (places?.length ?? count); index += 1) {
      const place = places?.[index] ?? index;
      const [x, y] = [toX(frame, across[place] ?? NaN), toY(frame, up[place] ?? NaN)];
      if (Number.isNaN(x + y)) continue;
      context.moveTo(x + RING, y);
      context.arc(x, y, RING, 0, 2 * Math.PI);
    }
    context.lineWidth = 1;
    context.strokeStyle = colour;
    context.globalAlpha = 0.7;
    context.stroke();
    context.globalAlpha = 1;
  }

  /** Places of the preview where the run has no dot of its own yet. */
  #toCome() {
    const { begin, end } = this.#impacts;
    if (this.#ahead.of === this.#preview && this.#ahead.end === end) return this.#ahead.places;
    const { x, y } = this.#plot.meaning;
    const { across = [], up = [], count = 0 } = this.#pair(this.#preview) ?? {};
    const numbers = this.#preview?.n;
    const first = end > begin ? this.#impacts.at('n', begin) : Infinity;
    const places = Array.from({ length: count }, (_, place) => place).filter((place) => {
      const own = (numbers?.[place] ?? place + 1) - first + begin;
      return !(
        own >= begin &&
        own < end &&
        alike(this.#impacts.at(x.column, own), across[place]) &&
        alike(this.#impacts.at(y.column, own), up[place])
      );
    });
    this.#ahead = { of: this.#preview, end, places };
    return places;
  }

  /** The names of the marks, left of the name of the axis. @param {CanvasRenderingContext2D} context @param {number} count of rings */
  #legend(context, count) {
    const { frame, meaning } = this.#plot;
    const colours = theme();
    const y = frame.top + frame.height + 27;
    let x = frame.left - 36;
    const room = frame.left + frame.width - axisNameWidth(context, meaning.x.name) - x;
    context.font = `11px ${SANS}`;
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    const widthOf = (/** @type {string} */ words) => MARK + context.measureText(words).width + APART;
    /** @param {(x: number) => void} mark @param {string} words */
    const entry = (mark, words) => {
      mark(x + 4);
      context.fillStyle = colours.muted;
      context.fillText(words, x + MARK, y + 0.5);
      x += widthOf(words);
    };
    if (count > 0) {
      const fresh = this.#impacts.end > 0 ? 'a fresh release' : `next ${count} impacts`;
      const words = this.ghost ? `next ${count} if released here` : fresh;
      const left = this.references.reduce((rest, { label }) => rest - widthOf(label), room);
      // The longest words that leave the name of the axis its place.
      const fitting = [words, `next ${count}`, 'next'].find((one) => widthOf(one) <= left) ?? '';
      entry((at) => {
        context.beginPath();
        context.arc(at, y, RING + 0.6, 0, 2 * Math.PI);
        context.lineWidth = 1;
        context.strokeStyle = this.ghost ? colours.accent : colours.muted;
        context.stroke();
      }, fitting);
    }
    for (const one of this.references)
      entry((at) => {
        drawMark(context, shapeOf(one), at, y, 3);
        context.fillStyle = colourOf(one);
        context.fill();
      }, one.label);
  }
}

/** @param {Reference} reference */
const shapeOf = ({ symbol }) => (typeof symbol === 'number' ? symbol : Math.max(0, SYMBOLS.indexOf(symbol)));

/** @param {Reference} reference */
const colourOf = ({ colour }) => theme()[/** @type {'ink'} */ (colour)] ?? colour;

/** @param {number} a @param {number | null | undefined} b */
const alike = (a, b) => b != null && Math.abs(a - b) <= SAME * Math.max(1, Math.abs(a), Math.abs(b));
