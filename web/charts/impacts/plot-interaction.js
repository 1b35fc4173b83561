// The interaction with all charts of the bounces: one selection, one bounce pointed at, a start by a click.

import { Problem } from '../../api/client.js';
import { Follower } from '../../api/latest-request.js';
import { launch } from '../../app/scenes.js';
import { byId, h, pressedIn } from '../../dom/elements.js';
import { contactDistance } from '../../physics/body.js';
import { within } from '../../physics/first-impact.js';
import { Selection } from '../../run/selection.js';
import { computedRun } from '../../timeline/others.js';
import { invalidate } from '../surface.js';
import { listen } from './plot-pointer.js';

/** @param {Page} page @returns {Neighbour} */
export function bringInteraction(page) {
  const { run, view, plots } = page;
  const { impacts } = run;
  const selection = new Selection(impacts);
  const told = byId('brush-told');
  const [byPointer, byKeys] = [told, byId('impacts-hint')].map(({ textContent }) => textContent);
  const drop = byId('brush-clear');
  drop.onclick = () => selection.set([]);
  /** True while keys go to one of the plots. */
  let keyed = false;
  const words = {
    draw: () => {
      drop.hidden = !selection.active;
      const now = selection.active ? selection.words : keyed ? byKeys : byPointer;
      if (told.textContent !== now) told.textContent = now;
      return false;
    },
  };
  /** Speaks when keys move or a selection is made; a pointer's way over a chart is not spoken. @param {string} said */
  const say = (said) => {
    byId('impacts-spoken').textContent = said;
  };
  const point = (/** @type {number | null} */ place) => {
    for (const one of plots) one.point(place);
  };
  const releases = bringReleases(page, say);
  for (const plot of plots) {
    listen(plot, { impacts, selection, releases, point, say });
    const { box } = plot.figure;
    box.setAttribute('aria-describedby', 'impacts-hint');
    // A pointer does not give the focus.
    for (const event of ['focus', 'blur'])
      box.addEventListener(event, () => {
        keyed = event === 'focus';
        invalidate(words);
      });
  }
  selection.changed = () => {
    for (const one of [...plots, view]) one.redraw();
    invalidate(words);
    page.updateAddressSoon();
  };
  view.under = (stage, scene) => drawContacts(stage, scene, impacts, selection);
  run.watch({
    struck: () => {
      selection.update();
      invalidate(words);
    },
    cleared: () => {
      selection.forget();
      invalidate(words);
    },
  });
  return {
    // An offered release belongs to the scene before.
    sceneChanged: () => releases.drop(),
    query: () => selection.query(),
    restore: (link) => selection.restore(link),
  };
}

/**
 * The places of the selected contacts along the floor of the scene.
 * @param {Stage} stage
 * @param {Scene} scene
 * @param {Impacts} impacts
 * @param {Selection} selection
 */
function drawContacts({ surface, x: across, y }, scene, impacts, selection) {
  const { context, width } = surface;
  const l = contactDistance(scene);
  const top = y(0) + 2;
  const marked = new Set();
  context.beginPath();
  for (const place of selection.places) {
    const x = Math.round(across(impacts.at('x', place) + (l && l * Math.sin(impacts.at('theta', place)))));
    if (!(x > 0 && x < width) || marked.has(x)) continue;
    marked.add(x);
    context.moveTo(x, top);
    context.lineTo(x + 4, top + 8);
    context.lineTo(x - 4, top + 8);
    context.closePath();
  }
  surface.fill('accent');
  surface.stroke('ink');
}

/** The values of an impact in a plot. @typedef {{x: number, y: number}} Values */

/** Impacts of its own that a ghost shows. */
const SHOWN = 200;
/** A button of these takes Enter for itself. */
const OWN_ENTER = 'a, button, input, select, textarea, summary, dialog, [tabindex]';

/** Releases that a click in a plane offers: a mark and the impacts in all planes, with a button that releases. @param {Page} page @param {(words: string) => void} say aloud */
export function bringReleases(page, say) {
  /** @type {{plot: ImpactPlot, at: Values, values: Record<string, number>, words: string} | null} */
  let offered = null;
  const words = h('p', {});
  const slip = h(
    'div',
    { class: 'slip ghost', role: 'group', 'aria-label': 'Release offered' },
    words,
    h('button', { type: 'button', class: 'primary', id: 'ghost-release', click: () => release() }, 'Release here'),
    h('button', { type: 'button', class: 'ghost-drop', 'aria-label': 'Drop it', click: () => drop() }, '×'),
  );

  /** @param {RunState | null} run */
  const show = (run) => {
    for (const plot of page.plots) plot.ghost({ run, at: offered?.plot === plot ? offered.at : null });
  };

  /** Asks for the impacts. */
  const asks = new Follower(async (/** @type {Record<string, number>} */ values, signal) => {
    const query = page.typedQuery;
    if (!query) return;
    for (const [path, value] of Object.entries(values)) query.set(`scene.${path}`, String(value));
    try {
      const run = await computedRun(query, SHOWN, signal);
      if (signal.aborted) return;
      show(run);
      page.view.preview(run);
    } catch (error) {
      // The mark and the words are there all the same; a refusal says why there is no run.
      if (!signal.aborted && error instanceof Problem && error.errors.length > 0)
        words.textContent = error.errors.map(({ detail }) => detail).join(' ');
    }
  });

  /** The release with this first impact; null while some of the typed scene is no value, or in a plot without releases. @param {ImpactPlot} plot @param {Values} first */
  const startAt = ({ meaning: { start } }, { x, y }) => {
    const { complete, view, fields } = page;
    return start && complete ? within(start({ ...complete, derived: view.drawn.derived }, x, y), fields) : null;
  };

  /** @param {ImpactPlot} plot that was clicked @param {Values} at values of the first impact */
  const offer = (plot, at) => {
    if (!plot.meaning.start) return;
    const { values, words: told = 'Nothing can be released: a parameter is not a number.' } = startAt(plot, at) ?? {};
    if (!values) {
      drop();
      return say(told);
    }
    offered = { plot, at, values, words: told };
    words.replaceChildren(...told.split(', ').flatMap((part) => [h('span', {}, part), ' ']));
    // At the end that is farther from its mark.
    const { low, high } = plot.frame.y;
    slip.classList.toggle('top', at.y < (low + high) / 2);
    plot.figure.box.append(slip);
    show(null);
    say(`${told}. Enter releases there, Escape drops it.`);
    asks.cancel();
    asks.want(values);
  };

  const drop = () => {
    if (!offered) return;
    asks.cancel();
    const { box } = offered.plot.figure;
    offered = null;
    const focused = slip.contains(document.activeElement);
    slip.remove();
    if (focused) box.focus({ preventScroll: true });
    for (const plot of page.plots) plot.ghost(null);
    // The scene shows the flights of what is typed again.
    page.follow(false);
  };

  const release = () => {
    if (!offered) return;
    const { values, words: told } = offered;
    drop();
    launch(page, values);
    say(`Released anew for a first bounce there: ${told}`);
  };

  // They are not the plot's, and the focus is for keys.
  for (const event of ['pointerdown', 'pointermove', 'pointerup'])
    slip.addEventListener(event, (one) => one.stopPropagation());
  addEventListener('click', ({ target }) => {
    if (!page.plots.some(({ figure }) => target instanceof Node && figure.box.contains(target))) drop();
  });
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    if (!offered || event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const isOurs = event.target === offered.plot.figure.box || !pressedIn(event, OWN_ENTER);
    if (event.key === 'Escape') drop();
    else if (event.key === 'Enter' && isOurs) release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  addEventListener('keydown', press, { capture: true });
  return { isOfferedIn: (/** @type {ImpactPlot} */ plot) => offered?.plot === plot, startAt, offer, drop, release };
}
