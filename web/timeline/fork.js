// “What if from here”: a second run that parts from this one at the shown impact, with another tilt gain.

import { criticalGain } from '../api/answers.js';
import { wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { valueAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';
import { GAIN } from '../app/page.js';
import { byId } from '../dom/elements.js';
import { fixed, number } from '../dom/numbers.js';
import { sliderRange, sliderStep } from '../form/sliders.js';
import { sign } from '../panels/parts.js';
import { endedAs } from '../panels/verdict/words.js';
import { interventionQuery } from '../run/interventions.js';
import { html, render } from '../vendor/preact/preact.js';
import { computedRun } from './others.js';

/** Impacts that a fork is followed for. */
const AHEAD = 300;
/** Forks this late are asked for only when the slider is let go: their answers hold the run up to there. */
const LATE = 2000;
/** The latest impact to fork at. */
const LATEST = 20_000;

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

/** @param {Page} page */
export function bringFork(page) {
  const field = page.fields.find((one) => one.field === GAIN);
  const { timeline } = page;
  if (!field || !timeline) return;
  const { run } = page;
  /** The impact after which the fork has its own gain. @type {{n: number, t: number} | null} */
  let at = null;
  let gain = 1;
  /** The ends of the slider and its step. */
  let slider = [0, 2, 0.01];
  const open = byId('fork', HTMLButtonElement);
  open.onclick = () => (at ? close() : begin());

  /** The gain of the strike after the shown time; undefined with another law, and before the first impact. */
  const gainNow = () => {
    const now = run.scene && run.impacts.end > 0 && valueAt(run.sceneAfter(run.shown) ?? {}, GAIN);
    return typeof now === 'number' ? now : undefined;
  };

  const offer = () => {
    const off = !at && gainNow() === undefined;
    if (open.disabled !== off) open.disabled = off;
  };

  let told = '';
  const draw = (words = told) => {
    told = words;
    offer();
    open.setAttribute('aria-expanded', String(at !== null));
    const [min, max, step] = slider;
    const turn = (/** @type {Event} */ { type, currentTarget }) => {
      gain = /** @type {HTMLInputElement} */ (currentTarget).valueAsNumber;
      draw();
      if (type === 'change' || (at?.n ?? 0) <= LATE) asks.want(null);
    };
    const box = html`<div id="fork-box" class="fork" role="group" aria-label="What if from here">
      <label for="fork-gain">What if ${sign('κ')} were</label>
      <input type="range" id="fork-gain" min=${min} max=${max} step=${step} value=${gain}
        aria-valuetext=${number(gain)} onInput=${turn} onChange=${turn} />
      <output class="value" for="fork-gain">${fixed(gain, 3)}</output>
      <p id="fork-told" role="status">${told}</p>
      <button type="button" id="fork-close" onClick=${() => close()}>Close</button>
    </div>`;
    render(at && box, byId('what-if'));
  };

  const begin = () => {
    const place = timeline.place();
    const now = gainNow();
    if (now === undefined) return;
    at = place === null ? { n: 0, t: 0 } : { n: run.impacts.at('n', place), t: run.impacts.at('t', place) };
    timeline.parts(at.t);
    const bound = criticalGain(page.judged?.answer);
    // On the other side of the boundary, where there is one.
    const other = bound === null ? now * 1.1 : now < bound ? bound * 1.05 : (1 + bound) / 2;
    gain = Number(other.toPrecision(3));
    slider = [...sliderRange(field, gain), sliderStep(field, gain)];
    draw('…');
    byId('fork-gain').focus({ preventScroll: true });
    asks.want(null);
    if (run.past !== null && !stillness.matches) timeline.toggle();
  };

  const end = () => {
    if (!at) return;
    at = null;
    draw();
    timeline.parts(null);
    page.others('fork', null);
  };

  const close = () => {
    end();
    open.focus({ preventScroll: true });
  };

  const asks = new Follower(async (_, signal) => {
    const from = at;
    if (!from) return;
    if (from.n > LATEST) return draw(`A fork is possible up to bounce ${number(LATEST, 8)}.`);
    const wanted = gain;
    const interventions = [
      ...run.interventions.filter(({ impact }) => impact <= from.n),
      { impact: from.n + 1, set: { [GAIN]: wanted }, kick: {}, guide: {} },
    ];
    const release = sceneQuery(run.released ?? {}, page.chosen, page.fields);
    const query = new URLSearchParams([...release, ...interventionQuery(interventions)]);
    try {
      const forked = await computedRun(query, from.n + AHEAD, signal);
      if (at !== from || !forked.outcome) return;
      const label = `what if κ ${number(wanted)}`;
      page.others('fork', { run: forked, from: from.n, symbol: '◆', colour: 'measured', label, staged: true });
      const { kind, bounces, t } = forked.outcome;
      timeline.parts(from.t, t);
      const later = `${number(bounces - from.n, 8)} bounces`;
      const ended = kind === 'completed' ? `survives the next ${later}` : `${endedAs(kind, bounces)}, ${later} later`;
      draw(`From bounce ${number(from.n, 8)} with κ ${number(wanted)}: ${ended}.`);
    } catch (error) {
      if (at === from) draw(wordsOf(error));
    }
  });

  run.watch({
    changed: offer,
    moved: offer,
    struck: () => {
      if (open.disabled) offer();
    },
    cleared: end,
  });
  draw();
}
