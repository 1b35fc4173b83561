// Brings the time line and what belongs to it.

import { criticalGain } from '../api/answers.js';
import { sceneQuery } from '../api/scene-query.js';
import { catchIt, throwUp } from '../app/late/guide.js';
import { GAIN } from '../app/page.js';
import { byId } from '../dom/elements.js';
import { styles } from '../panels/card.js';
import { RunSliders } from '../run/sliders.js';
import { Fork } from './fork.js';
import { Others } from './others.js';
import { Timeline } from './timeline.js';

/** @param {import('../app/page.js').Page} page */
export async function bringTimeline(page) {
  await styles('timeline/timeline.css').catch(() => {});
  const { run, view, plots, controls, fields } = page;
  controls.join(
    new RunSliders(byId('controls'), byId('exact'), {
      ...controls.actions,
      catchIt: () => catchIt(page, {}, 'kick'),
      throwIt: () => throwUp(page),
    }),
  );
  const root = byId('timeline');
  const timeline = new Timeline(root, { run, view, plots, controls, fields, speed: () => page.speed });
  page.timeline = timeline;
  const others = new Others(view, plots);
  const field = fields.find((one) => one.field === GAIN);
  if (field)
    new Fork(root, byId('exact'), {
      run,
      timeline,
      others,
      field,
      release: () => sceneQuery(run.released ?? {}, page.chosen, fields),
      critical: () => criticalGain(page.judged?.answer),
    });
  return others;
}
