// The parts that load after the first picture: map, reasons, values, time line, keys, saving.

import { EigenvalueCircle } from '../../charts/eigenvalue-circle.js';
import { PlotInteraction } from '../../charts/impacts/plot-interaction.js';
import { anglePlane, energyPlot, velocityPlane } from '../../charts/impacts/plots.js';
import { byId } from '../../dom/elements.js';
import { brokenLinkNotice } from '../../dom/notices.js';
import { enlarger } from '../../export/enlarge.js';
import { styles } from '../../dom/styles.js';
import { bringImpacts } from '../../panels/impacts/load.js';
import { Panels } from '../../panels/panels.js';
import { Pins } from '../../pins/pins.js';
import { dropWith } from '../../play/drop.js';
import { Hand } from '../../play/hand.js';
import { bringShell, leadFiles, present } from '../../play/shell.js';
import { bringEnding, bringStories } from '../../play/tell.js';
import { Grab } from '../../scene/grab.js';
import { bringSymbols } from '../../scene/symbols.js';
import { bringTimeline } from '../../timeline/load.js';
import { playedQuery, typedQuery, updateAddressSoon } from '../address-bar.js';
import { History } from '../history.js';
import { launch, play } from '../scenes.js';
import { guideOf } from './guide.js';
import { listenToKeys } from './keys.js';
// It is there when the server is not.
import './run-problems.js';
import { bringSettings, bringTracks } from './settings.js';
import { bringShare, csvPath, savesOf } from './share.js';

const STYLES = ['play/late.css', 'panels/verdict/verdict.css', 'charts/charts.css', 'form/form.css', 'app/app.css'];

/** @param {import('../page.js').Page} page */
export async function bringLateParts(page) {
  page.history = new History(page);
  // Parts come with their styles, or without them where those do not load.
  await Promise.all(STYLES.map(styles)).catch(() => {});
  bringSettings(page);
  bringCharts(page);
  const { plots, view, fields, run } = page;
  const others = await bringTimeline(page);
  bringShell(() => page.panels?.show('why'));
  present(byId('present'), bringStories(page));
  byId('present', HTMLButtonElement).disabled = false;
  bringEnding(page);
  bringShare(page);
  listenToKeys(page);
  leadFiles(() => typedQuery(page));
  const actions = {
    fields,
    launch: (/** @type {Record<string, number>} */ values) => launch(page, values),
    drop: (/** @type {Record<string, number>} */ values, /** @type {boolean} */ first) => dropWith(page, values, first),
    changed: () => updateAddressSoon(page),
  };
  const panels = new Panels(
    byId('tabs'),
    byId('tab-panels'),
    {
      ...actions,
      query: () => typedQuery(page),
      scene: () => page.typed ?? {},
      play: (scene, words) => play(page, scene, words),
      open: (id, link) => page.panels?.open(id, link),
      guide: guideOf(page),
    },
    (id, dropped) => brokenLinkNotice(`link-${id}`, dropped),
  );
  page.interaction = new PlotInteraction(byId('impacts-bar'), {
    ...actions,
    run,
    view,
    plots,
    typed: () => page.complete && { ...page.complete, derived: view.drawn.derived },
    query: () => typedQuery(page),
    follow: () => page.follow(false),
  });
  panels.join('brush', page.interaction);
  new Grab(byId('scene-frame'), { ...actions, view, typed: () => page.complete });
  bringSymbols(view);
  bringTracks(page, panels);
  bringImpacts({ run, query: () => playedQuery(page), csv: () => csvPath(page) });
  page.pins = new Pins(byId('pins'), page, others);
  panels.join('pin', page.pins);
  panels.join('you', new Hand(page));
  // Until they are restored, the address keeps their part of the link.
  page.panels = panels;
  panels.restore(page.panelLink);
  if (page.judged) panels.judged(page.judged);
  performance.mark('all parts');
}

/** The charts of the bounces and the eigenvalues, among the reasons. @param {import('../page.js').Page} page */
function bringCharts(page) {
  const { run, view } = page;
  page.plots = [
    anglePlane(run.impacts),
    velocityPlane(run.impacts),
    energyPlot(run.impacts, () => run.scene ?? view.drawn),
  ];
  for (const plot of page.plots) plot.preview(page.ahead);
  page.circle = new EigenvalueCircle();
  if (page.judged) page.circle.show(page.judged.answer);
  for (const one of [...page.plots, page.circle]) {
    const { figure } = one;
    byId('charts').append(figure.element);
    // The eigenvalues are a picture of the server.
    const view = one === page.circle ? undefined : /** @type {import('../../export/capture.js').Layered} */ (one);
    figure.offer(enlarger(figure.element, figure.title, () => savesOf(page, figure.id, figure.title, view)));
  }
}
