// One panel of the page alone, for a frame in somebody's dashboard: the scene, and the run if there is one, are in the address.
// Not for changing either: that is for the whole page, one click away.

import { bringCircle } from '../charts/eigenvalue-circle.js';
import { get } from '../api/client.js';
import { sceneQuery } from '../api/scene-query.js';
import { Run } from '../run/run.js';
import { SceneView } from '../scene/scene-view.js';
import { Selection } from '../run/selection.js';
import { anglePlane, energyPlot, velocityPlane } from '../charts/impacts/plots.js';
import { byId, h } from '../dom/elements.js';
import { brokenLinkNotice, clearNotice, connectionNotice, notice } from '../dom/notices.js';
import { invalidate } from '../charts/surface.js';
import { listen } from '../charts/impacts/plot-pointer.js';
import { ENTRIES, card } from '../panels/card.js';
import { sceneOf } from '../app/link.js';
import { ScenePage, begin } from '../panels/scene-page.js';

const id = location.pathname.split('/').at(-1) ?? '';
const main = byId('main');

/** A scene of an address with its fields and cases. @typedef {ReturnType<typeof sceneOf> & {fields: Field[], cases: Case[]}} Place */
/** A view of a run with its element, and what empties it for a new run. @typedef {{element: HTMLElement, view: SceneView | ImpactPlot, clear: () => void}} Shown */

/** The views of a run. @type {Record<string, (run: Run) => Shown>} */
const VIEWS = {
  scene: (run) => {
    const box = h('div', { class: 'scene-frame' });
    const readout = h('output', { class: 'readout', 'aria-live': 'off' });
    const element = h('section', { class: 'card scene', 'aria-label': 'Scene' }, box, readout);
    const view = new SceneView(box, readout, run);
    return { element, view, clear: () => view.reset() };
  },
  'plane-angle': (run) => plot(anglePlane(run.impacts), run),
  'plane-velocity': (run) => plot(velocityPlane(run.impacts), run),
  energy: (run) =>
    plot(
      energyPlot(run.impacts, () => run.scene),
      run,
    ),
};

/** @param {ImpactPlot} view @param {Run} run @returns {Shown} */
function plot(view, { impacts }) {
  const selection = new Selection(impacts);
  const spoken = h('p', { class: 'unseen', role: 'status' });
  const { element } = view.figure;
  selection.changed = () => view.redraw();
  element.append(spoken);
  const point = (/** @type {any} */ place) => view.point(place);
  const say = (/** @type {string} */ words) => {
    spoken.textContent = words;
  };
  // Nothing is released here, and no click offers to.
  listen(view, { impacts, selection, releases: null, point, say });
  selection.restore(new URLSearchParams(location.search));
  return { element, view, clear: () => view.clear() };
}

/** @param {(run: Run) => Shown} viewOf @param {Place} place */
function watch(viewOf, { link, query }) {
  const state = byId('run-state');
  const run = new Run();
  const { element, view, clear } = viewOf(run);
  run.watch({
    changed: () => {
      if (state.textContent !== run.words) state.textContent = run.words;
      if (run.phase !== 'lost') clearNotice('connection');
      view.redraw();
    },
    struck: () => invalidate(view),
    cleared: clear,
    lost: (seconds) => connectionNotice(seconds, () => run.retry()),
    refused: (problem) => notice('run', [problem.message], { dismissible: false, caution: true }),
  });
  main.append(element);
  for (const [key, value] of link.run ?? []) query.set(key, value);
  query.set('speed', String(link.speed));
  run.start(query);
}

/** @param {Place} place */
async function eigenvalues({ query }) {
  const circle = bringCircle();
  main.append(circle.figure.element);
  circle.show({ answer: await get(`v1/stability?${query}`), scene: query });
}

/** @param {Entry} entry @param {Place} place */
function panel(entry, { fields, cases, query }) {
  const page = new ScenePage('', fields, cases, [entry.id]);
  page.read(location.search);
  // Another scene opens in the whole page beside it, and a dashboard has nobody to press a button.
  const beside = (/** @type {URLSearchParams} */ other) => void open(`${whole}?${other}`, '_blank', 'noopener');
  /** @type {Partial<PanelPage> & {keep: () => void}} */
  const own = {
    unattended: true,
    keep: () => {},
    take: (scene) => beside(sceneQuery(scene, null, fields)),
    open: (_, part) => beside(new URLSearchParams([...query, ...part])),
    launch: (values) => {
      const other = new URLSearchParams(query);
      for (const [path, value] of Object.entries(values)) other.set(`scene.${path}`, String(value));
      beside(other);
    },
  };
  Object.assign(page, own);
  const { element, draw } = card(entry);
  main.append(element);
  page.addEventListener('change', () => draw(page));
  draw(page);
}

/** Parts that a frame can show, by their names. @type {Map<string, (place: Place) => unknown>} */
const shown = new Map();
for (const [name, viewOf] of Object.entries(VIEWS)) shown.set(name, (place) => watch(viewOf, place));
shown.set('circle', eigenvalues);
for (const entry of ENTRIES) shown.set(entry.id, (place) => panel(entry, place));

document.title = `${id} · equipoise`;
const whole = ENTRIES.find((entry) => entry.id === id)?.page === 'rig' ? 'rig' : './';
byId('whole', HTMLAnchorElement).href = `${whole}${location.search}`;
void begin((fields, cases) => {
  const place = { fields, cases, ...sceneOf(location.search, fields, cases) };
  const show = shown.get(id);
  brokenLinkNotice('link', place.link.dropped);
  if (!show) {
    const told = `There is no panel “${id.slice(0, 40)}”. There are: ${[...shown.keys()].join(', ')}.`;
    return main.append(h('p', { class: 'card' }, told));
  }
  // A panel of another scene would be taken for that of the address.
  return place.link.unknown === null && show(place);
});
