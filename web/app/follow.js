// Asks for the verdict and for a preview of the typed scene while it changes: one request of each kind at a time, always for the newest.

import { Problem, get, server, wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { pathOf } from '../api/scene-fields.js';
import { missing } from '../api/settings.js';
import { byId } from '../dom/elements.js';
import { debounce } from '../dom/debounce.js';
import { bringVerdict } from '../panels/verdict/verdict.js';
import { computedRun } from '../timeline/others.js';

/** An edit counts as settled after so long without another, ms. */
const QUIET_MS = 150;
/** Bounces of the runs for a fact beside the verdict. */
const BUDGETED = 500;
/** Impacts of a preview. */
const AHEAD = 200;

/** Begins to ask for what belongs to the typed scene. @param {Page} page */
export function beginToFollow(page) {
  const verdict = bringVerdict(byId('verdict'), byId('verdict-more'));
  page.verdict = verdict;

  /** Tells why there is no verdict on what is on the screen. @param {string} words @param {string} label @param {() => void} act */
  const hold = (words, label, act) => {
    verdict.tell({ held: { words, label, act }, busy: false });
    page.circle?.figure.element.classList.add('stale');
  };

  /** The facts beside the verdict, of which the budget is the dearest. @param {AbortSignal} signal */
  const tellFacts = async (signal) => {
    const { judged } = page;
    if (!judged) return;
    const [{ gainFact, firstLoss }, answer] = await Promise.all([
      import('../panels/verdict/facts.js'),
      get(`v1/stability?${judged.scene}&release_margins=true&bounces=${BUDGETED}`, signal),
    ]);
    if (page.judged !== judged) return;
    const gains = gainFact({ ...answer, verdict: judged.answer.verdict });
    verdict.tell({ facts: [gains] });
    if (judged.answer.verdict.code === 'unstable') return;
    const { budget } = await get(`v1/stability?${judged.scene}&budget=true&bounces=${BUDGETED}`, signal);
    if (page.judged === judged && budget) verdict.tell({ facts: [gains, firstLoss(budget)] });
  };

  // Without them the verdict stands alone.
  const facts = new Follower((_, signal) => tellFacts(signal).catch(() => {}));
  /** The facts beside the verdict are dearer than it, so they wait for the scene to settle. */
  const tellMore = debounce(QUIET_MS, () => {
    page.markGain();
    facts.cancel();
    facts.want(null);
  });

  const verdicts = new Follower(async (_, signal, newest) => {
    const scene = page.typedQuery;
    if (page.unknown !== null)
      return hold(`There is no case “${page.unknown}”; the page shows another one.`, 'Go on with this one', () => {
        page.unknown = null;
        page.follow(true);
      });
    if (page.run.phase === 'lost')
      return hold('The connection to the server is lost.', 'Connect now', () => page.run.retry());
    if (!scene) return hold(missing(page.missing[0]), 'Show it', () => page.showFault());
    try {
      const answer = await get(`v1/stability?${scene}`, signal);
      if (signal.aborted) return;
      page.form?.blame([]);
      page.view.learn(answer.derived);
      for (const plot of page.plots) plot.redraw();
      page.circle?.figure.element.classList.remove('stale');
      const judged = { answer, scene };
      page.judged = judged;
      page.circle?.show(judged);
      // Facts of another answer are void.
      verdict.tell({ shown: judged, held: null, facts: [], busy: !newest() });
      if (newest()) tellMore();
      byId('build').textContent = server.build;
    } catch (error) {
      if (signal.aborted) return;
      const errors = error instanceof Problem ? error.errors : [];
      if (errors.length === 0) return hold(wordsOf(error), 'Try again', () => page.follow(true));
      const elsewhere = page.form?.blame(errors) ?? [];
      const blamed = page.fields.find(({ field }) => errors.some(({ pointer }) => pathOf(pointer) === field));
      const words = elsewhere.join(' ') || 'There is no such scene.';
      hold(words, blamed?.title ?? 'Show it', () => page.showFault());
    }
  });

  const previews = new Follower(async (_, signal) => {
    const scene = page.typedQuery;
    if (!scene) return;
    const ahead = await computedRun(scene, AHEAD, signal).catch(() => null);
    // One of a scene that is wrong or out of date stays until there is another.
    if (!ahead) return;
    page.ahead = ahead;
    for (const one of [...page.plots, page.view]) one.preview(ahead);
  });

  const hurry = () => {
    verdicts.hurry();
    previews.hurry();
  };
  const settle = debounce(QUIET_MS, hurry);

  page.follow = (another) => {
    verdict.tell({ busy: true });
    facts.cancel();
    verdicts.want(null);
    previews.want(null);
    if (another) hurry();
    else settle();
  };
  page.follow(false);
}
