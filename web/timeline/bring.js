// Brings the time line and what belongs to it.

import { byId } from '../dom/elements.js';
import { styles } from '../panels/card.js';
import { directions } from '../run/kick-directions.js';
import { Timeline } from './timeline.js';

/** @param {import('../app/page.js').Page} page */
export async function bringTimeline(page) {
  await styles('timeline/timeline.css').catch(() => {});
  const { run, view, plots, controls, fields } = page;
  controls.offerDirections(directions((name, sign) => controls.kickTowards(name, sign)));
  page.timeline = new Timeline(byId('timeline'), { run, view, plots, controls, fields, speed: () => page.speed });
}
