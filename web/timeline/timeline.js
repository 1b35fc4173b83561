// The time line of the run: its past is scrubbed, stepped through and played like a film; back to now; a fall once more. Flights are in
// closed form, so it asks nothing of the server. Strikes are ticks of the bar while there are few; kicks, changes and the end are marks.

import { drawMark } from '../charts/marks.js';
import { KEY_STEPS } from '../charts/readable/chart-reader.js';
import { CanvasView, invalidate } from '../charts/surface.js';
import { drags } from '../dom/drag.js';
import { byId } from '../dom/elements.js';
import { fixed, quantity, unbroken } from '../dom/numbers.js';
import { VELOCITIES } from '../run/interventions.js';

/** Strikes of a fall that are seen once more, and at how many times real time. */
const LAST_STRIKES = 3;
const SLOW = 0.1;
/** Time by which a strike counts as passed, s. */
const PASSED_S = 1e-6;
/** The longest step of a picture; a tab that was hidden goes on from where it was, s. */
const LONGEST_STEP_S = 0.1;
/** Least times between two writings of a time that goes on, and of its spoken value, ms. */
const WRITTEN_MS = 100;
const SPOKEN_MS = 2000;

/** Room at both ends for half the thumb, px. */
const MARGIN = 9;
/** The least distance of ticks, px. */
const APART = 4;
/** A tick that has moved by less is not drawn anew, px. */
const SEEN = 0.5;

/** @typedef {{n: number, t: number, kind: 'kick' | 'set' | 'fell' | 'kept' | 'over', words: string}} Mark */

/** Shape and colour of a moment. */
const MOMENTS = /** @type {const} */ ({
  kick: [3, 'strike'],
  set: [1, 'series-1'],
  kept: [0, 'good'],
  over: [0, 'muted'],
});

/** A kick is a triangle, a change a square, a fall a cross, another end a dot. @param {Surface} surface @param {Mark['kind']} kind @param {number} x @param {number} y */
function drawMoment(surface, kind, x, y) {
  if (kind !== 'fell') return drawMark(surface, MOMENTS[kind][0], x, y, 3, MOMENTS[kind][1]);
  surface.line('strike', x - 4, y + 4, x + 4, y + 12, { width: 2.5 });
  surface.line('strike', x - 4, y + 12, x + 4, y + 4, { width: 2.5 });
}

/** The marks in the order of the run; those of impacts that are not kept are left out. @param {RunState} run @param {Field[]} fields */
function marksOf({ impacts, interventions, outcome, fate }, fields) {
  /** @type {Mark[]} */
  const marks = [];
  for (const { impact: n, set, kick, guide } of interventions) {
    const place = impacts.lastUpTo('n', n);
    if (place < impacts.begin || impacts.at('n', place) !== n) continue;
    const mark = (/** @type {Mark['kind']} */ kind, /** @type {string} */ words) =>
      marks.push({ n, t: impacts.at('t', place), kind, words });
    const kicks = Object.entries(kick).map(([name, by]) => {
      const { unit, sign } = VELOCITIES[name];
      return `${by > 0 ? '+' : ''}${quantity(by, unit)} ${sign}`;
    });
    if (kicks.length > 0) mark('kick', `kick ${kicks.join(', ')}`);
    for (const words of new Set(Object.keys(guide).map((name) => name.split('.')[0]))) mark('set', words);
    const sets = Object.entries(set).map(([path, value]) => {
      const field = fields.find((one) => one.field === path);
      const shown = typeof value === 'number' ? quantity(value, field?.unit ?? null) : value;
      return `${field?.title.toLowerCase() ?? path} ${shown}`;
    });
    if (sets.length > 0) mark('set', sets.join(', '));
  }
  if (outcome && fate) marks.push({ n: outcome.bounces, t: outcome.t, kind: fate, words: 'the end of the run' });
  return marks;
}

/** The time line, for those who step through it and show runs beside this one. @param {Page} page */
export function bringTimeline(page) {
  const { run } = page;
  const { impacts } = run;
  /** @type {Mark[]} */
  let marks = [];
  /** The time at which another run parts from this one, which is shown beside it, and the time up to which it is known, s. @type {{t: number, end: number} | null} */
  let fork = null;
  /** The drawn ends and the drawn time. */
  let drawn = { begin: 0, end: 0, shown: 0, place: 0 };
  /** The time before a drag, and the end of the bar meanwhile. @type {{past: number | null, end: number} | null} */
  let dragged = null;
  /** The last picture of the past that plays. @type {number | null} */
  let drawn_ms = null;
  let told_ms = -Infinity;
  let spoken_ms = -Infinity;
  const bar = byId('scrub');
  const view = new CanvasView(bar, 1);
  const back = byId('step-back', HTMLButtonElement);
  const [now, told, from] = ['to-now', 'timeline-told', 'timeline-from'].map((id) => byId(id));

  /** The first time that can be shown: the release, as long as its impacts are kept. */
  const begin = () => (impacts.end === 0 || impacts.at('n', impacts.begin) === 1 ? 0 : impacts.at('t', impacts.begin));

  /** The last time that can be shown. */
  const end = () => (run.phase === 'ended' ? Math.max(run.present, fork?.end ?? -Infinity) : run.present);

  /** The ends of the bar. */
  const ends = () => ({ low: begin(), high: Math.max(dragged?.end ?? end(), begin() + 1e-3) });

  /** The place of the shown impact; null before the first. */
  const place = () => (run.scene && impacts.end > 0 ? run.placeAt(run.shown) : null);

  /** True when the run has ended by a fall from its strikes; one in contact is seen while it happens. */
  const fell = () => run.fate === 'fell' && !run.outcome?.contact;

  /** @param {number} x px of the bar */
  const timeAt = (x) => {
    const share = (x - MARGIN) / Math.max(1, view.layers[0].width - 2 * MARGIN);
    const { low, high } = ends();
    // The last pixel is the present, which goes on meanwhile.
    return share >= 1 ? Infinity : low + Math.max(0, share) * (high - low);
  };

  /** Shows where another run parts from this one; null for nowhere. @param {number | null} t s @param {number} [known] time up to which it is known */
  const parts = (t, known = -Infinity) => {
    fork = t === null ? null : { t, end: known };
    view.redraw();
  };

  const offer = () => {
    const past = run.past !== null;
    now.textContent = past ? 'Back to now' : fell() ? 'Replay the fall' : 'Now';
    now.setAttribute('aria-disabled', String(!past && !fell()));
    back.disabled = run.scene === null || impacts.end === 0;
    bar.setAttribute('aria-disabled', String(run.scene === null));
    const first = impacts.end > 0 ? impacts.at('n', impacts.begin) : 1;
    from.textContent = first > 1 ? `Kept from bounce ${fixed(first, 0)} on` : '';
  };

  const refresh = () => {
    told_ms = -Infinity;
    offer();
    view.redraw();
  };

  /** Tells that another time is shown. */
  const tellMoved = () => {
    for (const plot of page.plots) plot.show(run.past === null ? null : run.placeAt(run.past));
    page.view.redraw();
    run.tell('moved');
    invalidate(view);
  };

  const jump = () => {
    spoken_ms = -Infinity;
    refresh();
    tellMoved();
  };

  /** Plays the past at so many times real time; 0 holds it. @param {number} pace */
  const play = (pace) => {
    run.replayed = pace;
    drawn_ms = null;
    jump();
  };

  /** @param {number | null} past null for the present */
  const show = (past) => {
    run.past = past;
    play(0);
  };

  const toNow = () => {
    if (run.past !== null) show(null);
  };

  /** @param {number} t */
  const seek = (t) => {
    if (!run.scene) return;
    if (t >= end() && end() <= run.present) toNow();
    else show(Math.min(end(), Math.max(begin(), t)));
  };

  /** Goes on or back. @param {number} by strikes @returns {boolean} false where only the run itself can go on */
  const step = (by) => {
    if (run.past === null && by > 0) return false;
    const last = impacts.lastUpTo('t', run.shown + (by > 0 ? PASSED_S : -PASSED_S));
    const next = by > 0 ? last + by : last + by + 1;
    if (next >= impacts.end) toNow();
    else seek(next < impacts.begin ? begin() : impacts.at('t', next));
    return true;
  };

  /** Plays or holds the past. @returns {boolean} false in the present, which the run itself plays */
  const toggle = () => {
    if (run.past === null) return false;
    play(run.replayed > 0 ? 0 : page.speed);
    return true;
  };

  /** Shows the last strikes of a fall once more, slowly. */
  const replayFall = () => {
    if (impacts.end === 0 || !fell()) return;
    const first = Math.max(impacts.begin, impacts.end - LAST_STRIKES);
    seek(first === 0 ? begin() : impacts.at('t', first));
    play(SLOW);
  };

  /** Plays the past on. @param {number} now_ms */
  const advance = (now_ms) => {
    if (run.past === null || run.replayed === 0) return;
    const since_s = drawn_ms === null ? 0 : Math.min(LONGEST_STEP_S, (now_ms - drawn_ms) / 1000);
    drawn_ms = now_ms;
    run.past += since_s * run.replayed;
    if (run.past < end()) tellMoved();
    else if (end() > run.present) seek(end());
    else toNow();
  };

  /** Draws the bar where something has moved by a visible bit. */
  const drawBar = () => {
    const [surface] = view.layers;
    const { width, height } = surface;
    const { low, high } = ends();
    const { past, shown } = run;
    const scale = (width - 2 * MARGIN) / (high - low);
    const moved = Math.max(Math.abs(high - drawn.end), Math.abs(low - drawn.begin), Math.abs(shown - drawn.shown));
    if (!view.takeStale() && drawn.place === impacts.end && moved * scale <= SEEN) return;
    drawn = { begin: low, end: high, shown, place: impacts.end };
    const x = (/** @type {number} */ t) => MARGIN + (Math.min(high, t) - low) * scale;
    const y = Math.round(height / 2);
    surface.clear();
    surface.line('line', MARGIN, y, width - MARGIN, y, { width: 4, cap: 'round' });
    if (!run.scene) return;
    surface.line('accent', MARGIN, y, x(shown), y, { width: 4, cap: 'round' });
    const few = (impacts.end - impacts.begin) * APART < width;
    for (let at = impacts.begin; few && at < impacts.end; at += 1) {
      const tick = Math.round(x(impacts.at('t', at))) + 0.5;
      surface.line('muted', tick, y + 4, tick, y + 9);
    }
    if (fork && fork.t >= low) surface.line('measured', x(fork.t), y - 9, x(fork.t), y + 9, { width: 2 });
    for (const { t, kind } of marks) drawMoment(surface, kind, x(t), y - 8);
    /** @type {Colour[]} */
    const [fill, stroke] = past === null ? ['accent', 'surface'] : ['surface', 'accent'];
    surface.disc(x(shown), y, 7, { fill, stroke, width: 2.5 });
  };

  /** @param {number} now_ms @param {boolean} moves */
  const say = (now_ms, moves) => {
    const past = run.past !== null;
    const t = Number.isFinite(run.shown) ? run.shown : 0;
    const at = place();
    const n = at === null ? 0 : impacts.at('n', at);
    const here = past ? marks.filter((mark) => mark.n === n && mark.t <= t).map(({ words }) => words) : [];
    if (past && run.replayed === SLOW) here.push('at a tenth of the speed');
    const whole = [unbroken(`n ${fixed(n, 0)}`), unbroken(`${fixed(t, 2)} s`), ...here].join(' · ');
    const words = run.scene ? whole : '';
    if (told.textContent !== words) told.textContent = words;
    // A slider that has the focus would be spoken all the time while the run goes on.
    if (!run.scene || (moves && (now_ms - spoken_ms < SPOKEN_MS || document.activeElement === bar))) return;
    spoken_ms = now_ms;
    bar.setAttribute('aria-valuemin', begin().toFixed(2));
    bar.setAttribute('aria-valuemax', Math.max(begin(), end()).toFixed(2));
    bar.setAttribute('aria-valuenow', t.toFixed(2));
    bar.setAttribute('aria-valuetext', `bounce ${[n, `${fixed(t, 2)} s`, ...here].join(', ')}`);
  };

  // Shows and says the time: at once while the run stands still.
  view.draw = (now_ms) => {
    advance(now_ms);
    const moves = run.pace > 0;
    if (!moves || now_ms - told_ms > WRITTEN_MS) {
      told_ms = now_ms;
      say(now_ms, moves);
    }
    drawBar();
    return moves || (view.seen && run.phase === 'running');
  };

  const changed = () => {
    marks = marksOf(run, page.fields);
    byId('timeline-moments').textContent = marks.map(({ n, words }) => `Bounce ${n}: ${words}`).join('. ');
    refresh();
  };

  bar.addEventListener('keydown', (event) => {
    const strikes = event.ctrlKey || event.metaKey || event.altKey ? undefined : KEY_STEPS[event.key];
    if (strikes === undefined) return;
    step(strikes);
    event.preventDefault();
    event.stopPropagation();
  });
  drags(bar, bar, 0, {
    press: ({ x }) => {
      if (!run.scene) return false;
      dragged = { past: run.past, end: end() };
      seek(timeAt(x));
      return true;
    },
    drag: ({ x }) => seek(timeAt(x)),
    release: () => {
      dragged = null;
    },
    // The finger only scrolled past.
    cancel: () => {
      seek(dragged?.past ?? Infinity);
      dragged = null;
    },
  });
  back.onclick = () => step(-1);
  now.onclick = () => (run.past === null ? replayFall() : toNow());
  run.watch({
    changed,
    struck: () => {
      if (run.interventions.length > marks.length) marks = marksOf(run, page.fields);
      if (back.disabled) offer();
      // This may be the last picture of a run that stands still.
      if (run.phase !== 'running') told_ms = -Infinity;
      invalidate(view);
    },
    cleared: () => {
      marks = [];
      fork = null;
      jump();
    },
  });
  changed();
  return { place, parts, step, toggle, toNow, replayFall };
}
