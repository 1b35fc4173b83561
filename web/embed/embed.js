// One panel of the page alone, for a frame in somebody's dashboard: the scene, and the run if there is one, are in the address.
// Not for changing either: that is for the whole page, one click away.

import { EigenvalueCircle } from '../charts/eigenvalue-circle.js';
import { get, wordsOf } from '../api/client.js';
import { Run } from '../run/run.js';
import { SceneView } from '../scene/scene-view.js';
import { Selection } from '../run/selection.js';
import { anglePlane, energyPlot, velocityPlane } from '../charts/impacts/plots.js';
import { byId, h, retryButton } from '../dom/elements.js';
import { clearNotice, connectionNotice, notice } from '../dom/notices.js';
import { invalidate } from '../charts/surface.js';
import { listen } from '../charts/impacts/plot-pointer.js';
import { styles } from '../dom/styles.js';
import { CHAPTERS, PANEL_CHAPTERS, head } from '../paper/chapters.js';
import { PANELS } from '../panels/registry.js';
import { card } from '../panels/card.js';
import { sceneOf, scenePage } from '../panels/scene-page.js';
import { RIG_PANELS } from '../rig/panels.js';

const id = location.pathname.split('/').at(-1) ?? '';
const main = byId('main');

/** @param {string[]} what */
const dropped = (what) => {
  if (what.length > 0)
    notice('link', ['This address was not whole. Dropped: ', what.join('; '), '.'], { caution: true });
};

/** The views of a run, each with its element. @type {Record<string, (run: Run) => {element: HTMLElement, view: SceneView | import('../charts/impacts/impact-plot.js').ImpactPlot}>} */
const VIEWS = {
  scene: (run) => {
    const box = h('div', { class: 'scene-frame' });
    const readout = h('output', { class: 'readout', 'aria-live': 'off' });
    const element = h('section', { class: 'card scene', 'aria-label': 'Scene' }, box, readout);
    return { element, view: new SceneView(box, readout, run) };
  },
  'plane-angle': (run) => plot(anglePlane(run.impacts), run),
  'plane-velocity': (run) => plot(velocityPlane(run.impacts), run),
  energy: (run) =>
    plot(
      energyPlot(run.impacts, () => run.scene),
      run,
    ),
};

/** @param {import('../charts/impacts/impact-plot.js').ImpactPlot} view @param {Run} run */
function plot(view, { impacts }) {
  const selection = new Selection(impacts);
  const spoken = h('p', { class: 'unseen', role: 'status' });
  selection.changed = () => view.redraw();
  view.figure.element.append(spoken);
  // Nothing is released here, and no click offers to.
  delete view.meaning.start;
  listen(view, {
    impacts,
    selection,
    typed: () => null,
    fields: [],
    ghost: null,
    point: (place) => view.point(place),
    say: (words) => {
      spoken.textContent = words;
    },
  });
  selection.restore(new URLSearchParams(location.search));
  return { element: view.figure.element, view };
}

/** @param {string} name @param {URLSearchParams} query */
function watch(name, query) {
  const state = byId('run-state');
  const run = new Run({
    changed: () => {
      if (state.textContent !== run.words) state.textContent = run.words;
      shown?.redraw();
    },
    struck: () => {
      if (shown) invalidate(shown);
    },
    cleared: () => {
      if (shown instanceof SceneView) shown.reset();
      else shown?.clear();
    },
    lost: (seconds) => connectionNotice(seconds, () => run.retry()),
    refused: (problem) => {
      clearNotice('connection');
      notice('run', [problem.message], { dismissible: false, caution: true });
    },
    problem: () => {},
  });
  /** @type {ReturnType<typeof VIEWS['scene']>['view'] | null} */
  let shown = null;
  const { element, view } = VIEWS[name](run);
  shown = view;
  main.append(element);
  run.start(query);
}

/** @param {URLSearchParams} query */
async function eigenvalues(query) {
  const circle = new EigenvalueCircle();
  main.append(circle.figure.element);
  circle.show(await get(`v1/stability?${query}`));
}

async function begin() {
  const [{ items: fields }, { items: cases }] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
  const { link, chosen, scene, query } = sceneOf(location.search, fields, cases);
  dropped(link.dropped);
  const whole = id in RIG_PANELS ? 'rig' : './';
  byId('whole', HTMLAnchorElement).href = `${whole}${location.search}`;
  const all = [...Object.values(RIG_PANELS), ...PANELS, ...PANEL_CHAPTERS];
  const own = all.find((one) => one.id === id);
  const chapter = CHAPTERS.find((one) => one.id === id);
  // A panel of another scene would be taken for that of the address.
  if (link.unknown !== null && (own || chapter || id === 'circle' || id in VIEWS)) return;
  if (id in VIEWS) {
    for (const [key, value] of link.run ?? []) query.set(key, value);
    query.set('speed', String(link.speed));
    return watch(id, query);
  }
  if (id === 'circle') return eigenvalues(query);
  if (chapter) return read(chapter, { fields, cases, chosen });
  if (!own) {
    const ids = new Set([...Object.keys(VIEWS), 'circle', ...[...all, ...CHAPTERS].map((one) => one.id)]);
    return main.append(
      h('p', { class: 'card' }, `There is no panel “${id.slice(0, 40)}”. There are: ${[...ids].join(', ')}.`),
    );
  }
  const page = scenePage(
    fields,
    () => ({ chosen, scene, query }),
    () => {},
    whole,
  );
  const mounted = async (/** @type {import('../panels/card.js').Panel} */ panel) => {
    dropped(panel.restore?.(link.panels) ?? []);
    // A dashboard has nobody to press a button.
    panel.ask?.();
    if (panel.judged) panel.judged({ answer: await get(`v1/stability?${query}`), scene: query });
  };
  const { element, bring } = card(
    own,
    page,
    () => link.panels,
    (panel) => void mounted(panel),
  );
  main.append(element);
  await bring();
}

/**
 * A chapter of the paper's page.
 * @param {typeof CHAPTERS[number]} chapter
 * @param {import('../paper/words.js').Context} context
 */
async function read(chapter, context) {
  const [{ render }, { body }] = await Promise.all([
    import('../vendor/preact/preact.js'),
    chapter.load(context),
    styles('paper/paper.css'),
  ]);
  const card = h('section', { class: 'card reading', 'aria-labelledby': `${chapter.id}-title` });
  main.append(card);
  render([head(chapter), body], card);
}

begin().catch((error) => {
  notice('server', [wordsOf(error), ' ', retryButton(() => location.reload())], {
    dismissible: false,
    caution: true,
  });
});
document.title = `${id} · equipoise`;
