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
import { RunSliders } from '../../run/sliders.js';
import { Grab } from '../../scene/grab.js';
import { bringSymbols } from '../../scene/symbols.js';
import { Fork } from '../../timeline/fork.js';
import { Others } from '../../timeline/others.js';
import { Timeline } from '../../timeline/timeline.js';
import { playedQuery, typedQuery, updateAddressSoon } from '../address-bar.js';
import { History } from '../history.js';
import { launch, play } from '../scenes.js';
import { GAIN } from '../page.js';
import { catchIt, guideOf, throwUp } from './guide.js';
import { listenToKeys } from './keys.js';
// It is there when the server is not.
import './run-problems.js';
import { bringSettings, markCritical } from './settings.js';
import { bringShare, saveCsv, savesOf } from './share.js';

const STYLES = [
  'play/late.css',
  'panels/verdict/verdict.css',
  'charts/charts.css',
  'form/form.css',
  'timeline/timeline.css',
  'app/app.css',
];

/** @param {import('../page.js').Page} page */
export async function bringLateParts(page) {
  page.history = new History(page);
  // Parts come with their styles, or without them where those do not load.
  await Promise.all(STYLES.map(styles)).catch(() => {});
  bringSettings(page);
  bringCharts(page);
  const { view, fields, run } = page;
  const others = bringTime(page);
  bringShell(() => page.panels?.show('why'));
  present(byId('present'), bringStories(page));
  byId('present', HTMLButtonElement).disabled = false;
  bringEnding(page);
  bringShare(page);
  listenToKeys(page);
  leadFiles(() => typedQuery(page));
  const guide = guideOf(page);
  const panels = new Panels(
    byId('tabs'),
    byId('tab-panels'),
    () => ({
      fields,
      query: typedQuery(page),
      scene: page.typed ?? {},
      take: (scene) => play(page, scene),
      launch: (values) => launch(page, values),
      dropWith: (values, first) => dropWith(page, values, first),
      guide,
    }),
    () => updateAddressSoon(page),
    (id, dropped) => brokenLinkNotice(`link-${id}`, dropped),
  );
  panels.join('brush', new PlotInteraction(byId('impacts-bar'), page));
  new Grab(byId('scene-frame'), page);
  bringSymbols(view);
  page.markGain = () => markCritical(page);
  page.markGain();
  bringImpacts({ run, query: () => playedQuery(page), save: () => saveCsv(page) });
  page.pins = new Pins(byId('pins'), page, others);
  panels.join('pin', page.pins);
  panels.join('you', new Hand(page));
  // Until they are restored, the address keeps their part of the link.
  page.panels = panels;
  panels.restore(page.panelLink);
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
  for (const plot of page.plots) {
    plot.preview(page.ahead);
    run.watch({ struck: plot.struck, cleared: () => plot.clear() });
  }
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

/** The time line, and what goes with it: the speed, deeds, another run from here on. @param {import('../page.js').Page} page */
function bringTime(page) {
  const { view, plots, controls, fields } = page;
  const [root, exact] = [byId('timeline'), byId('exact')];
  controls.sliders = new RunSliders(byId('controls'), exact, controls, {
    catchIt: () => catchIt(page),
    throwIt: () => throwUp(page),
  });
  const timeline = new Timeline(root, page);
  page.timeline = timeline;
  const others = new Others(view, plots);
  const field = fields.find((one) => one.field === GAIN);
  if (field) new Fork(root, exact, page, field, timeline, others);
  return others;
}
