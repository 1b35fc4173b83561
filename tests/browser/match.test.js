// Measured and simulated impacts paired by time: clocks that differ, missed and doubled impacts, clocks and flights that drift apart.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { matchByNumber, matchByTime } from '../../web/panels/measured/match.js';

/** A generator of numbers from 0 to 1, the same in each run of the tests. */
function random(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return state / 2 ** 32;
  };
}

/** Impacts of a swing whose flights are as long as its angle says; the second frequency keeps it from coming back. */
function swing(count, { turn = 0.71, depth = 0.3, stretch = 1 } = {}) {
  const columns = { n: [], t: [], theta: [], x_dot: [], y_dot: [], theta_dot: [] };
  let t = 0.1;
  for (let n = 1; n <= count + 1; n += 1) {
    const [theta, theta_dot] = [0.3 * Math.cos(turn * n), Math.sin(turn * n)];
    if (n > count) return { ...columns, flight: t - columns.t.at(-1) };
    for (const [name, value] of Object.entries({
      n,
      t,
      theta,
      x_dot: 0.9 * theta_dot,
      y_dot: -1 + theta ** 2,
      theta_dot,
    }))
      columns[name].push(value);
    t += stretch * 0.2 * (1 + depth * Math.cos(2 * turn * n) * Math.cos(0.013 * n));
  }
}

/** The simulated impacts as a camera sees them from an offset on; NaN for the states unless it sees them. */
const seen = ({ t, theta, theta_dot }, places, { offset = 0, jitter = () => 0, states = true } = {}) =>
  places.map((place, row) => ({
    n: row + 1,
    t: t[place] + offset + jitter(),
    theta: states ? theta[place] + jitter() : NaN,
    x_dot: NaN,
    y_dot: NaN,
    theta_dot: states ? theta_dot[place] + jitter() : NaN,
  }));

const from = (begin, count, leaveOut = []) =>
  Array.from({ length: count }, (_, index) => begin + index).filter((place) => !leaveOut.includes(place));

test('any offset of the clock is found, with times alone and with states', () => {
  const run = swing(60);
  for (const states of [true, false]) {
    for (const begin of [0, 1, 7, 23]) {
      for (const offset of [0, 3.0362, -17.25, 1.7e9]) {
        const rows = seen(run, from(begin, 30), { offset, states });
        // The numbers of the file begin at 1 wherever the recording does, so they are wrong but for the first case.
        const match = matchByTime(rows, run);
        const pairs = rows.map((_, row) => [row, begin + row]);
        assert.deepEqual(match.pairs, pairs, `states ${states}, from ${begin}, offset ${offset}`);
        assert.ok(Math.abs(match.offset - offset) < 1e-6);
        assert.deepEqual([match.missed, match.extra, match.later, match.alike], [[], [], [], false]);
      }
    }
  }
});

test('missed and doubled impacts are told, at every place and in random mixtures', () => {
  const run = swing(80);
  const next = random(7);
  for (let trial = 0; trial < 200; trial += 1) {
    const begin = Math.floor(next() * 20);
    const inside = from(begin + 1, 38);
    const missed = inside.filter(() => next() < 0.12);
    const offset = (next() - 0.5) * 20;
    const jitter = () => (next() - 0.5) * 0.004;
    const rows = seen(run, from(begin, 40, missed), { offset, jitter });
    const extra = [];
    const all = rows.flatMap((row) => {
      if (next() > 0.05) return [row];
      // A contact that was taken for two, a few milliseconds apart, or a row in the middle of a flight.
      return [row, { ...row, t: row.t + (next() < 0.5 ? 0.008 : 0.09), theta: next() - 0.5, extra: true }];
    });
    for (const [index, row] of all.entries()) if (row.extra) extra.push(index);
    const match = matchByTime(all, run);
    assert.deepEqual(match.missed, missed, `trial ${trial}`);
    assert.deepEqual(match.extra, extra, `trial ${trial}`);
    assert.equal(match.pairs.length, rows.length);
    assert.ok(Math.abs(match.offset - offset) < 0.002, `trial ${trial}: ${match.offset - offset} s`);
  }
});

test('rows out of order and rows without a time', () => {
  const run = swing(30);
  const rows = seen(run, from(3, 20), { offset: 2 });
  const mixed = [...rows.slice(10), { ...rows[0], t: NaN }, ...rows.slice(0, 10)];
  const { pairs, extra, later } = matchByTime(mixed, run);
  assert.deepEqual(
    pairs.map(([row, place]) => [mixed[row].t - 2, place]),
    from(3, 20).map((place) => [run.t[place] + 2 - 2, place]),
  );
  assert.deepEqual([extra, later], [[], []]);
});

test('a clock that runs fast and flights that are longer do not lose the pairs', () => {
  const run = swing(400);
  for (const rate of [1.02, 0.98]) {
    const rows = seen(run, from(4, 390)).map((row) => ({ ...row, t: row.t * rate + 5 }));
    const match = matchByTime(rows, run);
    // In the end the measured clock is several flights off, which one offset for all would take for missed and extra impacts.
    assert.ok(Math.abs(rows.at(-1).t - 5 - run.t[393]) > 4 * 0.2);
    assert.deepEqual([match.missed, match.extra, match.later], [[], [], []], `rate ${rate}`);
    assert.deepEqual(match.pairs[0], [0, 4]);
  }
});

test('where all flights are alike the numbers decide, and this is told', () => {
  const run = swing(60, { depth: 0 });
  const rows = seen(run, from(9, 30), { offset: 1.5, states: false }).map((row, index) => ({ ...row, n: index + 10 }));
  const match = matchByTime(rows, run);
  assert.deepEqual(match.pairs[0], [0, 9]);
  assert.equal(match.alike, true);
  // The states tell what the times do not, against the numbers.
  const told = matchByTime(
    seen(run, from(9, 30), { offset: 1.5 }).map((row, index) => ({ ...row, n: index + 12 })),
    run,
  );
  assert.deepEqual(told.pairs[0], [0, 9]);
  assert.equal(told.alike, false);
});

test('a typed first impact is taken, and a number that is not simulated matches none', () => {
  const run = swing(60);
  const rows = seen(run, from(9, 20), { offset: 1 });
  assert.deepEqual(matchByTime(rows, run, 10).pairs[0], [0, 9]);
  assert.deepEqual(matchByTime(rows, run, 12).pairs[0], [0, 11]);
  const none = matchByTime(rows, run, 1000);
  assert.deepEqual([none.pairs, none.later.length, none.offset], [[], 20, NaN]);
});

test('impacts that are not simulated yet are neither missed nor extra, at any length of the run', () => {
  const whole = swing(50);
  const rows = seen(whole, from(0, 40, [5, 11]), { offset: -4, jitter: () => 0 });
  for (let count = 2; count < 50; count += 1) {
    const match = matchByTime(rows, swing(count));
    assert.deepEqual(match.extra, [], `${count} impacts`);
    assert.equal(match.pairs.length + match.later.length, rows.length);
    for (const [row, place] of match.pairs) assert.ok(Math.abs(rows[row].t + 4 - whole.t[place]) < 1e-12, `${count}`);
    assert.deepEqual(
      match.missed,
      [5, 11].filter((place) => place < count - 1),
      `${count} impacts`,
    );
  }
});

test('a run of another scene is laid beside the measured one as far as it goes, and not at its end', () => {
  // Other flights and another swing: no offset fits well.
  const run = swing(100, { turn: 0.93, depth: 0.2, stretch: 1.1 });
  const rows = seen(swing(60), from(0, 60), { offset: 4 });
  const { pairs, later } = matchByTime(rows, run);
  assert.ok(pairs[0][1] < 30 && pairs.at(-1)[0] > 50, `from ${pairs[0]} to ${pairs.at(-1)}`);
  assert.ok(later.length < 10, `${later.length} not simulated`);
});

test('one simulated impact, one row, and equal times', () => {
  const run = swing(1);
  assert.deepEqual(matchByTime(seen(run, [0], { offset: 9 }), run).pairs, [[0, 0]]);
  const still = {
    n: [1, 2, 3],
    t: [1, 1, 1],
    theta: [0, 0, 0],
    x_dot: [],
    y_dot: [],
    theta_dot: [NaN, NaN, NaN],
    flight: 0,
  };
  const { pairs, extra } = matchByTime(
    [1, 2, 3].map((n) => ({ n, t: 4, theta: 0, x_dot: NaN, y_dot: NaN, theta_dot: NaN })),
    still,
  );
  assert.equal(pairs.length + extra.length, 3);
});

test('by number, gaps in the numbers are missed impacts', () => {
  const run = swing(20);
  const rows = seen(run, from(2, 10, [4]), { offset: 6 }).map((row, index) => ({ ...row, n: from(3, 10, [5])[index] }));
  const match = matchByNumber(rows, run, 3);
  assert.deepEqual(match.missed, [4]);
  assert.equal(match.pairs.length, 9);
  assert.ok(Math.abs(match.offset - 6) < 1e-12);
  assert.equal(matchByNumber(rows, run, 15).later.length, 4);
});
