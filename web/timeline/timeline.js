// The time line of the run: its past is scrubbed, stepped through and played like a film; back to now; a fall once more. Flights are in
// closed form, so it asks nothing of the server. Strikes are ticks of the bar while there are few; kicks, changes and the end are marks.

import { disc, line } from '../charts/axes.js';
import { KEY_STEPS } from '../charts/readable/chart-reader.js';
import { CanvasView, invalidate } from '../charts/surface.js';
import { theme } from '../charts/theme.js';
import { h } from '../dom/elements.js';
import { fixed, unbroken } from '../dom/numbers.js';
import { drawMoment, marksOf } from './marks.js';

/** Strikes of a fall that are seen once more, and at how many times real time. */
const LAST_STRIKES = 3;
const SLOW = 0.1;
/** Time by which a strike counts as passed, s. */
const PASSED_S = 1e-6;
/** The longest step of a picture; a tab that was hidden goes on from where it was, s. */
const LONGEST_STEP_S = 0.1;

/** Room at both ends for half the thumb, px. */
const MARGIN = 9;
/** The least distance of ticks, px. */
const APART = 4;
/** A tick that has moved by less is not drawn anew, px. */
const SEEN = 0.5;

export class Timeline extends CanvasView {
  #bar;
  /** @type {import('./marks.js').Mark[]} */
  #marks = [];
  /** The time at which another run parts from this one. @type {number | null} */
  #fork = null;
  /** The drawn ends and the drawn time. */
  #drawn = { begin: 0, end: 0, shown: 0, place: 0 };
  /** The time before a drag, and the end of the bar meanwhile. @type {{past: number | null, end: number} | null} */
  #dragged = null;
  /** Time up to which another run is known that is shown beside this one, s. */
  #beyond = -Infinity;
  #page;
  #run;
  #back = h('button', { type: 'button', id: 'step-back', click: () => this.step(-1) }, 'Back');
  #now = h('button', { type: 'button', id: 'to-now', click: () => this.#comeBack() });
  #told = h('output', { id: 'timeline-told', class: 'told', 'aria-live': 'off' });
  #from = h('span', { id: 'timeline-from', class: 'muted' });
  #moments = h('p', { id: 'timeline-moments', class: 'unseen' });
  /** The impact that the plots mark. @type {number | null} */
  #marked = null;
  /** The last picture of the past that plays. @type {number | null} */
  #drawn_ms = null;
  #told_ms = -Infinity;
  #aria_ms = -Infinity;

  /** @param {HTMLElement} root @param {import('../app/page.js').Page} page */
  constructor(root, page) {
    const bar = h('div', {
      id: 'scrub',
      class: 'scrub',
      role: 'slider',
      tabindex: 0,
      'aria-label': 'Time of the run',
      'aria-describedby': 'timeline-moments',
      'aria-valuenow': 0,
    });
    super(bar, 1);
    this.#bar = bar;
    this.#page = page;
    this.#run = page.run;
    this.#listen();
    root.querySelector('#step')?.before(this.#back);
    root.append(
      h('div', { class: 'scrubbing' }, bar, this.#now),
      h('p', { class: 'timeline-words' }, this.#told, this.#from),
      this.#moments,
    );
    page.run.watch({
      changed: () => this.#changed(),
      struck: () => this.#struck(),
      cleared: () => this.#cleared(),
    });
    this.#changed();
  }

  /** @param {PointerEvent} event */
  #timeAt(event) {
    const { left, width } = this.#bar.getBoundingClientRect();
    const share = (event.clientX - left - MARGIN) / Math.max(1, width - 2 * MARGIN);
    const { begin, end } = this.#ends();
    // The last pixel is the present, which goes on meanwhile.
    return share >= 1 ? Infinity : begin + Math.max(0, share) * (end - begin);
  }

  #listen() {
    const element = this.#bar;
    const run = this.#run;
    element.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || !event.isPrimary || !run.scene) return;
      this.#dragged = { past: run.past, end: this.end };
      element.setPointerCapture(event.pointerId);
      this.seek(this.#timeAt(event));
    });
    element.addEventListener('pointermove', (event) => {
      if (this.#dragged) this.seek(this.#timeAt(event));
    });
    element.addEventListener('pointerup', () => {
      this.#dragged = null;
    });
    element.addEventListener('pointercancel', () => {
      // The finger only scrolled past.
      if (this.#dragged) this.seek(this.#dragged.past ?? Infinity);
      this.#dragged = null;
    });
    element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const strikes = KEY_STEPS[event.key];
      if (strikes === undefined) return;
      this.step(strikes);
      event.preventDefault();
      event.stopPropagation();
    });
  }

  /** Shows where another run parts from this one; null for nowhere. @param {number | null} t s @param {number} [end] time up to which it is known */
  parts(t, end = -Infinity) {
    this.#fork = t;
    this.#beyond = end;
    this.redraw();
  }

  /** True while the past is shown. */
  get active() {
    return this.#run.past !== null;
  }

  /** The first time that can be shown: the release, as long as its impacts are kept. */
  get begin() {
    const { impacts } = this.#run;
    return impacts.end === 0 || impacts.at('n', impacts.begin) === 1 ? 0 : impacts.at('t', impacts.begin);
  }

  /** The last time that can be shown. */
  get end() {
    const { present, phase } = this.#run;
    return phase === 'ended' ? Math.max(present, this.#beyond) : present;
  }

  /** The place of the shown impact; null before the first. */
  get place() {
    const run = this.#run;
    return run.scene && run.impacts.end > 0 ? run.placeAt(run.shown) : null;
  }

  /** True when the run has ended by a fall from its strikes; one in contact is seen while it happens. */
  get #fell() {
    const { fate, outcome } = this.#run;
    return fate === 'fell' && !outcome?.contact;
  }

  /** @param {number} t */
  seek(t) {
    const run = this.#run;
    if (!run.scene) return;
    const { begin, end } = this;
    if (t >= end && end <= run.present) return this.toNow();
    run.past = Math.min(end, Math.max(begin, t));
    run.replayed = 0;
    this.#moved(true);
  }

  toNow() {
    const run = this.#run;
    if (run.past === null) return;
    run.past = null;
    run.replayed = 0;
    this.#moved(true);
  }

  /** Goes on or back. @param {number} by strikes @returns {boolean} false where only the run itself can go on */
  step(by) {
    if (!this.active && by > 0) return false;
    const { impacts, shown } = this.#run;
    const place = impacts.lastUpTo('t', shown + (by > 0 ? PASSED_S : -PASSED_S));
    const next = by > 0 ? place + by : place + by + 1;
    if (next >= impacts.end) this.toNow();
    else this.seek(next < impacts.begin ? this.begin : impacts.at('t', next));
    return true;
  }

  /** Plays or holds the past. @returns {boolean} false in the present, which the run itself plays */
  toggle() {
    if (!this.active) return false;
    this.#play(this.#run.replayed > 0 ? 0 : this.#page.speed);
    return true;
  }

  /** Plays the past at so many times real time; 0 holds it. @param {number} pace */
  #play(pace) {
    this.#run.replayed = pace;
    this.#drawn_ms = null;
    this.#moved(true);
  }

  #comeBack() {
    if (this.active) this.toNow();
    else if (this.#fell) this.replayFall();
  }

  /** Shows the last strikes once more, slowly. */
  replayFall() {
    const { impacts } = this.#run;
    if (impacts.end === 0) return;
    const place = Math.max(impacts.begin, impacts.end - LAST_STRIKES);
    this.seek(place === 0 ? this.begin : impacts.at('t', place));
    this.#play(SLOW);
  }

  /** @param {boolean} jumped the time shown is another one by more than playing on */
  #moved(jumped) {
    const { run, plots, view, controls } = this.#page;
    const place = run.past === null ? null : run.placeAt(run.past);
    if (place !== this.#marked) {
      this.#marked = place;
      for (const plot of plots) plot.show(place);
      view.redraw();
    }
    controls.replay(run.past === null ? null : run.replayed > 0 ? 'plays' : 'stands');
    if (jumped) {
      view.redraw();
      this.redraw();
      this.#offer();
      this.#told_ms = -Infinity;
      this.#aria_ms = -Infinity;
    }
    run.tell('moved');
    invalidate(this);
  }

  #changed() {
    const { run, fields } = this.#page;
    this.#marks = marksOf(run, fields);
    this.#moments.textContent = this.#marks.map(({ n, words }) => `Bounce ${n}: ${words}`).join('. ');
    this.#offer();
    this.redraw();
    this.#told_ms = -Infinity;
  }

  #struck() {
    const { run, fields } = this.#page;
    if (run.interventions.length > this.#marks.length) this.#marks = marksOf(run, fields);
    if (this.#back.disabled) this.#offer();
    // Of a run that stands still this may be the last picture.
    if (run.phase !== 'running') this.#told_ms = -Infinity;
    invalidate(this);
  }

  #cleared() {
    this.#marks = [];
    this.parts(null);
    this.#moved(true);
  }

  #offer() {
    const run = this.#run;
    const past = this.active;
    const replay = !past && this.#fell;
    this.#now.textContent = past ? 'Back to now' : replay ? 'Replay the fall' : 'Now';
    this.#now.setAttribute('aria-disabled', String(!past && !replay));
    this.#back.disabled = run.scene === null || run.impacts.end === 0;
    this.#bar.setAttribute('aria-disabled', String(run.scene === null));
    const first = run.impacts.end > 0 ? run.impacts.at('n', run.impacts.begin) : 1;
    this.#from.textContent = first > 1 ? `Kept from bounce ${fixed(first, 0)} on` : '';
  }

  /** Plays the past on. @param {number} now_ms */
  #advance(now_ms) {
    const run = this.#run;
    if (run.past === null || run.replayed === 0) return;
    const since_s = this.#drawn_ms === null ? 0 : Math.min(LONGEST_STEP_S, (now_ms - this.#drawn_ms) / 1000);
    this.#drawn_ms = now_ms;
    run.past += since_s * run.replayed;
    if (run.past < this.end) this.#moved(false);
    else if (this.end > run.present) this.seek(this.end);
    else this.toNow();
  }

  /** Shows and says the time: at once while the run stands still. @override @param {number} now_ms */
  draw(now_ms) {
    this.#advance(now_ms);
    const moves = this.#run.pace > 0;
    if (!moves || now_ms - this.#told_ms > 100) {
      this.#told_ms = now_ms;
      this.#say(now_ms, moves);
    }
    this.#drawBar();
    return moves || (this.seen && this.#run.phase === 'running');
  }

  /** Draws the bar where something has moved by a visible bit. */
  #drawBar() {
    const { begin, end } = this.#ends();
    const { shown, impacts } = this.#run;
    const { width } = this.layers[0];
    const scale = (width - 2 * MARGIN) / (end - begin);
    const before = this.#drawn;
    const moved = Math.max(Math.abs(end - before.end), Math.abs(begin - before.begin), Math.abs(shown - before.shown));
    if (this.stale || before.place !== impacts.end || moved * scale > SEEN) {
      this.#drawn = { begin, end, shown, place: impacts.end };
      this.#paint(begin, (/** @type {number} */ t) => MARGIN + (Math.min(end, t) - begin) * scale);
    }
  }

  /** @param {number} begin @param {(t: number) => number} x */
  #paint(begin, x) {
    const { context, width, height } = this.layers[0];
    const colours = theme();
    const { impacts, scene, past, shown } = this.#run;
    const y = Math.round(height / 2);
    this.stale = false;
    context.clearRect(0, 0, width, height);
    context.lineWidth = 4;
    context.lineCap = 'round';
    line(context, colours.line, MARGIN, y, width - MARGIN, y);
    if (!scene) return;
    const at = x(shown);
    line(context, colours.accent, MARGIN, y, at, y);
    context.lineCap = 'butt';
    context.lineWidth = 1;
    if ((impacts.end - impacts.begin) * APART < width) {
      for (let place = impacts.begin; place < impacts.end; place += 1) {
        const tick = Math.round(x(impacts.at('t', place))) + 0.5;
        line(context, colours.muted, tick, y + 4, tick, y + 9);
      }
    }
    if (this.#fork !== null && this.#fork >= begin) {
      context.lineWidth = 2;
      line(context, colours.measured, x(this.#fork), y - 9, x(this.#fork), y + 9);
    }
    for (const { t, kind } of this.#marks) drawMoment(context, kind, x(t), y - 8);
    const [fill, stroke] = [colours.accent, colours.surface];
    disc(context, at, y, 7, past === null ? { fill, stroke, width: 2.5 } : { fill: stroke, stroke: fill, width: 2.5 });
  }

  #ends() {
    const { begin, end } = this;
    return { begin, end: Math.max(this.#dragged?.end ?? end, begin + 1e-3) };
  }

  /** @param {number} now_ms @param {boolean} moves */
  #say(now_ms, moves) {
    const run = this.#run;
    const element = this.#bar;
    if (!run.scene) {
      this.#told.textContent = '';
      return;
    }
    const t = Number.isFinite(run.shown) ? run.shown : 0;
    const place = this.place;
    const n = place === null ? 0 : run.impacts.at('n', place);
    const marks = run.past === null ? [] : this.#marks.filter((mark) => mark.n === n && mark.t <= t);
    const here = marks.map(({ words }) => words);
    if (run.past !== null && run.replayed === SLOW) here.push('at a tenth of the speed');
    const whole = [unbroken(`n ${fixed(n, 0)}`), unbroken(`${fixed(t, 2)} s`), ...here].join(' · ');
    if (this.#told.textContent !== whole) this.#told.textContent = whole;
    // A slider that has the focus would be spoken all the time while the run goes on.
    if (moves && (now_ms - this.#aria_ms < 2000 || document.activeElement === element)) return;
    this.#aria_ms = now_ms;
    const { begin, end } = this;
    element.setAttribute('aria-valuemin', begin.toFixed(2));
    element.setAttribute('aria-valuemax', Math.max(begin, end).toFixed(2));
    element.setAttribute('aria-valuenow', t.toFixed(2));
    element.setAttribute('aria-valuetext', `bounce ${[n, `${fixed(t, 2)} s`, ...here].join(', ')}`);
  }
}
