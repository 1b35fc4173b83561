// Brings the time line and what belongs to it.

import { byId } from '../dom/elements.js';
import { styles } from '../panels/card.js';
import { RunSliders } from '../run/sliders.js';
import { Timeline } from './timeline.js';

/** @param {import('../app/page.js').Page} page */
export async function bringTimeline(page) {
  await styles('timeline/timeline.css').catch(() => {});
  const { run, view, plots, controls, fields } = page;
  controls.join(new RunSliders(byId('controls'), controls.actions));
  page.timeline = new Timeline(byId('timeline'), { run, view, plots, controls, fields, speed: () => page.speed });
}
