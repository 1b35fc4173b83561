// “What if from here”: a second run that parts from this one at the shown impact, with another tilt gain.

import { criticalGain } from '../api/answers.js';
import { get, wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { valueAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';
import { byId, h } from '../dom/elements.js';
import { fixed, number } from '../dom/numbers.js';
import { sliderRange, sliderStep } from '../form/sliders.js';
import { sign } from '../panels/parts.js';
import { endedAs } from '../panels/verdict/words.js';
import { interventionQuery } from '../run/interventions.js';
import { html, render } from '../vendor/preact/preact.js';
import { recordedRun } from './others.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */

/** Impacts that a fork is followed for. */
const AHEAD = 300;
/** Forks this late are asked for only when the slider is let go: their answers hold the run up to there. */
const LATE = 2000;
/** The latest impact to fork at. */
const LATEST = 20_000;

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class Fork {
  #page;
  #field;
  #timeline;
  #others;
  #open = h('button', { type: 'button', id: 'fork', 'aria-controls': 'fork-box', click: () => this.#turn() });
  #root = h('div', { class: 'contents' });
  /** The impact after which the fork has its own gain. @type {{n: number, t: number} | null} */
  #at = null;
  #gain = 1;
  /** The ends of the slider and its step. */
  #slider = [0, 2, 0.01];
  #told = '';
  #asks = new Follower((_, signal) => this.#ask(signal));

  /**
   * @param {HTMLElement} root
   * @param {HTMLElement} bar of the button
   * @param {import('../app/page.js').Page} page
   * @param {Field} field the tilt gain
   * @param {import('./timeline.js').Timeline} timeline
   * @param {import('./others.js').Others} others
   */
  constructor(root, bar, page, field, timeline, others) {
    this.#page = page;
    this.#field = field;
    this.#timeline = timeline;
    this.#others = others;
    this.#open.append('What if from here');
    bar.append(this.#open);
    root.append(this.#root);
    page.run.watch({
      changed: () => this.#offer(),
      moved: () => this.#offer(),
      struck: () => {
        if (this.#open.disabled) this.#offer();
      },
      cleared: () => this.close(false),
    });
    this.#draw();
  }

  /** The gain of the strike after the shown time; undefined with another law, and before the first impact. */
  get #now() {
    const { run } = this.#page;
    const gain = run.scene && run.impacts.end > 0 && valueAt(run.sceneAfter(run.shown) ?? {}, 'table.tilt_gain');
    return typeof gain === 'number' ? gain : undefined;
  }

  #offer() {
    const off = !this.#at && this.#now === undefined;
    if (this.#open.disabled !== off) this.#open.disabled = off;
  }

  #draw() {
    this.#offer();
    this.#open.setAttribute('aria-expanded', String(this.#at !== null));
    const [min, max, step] = this.#slider;
    const turn = (/** @type {Event} */ { type, currentTarget }) => {
      this.#gain = /** @type {HTMLInputElement} */ (currentTarget).valueAsNumber;
      this.#draw();
      if (type === 'change' || (this.#at?.n ?? 0) <= LATE) this.#asks.want(null);
    };
    const box = html`<div id="fork-box" class="fork" role="group" aria-label="What if from here">
      <label for="fork-gain">What if ${sign('κ')} were</label>
      <input type="range" id="fork-gain" min=${min} max=${max} step=${step} value=${this.#gain}
        aria-valuetext=${number(this.#gain)} onInput=${turn} onChange=${turn} />
      <output class="value" for="fork-gain">${fixed(this.#gain, 3)}</output>
      <p id="fork-told" role="status">${this.#told}</p>
      <button type="button" id="fork-close" onClick=${() => this.close(true)}>Close</button>
    </div>`;
    render(this.#at && box, this.#root);
  }

  /** @param {string} words */
  #tell(words) {
    this.#told = words;
    this.#draw();
  }

  #turn() {
    if (this.#at) return this.close(true);
    const { run, judged } = this.#page;
    const { place } = this.#timeline;
    const now = this.#now;
    if (now === undefined) return;
    this.#at = place === null ? { n: 0, t: 0 } : { n: run.impacts.at('n', place), t: run.impacts.at('t', place) };
    this.#timeline.parts(this.#at.t);
    const bound = criticalGain(judged?.answer);
    // On the other side of the boundary, where there is one.
    const other = bound === null ? now * 1.1 : now < bound ? bound * 1.05 : (1 + bound) / 2;
    this.#gain = Number(other.toPrecision(3));
    this.#slider = [...sliderRange(this.#field, this.#gain), sliderStep(this.#field, this.#gain)];
    this.#tell('…');
    byId('fork-gain').focus({ preventScroll: true });
    this.#asks.want(null);
    if (run.past !== null && !stillness.matches) this.#timeline.toggle();
  }

  /** @param {boolean} back to the button with the focus */
  close(back) {
    if (!this.#at) return;
    this.#at = null;
    this.#draw();
    this.#timeline.parts(null);
    this.#others.set('fork', null);
    if (back) this.#open.focus({ preventScroll: true });
  }

  /** @param {AbortSignal} signal */
  async #ask(signal) {
    const at = this.#at;
    if (!at) return;
    if (at.n > LATEST) return this.#tell(`A fork is possible up to bounce ${number(LATEST, 8)}.`);
    const { run, chosen, fields } = this.#page;
    const gain = this.#gain;
    const interventions = [
      ...run.interventions.filter(({ impact }) => impact <= at.n),
      { impact: at.n + 1, set: { 'table.tilt_gain': gain }, kick: {}, guide: {} },
    ];
    const release = sceneQuery(run.released ?? {}, chosen, fields);
    const query = new URLSearchParams([...release, ...interventionQuery(interventions)]);
    try {
      const answer = await get(`v1/trajectories?${query}&bounces=${at.n + AHEAD}`, signal);
      if (this.#at === at) this.#show(answer, interventions, at, gain);
    } catch (error) {
      if (this.#at === at) this.#tell(wordsOf(error));
    }
  }

  /**
   * @param {import('contract').Trajectory} answer
   * @param {import('../run/interventions.js').Intervention[]} interventions
   * @param {{n: number, t: number}} at
   * @param {number} gain
   */
  #show(answer, interventions, at, gain) {
    this.#others.set('fork', {
      run: recordedRun(answer, interventions),
      from: at.n,
      symbol: '◆',
      colour: 'measured',
      label: `what if κ ${number(gain)}`,
      staged: true,
    });
    this.#timeline.parts(at.t, answer.outcome.t);
    const { kind, bounces } = answer.outcome;
    const later = `${number(bounces - at.n, 8)} bounces`;
    const ended = kind === 'completed' ? `survives the next ${later}` : `${endedAs(kind, bounces)}, ${later} later`;
    this.#tell(`From bounce ${number(at.n, 8)} with κ ${number(gain)}: ${ended}.`);
  }
}
