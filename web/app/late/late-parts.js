// The parts that load after the first plot: panels below the fold, keys, pointing at plots, saving.

import { PlotInteraction } from '../../charts/impacts/plot-interaction.js';
import { copy } from '../../dom/clipboard.js';
import { byId, h } from '../../dom/elements.js';
import { brokenLinkNotice, clearNotice } from '../../dom/notices.js';
import { enlarger } from '../../export/enlarge-button.js';
import { styles } from '../../dom/styles.js';
import { bringImpacts } from '../../panels/impacts/load.js';
import { Panels } from '../../panels/panels.js';
import { bringPins } from '../../pins/load.js';
import { bringSceneTools } from '../../scene/tools/load.js';
import { bringTimeline } from '../../timeline/load.js';
import { bringShell } from '../../workbench/shell.js';
import { liveAddress, replayAddress, updateAddress, updateAddressSoon } from '../address-bar.js';
import { beginAutorun } from '../autorun.js';
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

/** @param {import('../page.js').Page} page */
export async function bringLateParts(page) {
  page.history = new History(page);
  beginAutorun(page);
  // Form, and buttons that save and enlarge, come with their styles, or without them where those do not load.
  await Promise.all(
    ['workbench/shell.css', 'workbench/present.css', 'form/form.css', 'app/app.css', 'export/export.css'].map(styles),
  ).catch(() => {});
  bringSettings(page);
  const { plots, circle, view, fields, run } = page;
  for (const one of [...plots, circle]) {
    const { figure } = one;
    // The eigenvalues are a picture of the server.
    const view = one === circle ? undefined : /** @type {import('../../export/capture.js').Layered} */ (one);
    figure.offer(enlarger(figure.element, figure.title, () => savesOf(page, figure.id, figure.title, view)));
  }
  const card = /** @type {HTMLElement} */ (byId('scene-frame').closest('.card'));
  card.querySelector('.card-head')?.append(enlarger(card, 'Scene', () => savesOf(page, 'scene', 'Scene', view)));
  const others = await bringTimeline(page);
  const chart = bringShell(() => updateAddressSoon(page));
  bringShare(page);
  listenToKeys(bindingsOf(page));
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
      play: (scene, words) => {
        document.dispatchEvent(new Event('show-scene'));
        play(page, scene, words);
      },
      open: (id, link) => page.panels?.open(id, link),
      take: (file, about) => page.interaction?.take(file, about),
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
    measured: {
      bar: byId('measured-bar'),
      // The tab Fit shows them too.
      show: () => page.panels?.query().get('tab') === 'fit' || page.panels?.show('measured'),
    },
    follow: () => page.follow(false),
  });
  panels.join('brush', page.interaction);
  panels.join('chart', chart);
  await styles('scene/tools/tools.css').catch(() => {});
  bringSceneTools({ ...actions, view, typed: () => page.complete });
  bringTracks(page, panels);
  void bringImpacts({ run, query: () => playedQuery(page), csv: () => csvPath(page) });
  panels.join('pin', await bringPins(page, others));
  // Until they are restored, the address keeps their part of the link.
  page.panels = panels;
  panels.restore(page.panelLink);
  if (page.judged) panels.judged(page.judged);
  performance.mark('all parts');
}
