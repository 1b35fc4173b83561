// The impacts picked out in every chart: ranges of columns, so that those to come are judged alike and an address can hold them.

import { LASTING } from './impacts.js';

/** @typedef {[Lasting, Interval]} Limits */

export class Selection {
  /** The places of the selected impacts, oldest first. @type {number[]} */
  places = [];
  /** None selects nothing. @type {Limits[]} */
  ranges = [];
  changed = () => {};
  #impacts;
  #judged = 0;

  /** @param {Impacts} impacts */
  constructor(impacts) {
    this.#impacts = impacts;
  }

  get active() {
    return this.ranges.length > 0;
  }

  /** The count of the selected impacts in words. */
  get words() {
    return `${this.places.length} of ${this.#impacts.end - this.#impacts.begin} bounces selected`;
  }

  /** @param {Limits[]} ranges */
  set(ranges) {
    this.ranges = ranges;
    this.forget();
    this.update();
    this.changed();
  }

  /** @param {number} place */
  has(place) {
    return this.ranges.every(([column, { low, high }]) => {
      const value = this.#impacts.at(column, place);
      return value >= low && value <= high;
    });
  }

  /** A new run has impacts of its own. */
  forget() {
    this.places = [];
    this.#judged = 0;
  }

  /** Judges the impacts that are new. */
  update() {
    const { begin, end } = this.#impacts;
    if (!this.active) return;
    if (end < this.#judged) this.forget();
    if (this.places[0] < begin) this.places = this.places.filter((place) => place >= begin);
    for (let place = Math.max(begin, this.#judged); place < end; place += 1)
      if (this.has(place)) this.places.push(place);
    this.#judged = end;
  }

  /** The selection's part of the address. */
  query() {
    const ends = this.ranges.flatMap(([column, { low, high }]) => [
      [`brush.${column}.from`, String(low)],
      [`brush.${column}.to`, String(high)],
    ]);
    return new URLSearchParams(ends);
  }

  /** @param {URLSearchParams} params of an address @returns {string[]} what was dropped, in words */
  restore(params) {
    const dropped = [];
    /** @type {Limits[]} */
    const ranges = [];
    const names = [...params.keys()].filter((key) => key.startsWith('brush.')).map((key) => key.split('.')[1]);
    for (const name of new Set(names)) {
      const column = LASTING.find((one) => one === name);
      const [low, high] = ['from', 'to'].map((end) => Number(params.get(`brush.${name}.${end}`)?.trim() || NaN));
      if (column && low <= high) ranges.push([column, { low, high }]);
      else dropped.push(`the selection by “${name.slice(0, 40)}”, which is no range of what bounces have`);
    }
    if (ranges.length > 0 || this.active) this.set(ranges);
    return dropped;
  }
}
