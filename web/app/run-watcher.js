// Shows the run: its state in words, its buttons, its line beside the verdict, a lost connection, and why something was refused.

import { pathOf } from '../api/scene-fields.js';
import { byId, h } from '../dom/elements.js';
import { clearNotice, connectionNotice, notice } from '../dom/notices.js';
import { inWords } from '../dom/typeset.js';

/** The action of the first button. */
const ACTION = {
  idle: 'Run',
  connecting: 'Connecting…',
  running: 'Pause',
  paused: 'Resume',
  lost: 'Connecting…',
  ended: 'Run again',
};

/** Brings the buttons of the run, and hears of its news. @param {Page} page */
export function watchRun(page) {
  const { run } = page;
  byId('run').onclick = () => page.toggle();
  byId('step').onclick = () => page.step();
  byId('restart').onclick = () => page.restart();
  let { replay } = run;
  let away = false;
  run.watch({
    changed: () => {
      if (away !== (run.phase === 'lost')) {
        away = !away;
        // There is no verdict while the server is away.
        page.follow(true);
        if (!away) {
          clearNotice('connection');
          page.sendChanges();
        }
      }
      showRun(page);
    },
    struck: () => {
      page.view.redraw();
      showThisRun(page);
    },
    moved: () => {
      if (replay !== run.replay) showButtons(page);
      replay = run.replay;
    },
    cleared: () => page.view.reset(),
    lost: (seconds) => connectionNotice(seconds, () => run.retry()),
    refused: (problem) => refused(page, problem),
    problem: (message) => blame(page, message),
  });
}

/** @param {Page} page */
export function showRun(page) {
  const { run } = page;
  if (run.phase !== 'ended') tell(run.words || 'Ready');
  Object.assign(byId('run-state').dataset, { phase: run.phase, fate: run.fate });
  showThisRun(page);
  if (run.active) {
    page.speed = run.clock.speed || page.speed;
    page.updateAddressSoon();
  }
  showButtons(page);
  page.view.redraw();
}

/** The first buttons belong to the past while it is shown. @param {Page} page */
function showButtons(page) {
  const { phase, replay, active } = page.run;
  const [run, one, again] = ['run', 'step', 'restart'].map((id) => byId(id, HTMLButtonElement));
  const past = replay !== null;
  const ready = page.typed !== undefined;
  run.textContent = past ? (replay === 'plays' ? 'Pause' : 'Play') : ACTION[phase];
  run.disabled = !past && (!ready || phase === 'connecting' || phase === 'lost');
  one.disabled = !past && !active;
  again.disabled = phase === 'idle' || !ready;
  const waiting = phase !== 'idle' && page.unplayed.length > 0;
  again.classList.toggle('attention', waiting);
  // Another width would move its neighbours.
  again.title = again.ariaLabel = waiting ? 'Restart with changes' : 'Restart';
  page.sliders?.draw();
}

/** @param {string} words */
function tell(words) {
  const state = byId('run-state');
  if (state.textContent !== words) state.textContent = words;
}

/** The line on the run; its code comes with the first run. @param {Page} page */
async function showThisRun(page) {
  const { run } = page;
  if (!page.thisRun) {
    if (run.phase === 'idle') return;
    const { bringThisRun } = await import('../panels/verdict/this-run.js');
    page.thisRun ??= bringThisRun(byId('this-run'), run, page.fields);
  }
  const [fact, after] = page.thisRun();
  if (run.phase === 'ended') tell(fact + after);
  // A body that the table has caught rests there, whatever its setting does.
  const caught = Object.keys(run.interventions.at(-1)?.guide ?? {}).some((name) => name.startsWith('catch.'));
  const isHeld = run.active && run.holds !== null && caught;
  const isTold = run.phase === 'ended' && (run.fate === 'fell' || run.fate === 'kept');
  /** @type {Result} */
  const held = isHeld ? { tone: 'kept', words: 'Caught: held on the table' } : null;
  page.verdict?.tell({ ended: isTold ? { tone: run.fate, words: fact } : held });
}

/** The run is refused for good. @param {Page} page @param {Problem} problem */
function refused(page, problem) {
  const elsewhere = page.form?.blame(problem.errors) ?? [];
  const words = [inWords(problem.message), ...elsewhere, 'Its scene is kept; Run releases it anew.'].join(' ');
  notice('run', [h('strong', {}, 'The server did not take this run. '), words], { caution: true });
  page.updateAddressSoon();
}

/** A message to the run is refused: says so at its field, at the deeds or in a notice. @param {Page} page @param {Refusal} message */
function blame(page, { title, detail, errors }) {
  const { run } = page;
  if (run.guided && page.guidedByPanel) return;
  const own = errors.filter(({ pointer }) => page.fields.some((field) => field.field === pathOf(pointer)));
  const others = errors.filter((error) => !own.includes(error)).map((error) => inWords(error.detail));
  const words =
    [...(page.form?.blame(own) ?? []), ...others].join(' ') || (errors.length > 0 ? '' : inWords(detail || title));
  if (run.guided || run.sent === 'kick') page.sliders?.blame(words || inWords(detail));
  else if (words) notice('message', [words], { caution: true });
}
