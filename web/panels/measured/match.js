// Pairs measured with simulated impacts by their times. The clocks of the two differ by an offset, and either may lack impacts.

import { lastUpTo } from '../../run/impacts.js';

/** Largest distance of a measured impact from the simulated one that it is, in flights; as in the fits of the server (`EXPLAINED` in `numbering.rs`). */
const NEAR = 0.3;
/** Measured impacts by which offsets are compared. */
const SAMPLE = 32;
/** Measured impacts, the first ones, of which one at least is a simulated impact. */
const ANCHORS = 4;
/** Simulated impacts, the first ones, that are tried for each of them. */
const TRIED = 4096;
/** Matched impacts whose middle difference is the offset at the next: clocks and flights of a rig and its model drift apart. */
const RECENT = 3;
/** Cost of an impact without a pair; a pair costs 0 to 1, so that any pair is better than none. */
const UNPAIRED = 1;
/** Cost of an impact that is rounding. */
const ROUNDING = 1e-9;

const STATES = /** @type {const} */ (['theta', 'x_dot', 'y_dot', 'theta_dot']);

/** A measured impact in SI units; NaN for a value that is not there. @typedef {Record<'n' | 't' | (typeof STATES)[number], number>} Row */
/** Simulated impacts in columns, all from the first on, and the duration of the flight after the last one, s. @typedef {Record<keyof Row, ArrayLike<number>> & {flight: number}} Simulated */

/**
 * @typedef {object} Match
 * @property {[row: number, place: number][]} pairs indices of the measured and the simulated impact, in the order of time
 * @property {number[]} missed indices of simulated impacts between the first and the last pair that were not measured
 * @property {number[]} extra indices of measured impacts that are no simulated ones
 * @property {number[]} later indices of measured impacts that are not simulated
 * @property {number} offset of the measured clock, s: the median of the differences; NaN without pairs
 * @property {boolean} alike true if the times fit about as well with another offset
 */

/** @param {number[]} values */
function median(values) {
  const sorted = values.toSorted((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** The place of the impact of this number; −1 if it is not there. @param {Simulated} simulated @param {number} n */
const placeOf = ({ t }, n) => (Number.isInteger(n) && n >= 1 && n <= t.length ? n - 1 : -1);

/** Standard deviations of the simulated values, which are the scales of their differences. @param {Simulated} simulated */
const spreads = (simulated) =>
  STATES.map((name) => {
    const values = Array.from(simulated[name]).slice(0, TRIED).filter(Number.isFinite);
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    return Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length);
  });

/** The place of the simulated impact nearest to a time, and the flight on the side of it; else the reason why there is none. @param {Simulated} simulated @param {number} t on the clock of the run, s @returns {{place: number, flight: number} | 'extra' | 'later'} */
function nearest({ t: times, flight: last }, t) {
  const end = times.length - 1;
  const before = lastUpTo((place) => times[place], t, 0, end);
  const from = Math.max(0, before);
  const flight = from < end ? times[from + 1] - times[from] : last;
  const near = NEAR * flight;
  if (before >= 0 && !(t - times[before] > near)) return { place: before, flight };
  if (before < end && times[before + 1] - t <= near) return { place: before + 1, flight };
  return before === end ? 'later' : 'extra';
}

/** A measured impact and the simulated one that it is; `difference` is that of their times, s. @typedef {{row: number, place: number, difference: number, cost: number}} Pair */

/**
 * Follows the measured impacts along the simulated ones from an offset on.
 * @param {Row[]} rows
 * @param {number[]} order indices of the rows in the order of time
 * @param {Simulated} simulated
 * @param {number[]} scales of the states
 * @param {number} offset of the measured clock at the first row, s
 * @param {number} [most] cost of an impact at which it gives up
 */
function follow(rows, order, simulated, scales, offset, most = Infinity) {
  /** @type {Pair[]} */
  const pairs = [];
  const extra = /** @type {number[]} */ ([]);
  const later = /** @type {number[]} */ ([]);
  let apart = 0;
  const total = () => (apart + UNPAIRED * (extra.length + later.length)) / order.length;
  for (const row of order) {
    if (total() > most) break;
    const recent = pairs.slice(-RECENT).map(({ difference }) => difference);
    const local = recent.length > 0 ? median(recent) : offset;
    const t = rows[row].t - local;
    const found = nearest(simulated, t);
    if (typeof found === 'string') {
      (found === 'later' ? later : extra).push(row);
      continue;
    }
    const { place, flight } = found;
    const difference = rows[row].t - simulated.t[place];
    const last = pairs.at(-1);
    if (last && last.place >= place) {
      // Two rows at one impact: the nearer one is it, the other a double.
      if (last.place > place || Math.abs(difference - local) >= Math.abs(last.difference - local)) {
        extra.push(row);
        continue;
      }
      extra.push(last.row);
      apart -= last.cost;
      pairs.pop();
    }
    const terms = [flight > 0 ? ((t - simulated.t[place]) / (NEAR * flight)) ** 2 : 0];
    for (const [state, name] of STATES.entries()) {
      const off = rows[row][name] - simulated[name][place];
      if (!Number.isNaN(off) && scales[state] > 0) terms.push(Math.min(1, (off / scales[state]) ** 2));
    }
    const cost = terms.reduce((sum, term) => sum + term, 0) / terms.length;
    pairs.push({ row, place, difference, cost });
    apart += cost;
  }
  return { pairs, extra, later, apart: apart / order.length, cost: total() };
}

/**
 * Finds the offset of the measured clock with which times and states of the first measured impacts fit the simulated ones best. If times
 * fit about as well with another one, as they do where all flights are alike, the numbers of the impacts decide.
 * @param {Row[]} rows
 * @param {number[]} order indices of the rows in the order of time
 * @param {Simulated} simulated
 * @param {number[]} scales of the states
 */
function findOffset(rows, order, simulated, scales) {
  const sample = order.slice(0, SAMPLE);
  const tried = Math.min(TRIED, simulated.t.length);
  const trial = (/** @type {number} */ offset, /** @type {number} */ most) => {
    const { cost, apart } = follow(rows, sample, simulated, scales, offset, most);
    return { offset, cost, apart };
  };
  const anchors = sample.slice(0, ANCHORS);
  const offsetAt = (/** @type {number} */ row, /** @type {number} */ place) => rows[row].t - simulated.t[place];
  const numbered = anchors.find((row) => placeOf(simulated, rows[row].n) >= 0);
  const hinted =
    numbered === undefined
      ? { offset: NaN, cost: Infinity, apart: 0 }
      : trial(offsetAt(numbered, placeOf(simulated, rows[numbered].n)), Infinity);
  let best = hinted;
  /** @type {(typeof hinted)[]} */
  const others = [];
  for (const row of anchors) {
    for (let place = 0; place < tried; place += 1) {
      const one = trial(offsetAt(row, place), 2 * best.cost + ROUNDING);
      others.push(one);
      if (one.cost < best.cost) best = one;
    }
  }
  // Pairs that are twice as far apart are as good, as errors of measurement go.
  const limit = best.cost + Math.max(best.apart, ROUNDING);
  if (hinted.cost <= limit) best = hinted;
  const flight = (simulated.t[tried - 1] - simulated.t[0] || simulated.flight) / Math.max(1, tried - 1);
  const alike = others.some(({ offset, cost }) => cost <= limit && Math.abs(offset - best.offset) > flight / 2);
  return { offset: best.offset, alike };
}

/**
 * @param {Row[]} rows those without a time are left out
 * @param {Simulated} simulated one impact or more
 * @param {number | null} [first] number of the simulated impact that the first row is; found without it
 * @returns {Match}
 */
export function matchByTime(rows, simulated, first = null) {
  const order = [...rows.keys()].filter((row) => !Number.isNaN(rows[row].t)).sort((a, b) => rows[a].t - rows[b].t);
  const scales = spreads(simulated);
  const { offset, alike } =
    first === null
      ? findOffset(rows, order, simulated, scales)
      : { offset: rows[order[0]].t - (simulated.t[placeOf(simulated, first)] ?? NaN), alike: false };
  if (Number.isNaN(offset)) return matchOf([], [], order);
  const { pairs, extra, later } = follow(rows, order, simulated, scales, offset);
  return matchOf(pairs, extra, later, alike);
}

/**
 * Pairs by the numbers alone.
 * @param {Row[]} rows
 * @param {Simulated} simulated
 * @param {number} first number of the simulated impact that the first row is
 * @returns {Match}
 */
export function matchByNumber(rows, simulated, first) {
  const places = rows.map(({ n }) => placeOf(simulated, n - rows[0].n + first));
  const pairs = places.map((place, row) => ({ row, place, difference: rows[row].t - simulated.t[place], cost: 0 }));
  return matchOf(
    pairs.filter(({ place }) => place >= 0),
    [],
    [...rows.keys()].filter((row) => places[row] < 0),
  );
}

/** @param {Pair[]} pairs @param {number[]} extra @param {number[]} later @param {boolean} [alike] @returns {Match} */
function matchOf(pairs, extra, later, alike = false) {
  const taken = new Set(pairs.map(({ place }) => place));
  const [low, high] = [pairs[0]?.place ?? 0, pairs.at(-1)?.place ?? -1];
  const missed = [];
  for (let place = low; place < high; place += 1) if (!taken.has(place)) missed.push(place);
  const told = pairs.map(({ difference }) => difference).filter((one) => !Number.isNaN(one));
  return {
    pairs: pairs.map(({ row, place }) => [row, place]),
    missed,
    extra: extra.sort((a, b) => a - b),
    later,
    offset: told.length > 0 ? median(told) : NaN,
    alike,
  };
}
