// The parts that load after the first picture: map, reasons, values, time line, keys, saving.

import { EigenvalueCircle } from '../../charts/eigenvalue-circle.js';
import { energyPlot } from '../../charts/impacts/energy-plot.js';
import { anglePlane, velocityPlane } from '../../charts/impacts/phase-planes.js';
import { PlotInteraction } from '../../charts/impacts/plot-interaction.js';
import { copy } from '../../dom/clipboard.js';
import { byId, h } from '../../dom/elements.js';
import { brokenLinkNotice, clearNotice } from '../../dom/notices.js';
import { enlarger } from '../../export/enlarge-button.js';
import { styles } from '../../dom/styles.js';
import { bringImpacts } from '../../panels/impacts/load.js';
import { Panels } from '../../panels/panels.js';
import { bringPins } from '../../pins/load.js';
import { bringEnding } from '../../play/ending.js';
import { dropWith } from '../../play/drop.js';
import { leadFiles } from '../../play/dropped-file.js';
import { present } from '../../play/present.js';
import { Hand } from '../../play/hand.js';
import { bringShell } from '../../play/shell.js';
import { bringStories } from '../../play/tell.js';
import { bringSceneTools } from '../../scene/tools/load.js';
import { bringTimeline } from '../../timeline/load.js';
import { liveAddress, replayAddress, updateAddress, updateAddressSoon } from '../address-bar.js';
import { History } from '../history.js';
import { playedQuery, typedQuery } from '../queries.js';
import { launch, play } from '../scenes.js';
import { guideOf } from './guide.js';
import { bindingsOf } from './key-bindings.js';
import { listenToKeys } from './keys.js';
// It is there when the server is not.
import './run-problems.js';
import { savesOf } from './saves.js';
import { bringSettings, bringTracks } from './settings.js';
import { bringShare, csvPath } from './share.js';

const STYLES = [
  'play/late.css',
  'panels/verdict/verdict.css',
  'charts/charts.css',
  'form/form.css',
  'app/app.css',
  'export/export.css',
];

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
  listenToKeys(bindingsOf(page));
  leadFiles(() => typedQuery(page));
  const copyLink =
    (/** @type {(page: import('../page.js').Page) => string} */ address) => (/** @type {Event} */ event) => {
      updateAddress(page);
      void copy(/** @type {HTMLElement} */ (event.currentTarget), address(page));
    };
  byId('share').addEventListener('click', copyLink(replayAddress));
  byId('share-menu').append(
    h('button', { type: 'button', id: 'share-live', click: copyLink(liveAddress) }, 'Copy link to join live'),
  );
  const actions = {
    fields,
    launch: (/** @type {Record<string, number>} */ values) => launch(page, values),
    drop: (/** @type {Record<string, number>} */ values, /** @type {import('../../panels/card.js').Turn} */ turn) =>
      dropWith(page, values, turn),
    changed: () => updateAddressSoon(page),
  };
  const panels = new Panels(
    byId('tabs'),
    byId('tab-panels'),
    {
      ...actions,
      query: () => typedQuery(page),
      scene: () => page.typed ?? {},
      chosen: () => page.chosen,
      played: () => playedQuery(page),
      play: (scene, words) => play(page, scene, words),
      open: (id, link) => page.panels?.open(id, link),
      guide: guideOf(page),
    },
    (id, dropped) => {
      if (dropped.length > 0) brokenLinkNotice(`link-${id}`, dropped);
      else clearNotice(`link-${id}`);
    },
  );
  page.interaction = new PlotInteraction(byId('impacts-bar'), {
    ...actions,
    run,
    view,
    plots,
    typed: () => page.complete && { ...page.complete, derived: view.drawn.derived },
    drawn: () => view.drawn,
    query: () => typedQuery(page),
    follow: () => page.follow(false),
  });
  panels.join('brush', page.interaction);
  await styles('scene/tools/tools.css').catch(() => {});
  bringSceneTools({ ...actions, view, typed: () => page.complete });
  bringTracks(page, panels);
  void bringImpacts({ run, query: () => playedQuery(page), csv: () => csvPath(page) });
  panels.join('pin', await bringPins(page, others));
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
  for (const plot of page.plots) void plot.preview(page.ahead);
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
