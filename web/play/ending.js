// The end of a run over the scene: what happened, why, and how to go on.

import { again } from './tell.js';
import { byId, h } from '../dom/elements.js';
import { runWords } from '../panels/verdict/this-run.js';
import { reasonOf } from '../panels/verdict/plain-words.js';

/** @param {import('../app/page.js').Page} page */
export function bringEnding(page) {
  const words = h('p');
  const more = h('button', { type: 'button', id: 'again', click: () => again(page) }, 'Again');
  const slow = h('button', { type: 'button', id: 'slow', click: () => page.timeline?.replayFall() }, 'Slow motion');
  const box = h('div', { class: 'ending', hidden: true }, words, more, slow);
  byId('scene-frame').append(box);
  const show = () => {
    const { run } = page;
    const { fate, outcome } = run;
    box.hidden = run.phase !== 'ended' || !outcome;
    if (box.hidden || !outcome) return;
    box.className = `ending ${fate ?? ''}`;
    slow.hidden = fate !== 'fell' || Boolean(outcome.contact);
    const why = fate === 'fell' && !outcome.contact ? `: ${reasonOf(outcome.kind)}` : '';
    const [fact] = runWords(run, page.fields);
    words.textContent = `${fact}${why}.`;
  };
  page.run.watch({ changed: show, struck: () => {}, cleared: show });
  show();
}
