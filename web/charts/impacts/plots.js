// The plots of a run's impacts: two phase planes and the energy, with one mark per impact, drawn on without starting over.

import { makeFigure } from '../figure.js';
import { MARGIN, drawAxes, include, roundRange, toX, toY } from '../axes.js';
import { drawDot, drawPixels } from '../marks.js';
import { invalidate } from '../surface.js';
import { paced } from '../../dom/debounce.js';
import { fixedIn, fixedQuantity, number } from '../../dom/numbers.js';
import { derivedOf } from '../../physics/body.js';
import { angleStart, velocityStart } from '../../physics/first-impact.js';
import { quantityOf } from '../../run/quantities.js';
import { ComparingPlot } from './companions.js';

const AXES = /** @type {const} */ (['x', 'y']);
/** More dots than these are drawn pixel by pixel, and small. */
const MANY = 20_000;
/** Least time between two drawings of new impacts, ms. */
const PACE_MS = 100;
/** Scales stay while what they hold takes more than this share of them. */
const STAYS = 0.45;

const nothing = () => ({ x: { low: Infinity, high: -Infinity }, y: { low: Infinity, high: -Infinity } });

export class ImpactPlot extends ComparingPlot {
  figure;
  /** The impacts that stand out. @type {import('../../run/selection.js').Selection | null} */
  selection = null;
  /** Draws over the dots. @type {((surface: Surface) => void) | null} */
  over = null;
  /** There are new impacts. */
  struck = paced(PACE_MS, () => invalidate(this));
  /** The impact that the reader looks at; the newest one without. @type {number | null} */
  #shown = null;
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
    const figure = makeFigure(meaning.id, meaning.title, meaning.about, columns, (most) => {
      const { begin, end } = impacts;
      return Array.from({ length: Math.min(most, end - begin) }, (_, row) =>
        listed.map((column) => {
          const { unit } = quantityOf(column);
          const value = impacts.at(column, end - 1 - row);
          return unit === '1' ? value : fixedIn(value, unit, column === 't' ? 4 : 6);
        }),
      );
    });
    super(figure.box, impacts, meaning);
    this.figure = figure;
  }

  /** An impact in words. @param {number} place */
  readout(place) {
    const { x, y } = this.meaning;
    const axes = [x.column, y.column].filter((column) => column !== 'n');
    const own = axes.map((column) => {
      const { sign, unit, decimals } = quantityOf(column);
      return `${sign} ${fixedQuantity(this.impacts.at(column, place), unit, decimals)}`;
    });
    return [`n ${this.impacts.at('n', place)}`, ...own].join('   ');
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

  /** The place of an impact, px. @param {number} place */
  at(place) {
    const { x, y } = this.meaning;
    return [toX(this.frame, this.impacts.at(x.column, place)), toY(this.frame, this.impacts.at(y.column, place))];
  }

  /** @override */
  draw() {
    const { begin, end } = this.impacts;
    if (end < this.#drawn) this.#drawn = begin;
    this.#extend(Math.max(begin, this.#drawn));
    this.selection?.update();
    const many = end - begin > MANY;
    const vacant = end === 0 && this.alone;
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
        ...this.others,
      ].join('. '),
    );
    this.figure.list();
    return false;
  }

  /** @param {number} from the first impact that is new */
  #extend(from) {
    for (const axis of AXES) {
      const extent = this.#extent[axis];
      for (let place = from; place < this.impacts.end; place += 1)
        include(extent, this.impacts.at(this.meaning[axis].column, place));
    }
  }

  /** @param {number} from @param {number} to */
  #dots(from, to) {
    const [surface] = this.layers;
    const { selection } = this;
    const { frame, impacts, meaning } = this;
    if (to - from > MANY) return drawPixels(surface, frame, impacts, [meaning.x.column, meaning.y.column], selection);
    for (let place = from; place < to; place += 1) {
      const [x, y] = this.at(place);
      if (Number.isNaN(x) || Number.isNaN(y)) continue;
      const look = !selection?.active ? 'plain' : selection.has(place) ? 'selected' : 'receded';
      drawDot(surface, this.impacts.at('series', place), x, y, look, this.#many);
    }
  }

  /** The scales that hold what there is: those of now while that fits well, since rings and dots come and go. */
  #scales() {
    const extent = structuredClone(this.#extent);
    for (const { value } of this.meaning.levels?.() ?? []) include(extent.y, value);
    this.extendByOthers(extent);
    const { frame } = this;
    const stays = frame.width > 0 && (!this.stale || this.rings);
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

  /** The empty plot. @param {Pick<Frame, 'x' | 'y'>} scales */
  #paper(scales) {
    const [paper] = this.layers;
    const { x, y, hint, lacking, levels } = this.meaning;
    const { left, top } = MARGIN;
    const width = Math.max(1, paper.width - left - MARGIN.right);
    const height = Math.max(1, paper.height - top - MARGIN.bottom);
    this.frame = { left, top, width, height, ...scales };
    paper.clear();
    drawAxes(paper, this.frame, quantityOf(x.column).name, quantityOf(y.column).name);
    const right = left + width;
    for (const { value, name } of levels?.() ?? []) {
      const at = toY(this.frame, value);
      paper.line('good', left, at, right, at, { dashes: [5, 4] });
      paper.text(name, right, top - 6, { colour: 'good', size: 11, align: 'right', baseline: 'bottom' });
    }
    const lacks = this.impacts.end > 0 && AXES.some((axis) => !(this.#extent[axis].high >= this.#extent[axis].low));
    if (lacks || this.#hinting)
      paper.text(lacks && lacking ? lacking : hint, left + width / 2, top + height / 2 - 14, {
        colour: 'muted',
        size: 12,
        align: 'center',
        baseline: 'middle',
        widest: width - 16,
      });
    this.drawUnder(paper);
    this.#drawn = 0;
    this.stale = false;
  }

  #highlight() {
    const over = this.layers[1];
    over.clear();
    this.drawOver(over);
    this.over?.(over);
    const { begin, end } = this.impacts;
    const place = [this.#pointed, this.#shown].find((one) => one !== null && one >= begin && one < end) ?? end - 1;
    if (place < 0) return this.figure.read('');
    const [x, y] = this.at(place);
    if (Number.isFinite(x) && Number.isFinite(y)) {
      const { left, top, width, height } = this.frame;
      const [right, bottom] = [left + width, top + height];
      const [column, row] = [Math.round(x) + 0.5, Math.round(y) + 0.5];
      over.line('muted', left, row, left + 5, row);
      over.line('muted', column, bottom - 5, column, bottom);
      if (place === this.#pointed) {
        over.line('muted', left, y, right, y, { dashes: [2, 3] });
        over.line('muted', x, top, x, bottom, { dashes: [2, 3] });
      }
      over.disc(x, y, 5, { fill: 'surface', stroke: 'strike', width: 2 });
    }
    this.figure.read(this.readout(place));
  }
}

const HINT = 'Every bounce becomes a dot here';

/** @param {Impacts} impacts */
export const anglePlane = (impacts) =>
  new ImpactPlot(impacts, {
    id: 'plane-angle',
    start: angleStart,
    title: 'Angle ⟨θ, θ̇⟩',
    about: 'Tilt and spin just before each bounce. A closed loop is balance.',
    hint: HINT,
    lacking: 'A point mass has no spin',
    spoken: 'Phase plane of angle θ and angular velocity θ̇',
    x: { column: 'theta', symmetric: true, span: 0.04 },
    y: { column: 'theta_dot', symmetric: true, span: 0.1 },
    listed: ['theta', 'theta_dot', 'alpha'],
  });

/** @param {Impacts} impacts */
export const velocityPlane = (impacts) =>
  new ImpactPlot(impacts, {
    id: 'plane-velocity',
    start: velocityStart,
    title: 'Velocity ⟨ẋ, ẏ⟩',
    about: 'Velocity of the centre of gravity just before each bounce.',
    hint: HINT,
    spoken: 'Phase plane of the velocities ẋ and ẏ of the centre of gravity',
    x: { column: 'x_dot', symmetric: true, span: 0.04 },
    y: { column: 'y_dot', span: 0.02 },
    listed: ['x_dot', 'y_dot', 'contact_velocity'],
  });

/**
 * The energy at the impacts, with its target.
 * @param {Impacts} impacts
 * @param {() => Scene | null} scene with what follows from it
 */
export function energyPlot(impacts, scene) {
  /** The wanted energy G·y* with energy feedback; the first energy where a bounce keeps it. */
  const levels = () => {
    const now = scene();
    if (!now) return [];
    const { target } = derivedOf(now);
    if (target) return [{ value: target.energy, name: `target G y* = ${number(target.energy)} m²/s²` }];
    const first = impacts.end > 0 ? impacts.at('energy', impacts.begin) : NaN;
    return Number.isFinite(first) && now.table?.strike !== 'still'
      ? [{ value: first, name: `released with ${number(first)} m²/s²` }]
      : [];
  };
  return new ImpactPlot(impacts, {
    id: 'energy',
    title: 'Energy',
    about: 'Per unit mass just before each bounce, with its target.',
    hint: 'One dot per bounce, with its target',
    spoken: 'Energy per unit mass at each impact',
    levels,
    x: { column: 'n', from: 0, span: 16 },
    y: { column: 'energy', span: 0.4 },
    listed: ['energy', 'flight_time'],
  });
}
