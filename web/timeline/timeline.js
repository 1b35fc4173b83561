// The time line of the run: scrub, step back and on, play the past, come back to now, see a fall once more.

import { invalidate } from '../charts/surface.js';
import { h } from '../dom/elements.js';
import { fixed, unbroken } from '../dom/numbers.js';
import { Playback } from './playback.js';
import { marksOf } from './run-marks.js';
import { ScrubBar } from './scrub-bar.js';

/**
 * @typedef {object} TimelineParts
 * @property {import('../run/run.js').Run} run
 * @property {import('../scene/scene-view.js').SceneView} view
 * @property {import('../charts/impacts/impact-plot.js').ImpactPlot[]} plots
 * @property {import('../run/controls.js').RunControls} controls
 * @property {import('../api/scene-fields.js').Field[]} fields
 * @property {() => number} speed chosen by the reader, in times real time
 */

/** Strikes of a fall that are seen once more, and at how many times real time. */
const LAST_STRIKES = 3;
const SLOW = 0.1;

export class Timeline {
  bar;
  playback;
  /** Reacts to another time or another run shown. @type {Set<() => void>} */
  listeners = new Set();
  #parts;
  #back = h('button', { type: 'button', id: 'step-back', click: () => this.step(-1) }, 'Back');
  #now = h('button', { type: 'button', id: 'to-now' }, 'Now');
  #told = h('output', { id: 'timeline-told', class: 'told', 'aria-live': 'off' });
  #from = h('span', { id: 'timeline-from', class: 'muted' });
  #moments = h('p', { id: 'timeline-moments', class: 'unseen' });
  /** The impact that the plots mark. @type {number | null} */
  #marked = null;
  #told_ms = -Infinity;
  #aria_ms = -Infinity;

  /** @param {HTMLElement} root @param {TimelineParts} parts */
  constructor(root, parts) {
    const { run } = parts;
    this.#parts = parts;
    this.playback = new Playback(run, (jumped) => this.#moved(jumped));
    this.bar = new ScrubBar(run, this.playback);
    this.bar.element.setAttribute('aria-describedby', this.#moments.id);
    root.querySelector('#step')?.before(this.#back);
    root.append(
      h('div', { class: 'scrubbing' }, this.bar.element, this.#now),
      h('p', { class: 'timeline-words' }, this.#told, this.#from),
      this.#moments,
    );
    this.#now.addEventListener('click', () => {
      if (this.playback.active) this.toNow();
      else if (this.#fell) this.replayFall();
    });
    run.watch({
      changed: () => this.#changed(),
      struck: () => this.#struck(),
      cleared: () => this.#cleared(),
    });
    this.#changed();
  }

  /** True when the run has ended by a fall from its strikes; one in contact is seen while it happens. */
  get #fell() {
    const { fate, outcome } = this.#parts.run;
    return fate === 'fell' && !outcome?.contact;
  }

  /** Plays or holds the past. @returns {boolean} false in the present, which the run itself plays */
  toggle() {
    const { run, speed } = this.#parts;
    if (!this.playback.active) return false;
    this.playback.play(run.replayed > 0 ? 0 : speed());
    return true;
  }

  /** @param {number} by strikes @returns {boolean} false where only the run itself can go on */
  step(by) {
    if (!this.playback.active && by > 0) return false;
    this.playback.step(by);
    return true;
  }

  toNow() {
    this.playback.toNow();
  }

  /** Shows the last strikes once more, slowly. */
  replayFall() {
    const { impacts } = this.#parts.run;
    const place = Math.max(impacts.begin, impacts.end - LAST_STRIKES);
    if (impacts.end === 0) return;
    this.playback.seek(place === 0 ? this.playback.begin : impacts.at('t', place));
    this.playback.play(SLOW);
  }

  /** The place of the shown impact; null before the first. */
  get place() {
    const { run } = this.#parts;
    return run.scene && run.impacts.end > 0 ? run.placeAt(run.shown) : null;
  }

  /** @param {boolean} jumped */
  #moved(jumped) {
    const { run, plots, view, controls } = this.#parts;
    const place = run.past === null ? null : run.placeAt(run.past);
    if (place !== this.#marked) {
      this.#marked = place;
      for (const plot of plots) plot.show(place);
      view.redraw();
    }
    controls.replay(run.past === null ? null : run.replayed > 0 ? 'plays' : 'stands');
    if (jumped) {
      view.redraw();
      this.bar.redraw();
      this.#offer();
      this.#told_ms = -Infinity;
      this.#aria_ms = -Infinity;
    }
    for (const listener of this.listeners) listener();
    invalidate(this);
  }

  #changed() {
    const { run, fields } = this.#parts;
    this.bar.marks = marksOf(run, fields);
    this.#moments.textContent = this.bar.marks.map(({ n, words }) => `Bounce ${n}: ${words}`).join('. ');
    this.#offer();
    this.bar.redraw();
    this.#told_ms = -Infinity;
    invalidate(this);
    for (const listener of this.listeners) listener();
  }

  #struck() {
    const { run, fields } = this.#parts;
    if (run.interventions.length > this.bar.marks.length) this.bar.marks = marksOf(run, fields);
    if (this.#back.disabled) this.#offer();
    // Of a run that stands still this may be the last picture.
    if (run.phase !== 'running') this.#told_ms = -Infinity;
    invalidate(this.bar);
    invalidate(this);
  }

  #cleared() {
    this.playback.beyond = -Infinity;
    this.bar.marks = [];
    this.bar.fork = null;
    this.#moved(true);
  }

  #offer() {
    const { run } = this.#parts;
    const past = this.playback.active;
    const replay = !past && this.#fell;
    this.#now.textContent = past ? 'Back to now' : replay ? 'Replay the fall' : 'Now';
    this.#now.setAttribute('aria-disabled', String(!past && !replay));
    this.#back.disabled = run.scene === null || run.impacts.end === 0;
    this.bar.element.setAttribute('aria-disabled', String(run.scene === null));
    const first = run.impacts.end > 0 ? run.impacts.at('n', run.impacts.begin) : 1;
    this.#from.textContent = first > 1 ? `Kept from bounce ${fixed(first, 0)} on` : '';
  }

  /** Says the time shown: at once while the run stands still. @param {number} now_ms */
  draw(now_ms) {
    const { run } = this.#parts;
    const moves = run.pace > 0;
    if (!moves || now_ms - this.#told_ms > 100) {
      this.#told_ms = now_ms;
      this.#say(now_ms, moves);
    }
    return moves;
  }

  /** @param {number} now_ms @param {boolean} moves */
  #say(now_ms, moves) {
    const { run } = this.#parts;
    const { element } = this.bar;
    if (!run.scene) {
      this.#told.textContent = '';
      return;
    }
    const t = Number.isFinite(run.shown) ? run.shown : 0;
    const place = this.place;
    const n = place === null ? 0 : run.impacts.at('n', place);
    const marks = run.past === null ? [] : this.bar.marks.filter((mark) => mark.n === n && mark.t <= t);
    const here = marks.map(({ words }) => words);
    if (run.past !== null && run.replayed === SLOW) here.push('at a tenth of the speed');
    const whole = [unbroken(`n ${fixed(n, 0)}`), unbroken(`${fixed(t, 2)} s`), ...here].join(' · ');
    if (this.#told.textContent !== whole) this.#told.textContent = whole;
    // A slider that has the focus would be spoken all the time while the run goes on.
    if (moves && (now_ms - this.#aria_ms < 2000 || document.activeElement === element)) return;
    this.#aria_ms = now_ms;
    const { begin, end } = this.playback;
    element.setAttribute('aria-valuemin', begin.toFixed(2));
    element.setAttribute('aria-valuemax', Math.max(begin, end).toFixed(2));
    element.setAttribute('aria-valuenow', t.toFixed(2));
    element.setAttribute('aria-valuetext', `bounce ${[n, `${fixed(t, 2)} s`, ...here].join(', ')}`);
  }
}
