// “What if from here”: a second run that parts from this one at the shown impact, with another tilt gain.

import { get, wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { valueAt } from '../api/scene-fields.js';
import { h } from '../dom/elements.js';
import { fixed, number } from '../dom/numbers.js';
import { symbol } from '../dom/typeset.js';
import { aim } from '../form/sliders.js';
import { endedAs } from '../panels/verdict/words.js';
import { interventionQuery } from '../run/interventions.js';
import { recordedRun } from './others.js';

/** @typedef {import('contract').Trajectory} Trajectory */

/**
 * @typedef {object} ForkParts
 * @property {import('../run/run.js').Run} run
 * @property {import('./timeline.js').Timeline} timeline
 * @property {import('./others.js').Others} others
 * @property {import('../api/scene-fields.js').Field} field the tilt gain
 * @property {() => URLSearchParams} release the scene of the run's release
 * @property {() => number | null} critical gain, where the verdict knows it
 */

/** Impacts that a fork is followed for. */
const AHEAD = 300;
/** Forks this late are asked for only when the slider is let go: their answers hold the run up to there. */
const LATE = 2000;
/** The latest impact to fork at. */
const LATEST = 20_000;

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class Fork {
  #parts;
  #open = h('button', { type: 'button', id: 'fork', 'aria-expanded': 'false' }, 'What if from here');
  #gain = h('input', { type: 'range', id: 'fork-gain' });
  #gainShown = h('output', { class: 'value', for: 'fork-gain' });
  #told = h('p', { id: 'fork-told', role: 'status' });
  #box = h(
    'div',
    { id: 'fork-box', class: 'fork', role: 'group', 'aria-label': 'What if from here', hidden: true },
    h('label', { for: 'fork-gain' }, 'What if ', symbol('κ'), ' were'),
    this.#gain,
    this.#gainShown,
    this.#told,
    h('button', { type: 'button', id: 'fork-close', click: () => this.close(true) }, 'Close'),
  );
  /** The impact after which the fork has its own gain. @type {{n: number, t: number} | null} */
  #at = null;
  #asks = new Follower((_, signal) => this.#ask(signal));

  /** @param {HTMLElement} root @param {HTMLElement} bar of the button @param {ForkParts} parts */
  constructor(root, bar, parts) {
    this.#parts = parts;
    bar.append(this.#open);
    root.append(this.#box);
    this.#open.setAttribute('aria-controls', this.#box.id);
    this.#open.addEventListener('click', () => (this.#at ? this.close(true) : this.#begin()));
    this.#gain.addEventListener('input', () => {
      this.#name();
      if ((this.#at?.n ?? 0) <= LATE) this.#asks.want(null);
    });
    this.#gain.addEventListener('change', () => this.#asks.want(null));
    parts.timeline.listeners.add(() => this.#offer());
    parts.run.watch({
      changed: () => this.#offer(),
      struck: () => {
        if (this.#open.disabled) this.#offer();
      },
      cleared: () => this.close(false),
    });
    this.#offer();
  }

  /** The gain of the strike after the shown time; undefined with another law. */
  get #now() {
    const { run } = this.#parts;
    const gain = run.scene && valueAt(run.sceneAfter(run.shown) ?? {}, 'table.tilt_gain');
    return typeof gain === 'number' ? gain : undefined;
  }

  #offer() {
    const off = !this.#at && (this.#now === undefined || this.#parts.run.impacts.end === 0);
    if (this.#open.disabled !== off) this.#open.disabled = off;
  }

  #begin() {
    const { run, timeline, field, critical } = this.#parts;
    const { place } = timeline;
    const now = this.#now;
    if (now === undefined || run.impacts.end === 0) return;
    const n = place === null ? 0 : run.impacts.at('n', place);
    this.#at = { n, t: place === null ? 0 : run.impacts.at('t', place) };
    timeline.bar.fork = this.#at.t;
    timeline.bar.redraw();
    this.#box.hidden = false;
    this.#open.setAttribute('aria-expanded', 'true');
    const bound = critical();
    // On the other side of the boundary, where there is one.
    const other = bound === null ? now * 1.1 : now < bound ? bound * 1.05 : (1 + bound) / 2;
    aim(this.#gain, field, Number(other.toPrecision(3)));
    this.#name();
    this.#gain.focus({ preventScroll: true });
    this.#told.textContent = '…';
    this.#asks.want(null);
    if (run.past !== null && !stillness.matches) timeline.toggle();
  }

  /** @param {boolean} back to the button with the focus */
  close(back) {
    if (!this.#at) return;
    const { timeline, others } = this.#parts;
    this.#at = null;
    this.#box.hidden = true;
    this.#open.setAttribute('aria-expanded', 'false');
    timeline.bar.fork = null;
    timeline.beyond = -Infinity;
    timeline.bar.redraw();
    others.set('fork', null);
    if (back) this.#open.focus({ preventScroll: true });
  }

  #name() {
    this.#gainShown.textContent = fixed(this.#gain.valueAsNumber, 3);
    this.#gain.setAttribute('aria-valuetext', number(this.#gain.valueAsNumber));
  }

  /** @param {AbortSignal} signal */
  async #ask(signal) {
    const at = this.#at;
    if (!at) return;
    if (at.n > LATEST) {
      this.#told.textContent = `A fork is possible up to bounce ${number(LATEST, 8)}.`;
      return;
    }
    const { run, release } = this.#parts;
    const gain = this.#gain.valueAsNumber;
    const interventions = [
      ...run.interventions.filter(({ impact }) => impact <= at.n),
      { impact: at.n + 1, set: { 'table.tilt_gain': gain }, kick: {}, guide: {} },
    ];
    const query = new URLSearchParams([...release(), ...interventionQuery(interventions)]);
    try {
      const answer = await get(`v1/trajectories?${query}&bounces=${at.n + AHEAD}`, signal);
      if (this.#at === at) this.#show(answer, interventions, at, gain);
    } catch (error) {
      if (this.#at === at) this.#told.textContent = wordsOf(error);
    }
  }

  /**
   * @param {Trajectory} answer
   * @param {import('../run/interventions.js').Intervention[]} interventions
   * @param {{n: number, t: number}} at
   * @param {number} gain
   */
  #show(answer, interventions, at, gain) {
    const { others, timeline } = this.#parts;
    const { outcome, impacts } = answer;
    const columns = Object.fromEntries(
      Object.entries(impacts).map(([name, values]) => [name, /** @type {any[]} */ (values).slice(at.n)]),
    );
    others.set('fork', {
      run: recordedRun(answer, interventions),
      columns,
      symbol: '◆',
      colour: 'measured',
      label: `what if κ ${number(gain)}`,
      staged: true,
    });
    timeline.beyond = outcome.t;
    timeline.bar.redraw();
    const ended =
      outcome.kind === 'completed'
        ? `survives the next ${number(outcome.bounces - at.n, 8)} bounces`
        : `${endedAs(outcome.kind, outcome.bounces)}, ${number(outcome.bounces - at.n, 8)} bounces later`;
    this.#told.textContent = `From bounce ${number(at.n, 8)} with κ ${number(gain)}: ${ended}.`;
  }
}
