// Tells the stories: shows their scene and does to its run what belongs to them.

import { restart, start, unchanged } from '../app/run-actions.js';
import { choose } from '../app/scenes.js';
import { byId, h } from '../dom/elements.js';
import { STORIES } from './stories.js';

/** @typedef {import('../app/page.js').Page} Page */
/** @typedef {import('./stories.js').Story} Story */

/** @param {Page} page @param {Story} story */
export function tell(page, story) {
  const one = page.cases.find(({ name }) => name === story.preset);
  if (!one) return;
  choose(page, one);
  start(page, story.deeds);
  // On a phone the scene may be above the screen.
  byId('scene-card').scrollIntoView({ block: 'nearest' });
}

/** The run once more, with what its story does to it. @param {Page} page */
export function again(page) {
  const story = STORIES.find(({ preset, deeds }) => deeds && preset === page.chosen?.name);
  if (story && unchanged(page)) tell(page, story);
  else restart(page);
}

/** @param {Page} page @returns {(by: number) => void} goes so many stories on */
export function bringStories(page) {
  const place = byId('stories');
  const buttons = STORIES.map((story) => h('button', { type: 'button', click: () => tell(page, story) }, story.name));
  place.replaceChildren(...buttons);
  const at = () => STORIES.findIndex(({ preset }) => preset === page.chosen?.name);
  const show = () => {
    const told = unchanged(page) ? at() : -1;
    for (const [index, button] of buttons.entries()) button.setAttribute('aria-pressed', String(index === told));
  };
  page.run.watch({ changed: show, struck: () => {}, cleared: show });
  show();
  return (by) => tell(page, STORIES[(Math.max(at(), by > 0 ? -1 : 0) + by + STORIES.length) % STORIES.length]);
}
