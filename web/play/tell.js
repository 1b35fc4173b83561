// Tells the stories, each a scene with a caption and, for some, what is done to its run: shows their scene, does to its run what belongs to them, and tells how a run ended.

import { choose } from '../app/scenes.js';
import { byId, h } from '../dom/elements.js';
import { reasonOf } from '../panels/verdict/words.js';
import { runWords } from '../panels/verdict/this-run.js';
import STORIES from './stories.json' with { type: 'json' };

/** @param {Page} page @param {typeof STORIES[number]} story */
export function tell(page, story) {
  const one = page.cases.find(({ name }) => name === story.preset);
  if (!one) return;
  choose(page, one);
  page.start(story.deeds);
  // On a phone the scene may be above the screen.
  byId('scene-card').scrollIntoView({ block: 'nearest' });
}

/** The run once more, with what its story does to it. @param {Page} page */
export function again(page) {
  const story = STORIES.find(({ preset, deeds }) => deeds && preset === page.chosen?.name);
  if (story && page.unchanged) tell(page, story);
  else page.restart();
}

/** @param {Page} page @returns {(by: number) => void} goes so many stories on */
export function bringStories(page) {
  const place = byId('stories');
  const buttons = STORIES.map((story) => h('button', { type: 'button', click: () => tell(page, story) }, story.name));
  place.replaceChildren(...buttons);
  const at = () => STORIES.findIndex(({ preset }) => preset === page.chosen?.name);
  const show = () => {
    const told = page.unchanged ? at() : -1;
    for (const [index, button] of buttons.entries()) button.setAttribute('aria-pressed', String(index === told));
  };
  page.run.watch({ changed: show, cleared: show });
  show();
  return (by) => tell(page, STORIES[(Math.max(at(), by > 0 ? -1 : 0) + by + STORIES.length) % STORIES.length]);
}

/** Shows the end of a run over the scene: what happened, why, and how to go on. @param {Page} page */
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
  page.run.watch({ changed: show, cleared: show });
  show();
}
