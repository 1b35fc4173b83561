// The parts that load after the first picture: map, reasons, values, time line, keys, saving.

import { bringCircle } from '../../charts/eigenvalue-circle.js';
import { bringInteraction } from '../../charts/impacts/plot-interaction.js';
import { anglePlane, energyPlot, velocityPlane } from '../../charts/impacts/plots.js';
import { byId } from '../../dom/elements.js';
import { enlarger } from '../../export/enlarge.js';
import { styles } from '../../dom/styles.js';
import { bringImpacts } from '../../panels/impacts/load.js';
import { bringPanels } from '../../panels/panels.js';
import { bringPins } from '../../pins/pins.js';
import { bringHand } from '../../play/hand.js';
import { bringPresent, bringShell } from '../../play/shell.js';
import { bringEnding, bringStories } from '../../play/tell.js';
import { bringSliders } from '../../run/sliders.js';
import { bringGrab } from '../../scene/grab.js';
import { bringSymbols } from '../../scene/symbols.js';
import { bringFork } from '../../timeline/fork.js';
import { bringOthers } from '../../timeline/others.js';
import { bringTimeline } from '../../timeline/timeline.js';
import { bringHistory } from '../history.js';
import { listenToKeys } from './keys.js';
import { bringSettings } from './settings.js';
import { bringShare, savesOf } from './share.js';

const STYLES = [
  'play/late.css',
  'panels/verdict/verdict.css',
  'charts/charts.css',
  'form/form.css',
  'timeline/timeline.css',
  'app/app.css',
];

/** @param {Page} page */
export async function bringLateParts(page) {
  page.history = bringHistory(page);
  // Parts come with their styles, or without them where those do not load.
  await Promise.all(STYLES.map(styles)).catch(() => {});
  bringSettings(page);
  bringCharts(page);
  page.sliders = bringSliders(page);
  page.timeline = bringTimeline(page);
  page.others = bringOthers(page);
  bringFork(page);
  bringShell(page);
  bringPresent(bringStories(page));
  bringEnding(page);
  bringShare(page);
  listenToKeys(page);
  const panels = bringPanels(page);
  panels.join('brush', bringInteraction(page));
  bringGrab(page);
  bringSymbols(page.view);
  bringImpacts(page);
  page.pins = bringPins(page);
  panels.join('pin', page.pins);
  panels.join('you', bringHand(page));
  // Until they are restored, the address keeps their part of the link.
  page.panels = panels;
  panels.restore(page.panelLink);
  performance.mark('all parts');
}

/** The charts of the bounces and the eigenvalues, among the reasons. @param {Page} page */
function bringCharts(page) {
  const { run, view } = page;
  page.plots = [
    anglePlane(run.impacts),
    velocityPlane(run.impacts),
    energyPlot(run.impacts, () => run.scene ?? view.drawn),
  ];
  for (const plot of page.plots) {
    plot.preview(page.ahead);
    run.watch({ struck: plot.struck, cleared: () => plot.clear() });
  }
  page.circle = bringCircle();
  if (page.judged) page.circle.show(page.judged);
  for (const one of [...page.plots, page.circle]) {
    const { figure } = one;
    byId('charts').append(figure.element);
    // The eigenvalues are a picture of the server.
    const view = one === page.circle ? undefined : /** @type {CanvasView} */ (one);
    figure.offer(enlarger(figure.element, figure.title, () => savesOf(page, figure.id, figure.title, view)));
  }
}
