// Asks for the verdict and for a preview of the typed scene while it changes: one request of each kind at a time, always for the newest.

import { Problem, get, server } from '../api/client.js';
import { LatestRequest } from '../api/latest-request.js';
import { pathOf } from '../api/scene-fields.js';
import { byId } from '../dom/elements.js';
import { debounce } from '../dom/debounce.js';
import { Verdict } from '../panels/verdict/verdict.js';
import { typedQuery } from './queries.js';

/** @typedef {import('./page.js').Page} Page */

/** Least time between two requests of a kind, ms. */
const PACE_MS = 60;
/** An edit counts as settled after so long without another, ms. */
const QUIET_MS = 150;
/** Bounces of the runs for a fact beside the verdict. */
const BUDGETED = 500;
/** Impacts of a preview. */
const AHEAD = 200;

class Follower {
  #ask;
  #wanted = false;
  #begun_ms = -Infinity;
  /** @type {number | undefined} */
  #timer;
  /** @type {AbortController | null} */
  #request = null;

  /** @param {(page: Page, signal: AbortSignal, newest: () => boolean) => Promise<void>} ask */
  constructor(ask) {
    this.#ask = ask;
  }

  /** @param {Page} page */
  want(page) {
    this.#wanted = true;
    this.#next(page);
  }

  /** Gives up an answer that is out of date, so that the newest is not kept waiting. */
  hurry() {
    if (this.#wanted) this.#request?.abort();
  }

  /** @param {Page} page */
  #next(page) {
    if (!this.#wanted || this.#request || this.#timer !== undefined) return;
    const wait_ms = Math.max(0, this.#begun_ms + PACE_MS - performance.now());
    this.#timer = setTimeout(async () => {
      this.#timer = undefined;
      this.#wanted = false;
      this.#begun_ms = performance.now();
      const request = new AbortController();
      this.#request = request;
      await this.#ask(page, request.signal, () => !this.#wanted);
      this.#request = null;
      this.#next(page);
    }, wait_ms);
  }
}

const verdicts = new Follower(async (page, signal, newest) => {
  const scene = typedQuery(page);
  if (page.unknown !== null) {
    return hold(page, `There is no case “${page.unknown}”; the page shows another one.`, 'Go on with this one', () => {
      page.unknown = null;
      page.follow(true);
    });
  }
  if (page.away) return hold(page, 'The connection to the server is lost.', 'Connect now', () => page.run.retry());
  if (!scene) {
    return hold(page, 'A setting is no number.', 'Show it', () => page.showFault());
  }
  try {
    const answer = await get(`v1/stability?${scene}`, signal);
    if (signal.aborted) return;
    page.form?.blame([]);
    page.circle?.show(answer);
    page.view.learn(answer.derived);
    for (const plot of page.plots) plot.redraw();
    page.circle?.figure.element.classList.remove('stale');
    const judged = { answer, scene };
    page.judged = judged;
    await page.verdict?.show(judged, (more) => get(`v1/stability?${scene}&${more}`), newest());
    if (newest()) {
      tellPanels(page);
      tellFacts(page);
    }
    byId('build').textContent = server.build;
  } catch (error) {
    if (signal.aborted) return;
    if (error instanceof Problem && error.errors.length > 0) {
      const elsewhere = page.form?.blame(error.errors) ?? [];
      const blamed = page.fields.find(({ field }) => error.errors.some(({ pointer }) => pathOf(pointer) === field));
      const words = elsewhere.join(' ') || 'There is no such scene.';
      hold(page, words, blamed ? blamed.title : 'Show it', () => page.showFault());
    } else {
      const words = error instanceof Problem ? error.message : 'The server does not answer.';
      hold(page, words, 'Try again', () => page.follow(true));
    }
  }
});

const previews = new Follower(async (page, signal) => {
  const scene = typedQuery(page);
  if (!scene) return;
  const answer = await get(`v1/trajectories?${scene}&bounces=${AHEAD}`, signal).catch(() => null);
  // One of a scene that is wrong or out of date stays until there is another.
  if (answer) preview(page, answer);
});

/** @param {Page} page @param {import('contract').Trajectory} answer */
function preview(page, answer) {
  // Only `extended` writes numbers as text.
  const columns = /** @type {any} */ (answer.impacts);
  page.ahead = columns;
  for (const plot of page.plots) plot.preview(columns);
  page.view.preview(answer).catch(() => {});
}

/** Tells why there is no verdict on what is on the screen. @param {Page} page @param {string} words @param {string} label @param {() => void} act */
function hold(page, words, label, act) {
  page.verdict?.hold(words, label, act);
  page.circle?.figure.element.classList.add('stale');
}

/** Panels compute for longer, so they hear of a verdict once the scene has settled. */
const tellPanels = debounce(QUIET_MS, (/** @type {Page} */ page) => {
  if (page.judged) page.panels?.judged(page.judged);
});

const facts = new LatestRequest();

/** The facts beside the verdict are dearer than it, so they wait for the scene to settle. */
const tellFacts = debounce(QUIET_MS, (/** @type {Page} */ page) => {
  // Without them the verdict stands alone.
  factsOf(page, facts.next()).catch(() => {});
});

/** The budget is the dearest. @param {Page} page @param {AbortSignal} signal */
async function factsOf(page, signal) {
  const { judged, verdict } = page;
  if (!judged || !verdict) return;
  const [{ gainFact, firstLoss }, answer] = await Promise.all([
    import('../panels/verdict/facts.js'),
    get(`v1/stability?${judged.scene}&release_margins=true&bounces=${BUDGETED}`, signal),
  ]);
  if (page.judged !== judged) return;
  const gains = gainFact({ ...answer, verdict: judged.answer.verdict });
  verdict.tell([gains]);
  if (judged.answer.verdict.code === 'unstable') return;
  const { budget } = await get(`v1/stability?${judged.scene}&budget=true&bounces=${BUDGETED}`, signal);
  if (page.judged === judged && budget) verdict.tell([gains, firstLoss(budget)]);
}

function hurry() {
  verdicts.hurry();
  previews.hurry();
}

const settle = debounce(QUIET_MS, hurry);

/** Begins to ask for what belongs to the typed scene. @param {Page} page */
export function beginToFollow(page) {
  page.verdict = new Verdict(byId('verdict'), byId('verdict-more'));
  page.follow = (another) => {
    page.verdict?.busy(true);
    facts.cancel();
    verdicts.want(page);
    previews.want(page);
    if (another) hurry();
    else settle();
  };
  page.follow(false);
}
