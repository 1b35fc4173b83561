// Pointer and keys on one chart of the impacts: point at one, select some, offer a release whose first impact is there.

import { Problem, get } from '../../api/client.js';
import { LatestRequest } from '../../api/latest-request.js';
import { typedQuery } from '../../app/address-bar.js';
import { launch } from '../../app/scenes.js';
import { h } from '../../dom/elements.js';
import { line, text, toX, toY } from '../axes.js';
import { KEY_STEPS } from '../readable/chart-reader.js';
import { invalidate, placeIn } from '../surface.js';
import { theme } from '../theme.js';
import { recordedRun } from '../../timeline/others.js';
import { angleStart, velocityStart, within } from '../../physics/first-impact.js';

/** @typedef {import('./impact-plot.js').ImpactPlot} ImpactPlot */
/** @typedef {import('../../run/selection.js').Selection} Selection */
/** @typedef {{x: number, y: number}} Place px from the corner of a plot's box */
/** @typedef {Place & {words: string, possible: boolean}} Offer what a click would do at a place */

/**
 * @typedef {object} PointerParts
 * @property {import('../../run/impacts.js').Impacts} impacts
 * @property {Selection} selection
 * @property {Ghost | null} ghost without one nothing is released
 * @property {() => import('../../api/scene-fields.js').Scene | null} typed what a run would be released with; null while some of it is no value
 * @property {import('../../api/scene-fields.js').Field[]} fields
 * @property {(place: number | null) => void} point at an impact in all plots
 * @property {(words: string) => void} say
 */

/** Less than this is a click that slipped, px. */
const SLIP = 5;
/** An impact or a place as near as this is meant, px. */
const NEAR = 24;

/** Impacts of its own that a ghost shows. */
const SHOWN = 200;
/** A button of these takes Enter for itself. */
const OWN_ENTER = 'a, button, input, select, textarea, summary, dialog, [tabindex]';

/** @param {number} value @param {number} low @param {number} size */
const clamped = (value, low, size) => Math.min(low + size, Math.max(low, value));

/** @param {ImpactPlot} plot @param {PointerParts} page */
export function listen(plot, page) {
  const { box } = plot.figure;
  const { impacts, selection } = page;
  /** @type {(Place & {before: import('../../run/selection.js').Limits[]}) | null} */
  let pressed = null;
  let dragging = false;
  /** The place that a click or a tap has offered. @type {Place | null} */
  let tapped = null;
  /** The impact that keys stand at, and where they began to select. @type {number | null} */
  let cursor = null;
  /** @type {number | null} */
  let anchor = null;
  /** The action that a click would take. @type {Offer | null} */
  let offered = null;
  plot.selection = selection;
  plot.over = (context) => {
    drawBrush(context, plot, selection);
    if (offered) drawOffer(context, plot, offered);
  };
  for (const [name, value] of Object.entries({ role: 'application', 'aria-roledescription': 'chart', tabindex: '0' }))
    box.setAttribute(name, value);

  /** @param {Place} place */
  const inside = ({ x, y }) => {
    const { left, top, width, height } = plot.frame;
    return x === clamped(x, left, width) && y === clamped(y, top, height);
  };

  /** @param {Place} place */
  const nearest = (place) => {
    let best = null;
    let distance = NEAR ** 2;
    for (let one = impacts.begin; one < impacts.end; one += 1) {
      const [x, y] = plot.at(one);
      const d = (x - place.x) ** 2 + (y - place.y) ** 2;
      if (d <= distance) {
        distance = d;
        best = one;
      }
    }
    return best;
  };

  /** The values at a place. @param {Place} place */
  const valuesAt = ({ x, y }) => {
    const { left, top, width, height, x: across, y: up } = plot.frame;
    return {
      x: across.low + ((x - left) / width) * (across.high - across.low),
      y: up.low + ((top + height - y) / height) * (up.high - up.low),
    };
  };

  /** @param {{x: number, y: number}} values of a first impact */
  const startAt = ({ x, y }) => {
    const scene = page.typed();
    const found = plot.meaning.start === 'angle' ? angleStart : velocityStart;
    return scene && within(found(scene, x, y), page.fields);
  };

  /** Shows the action that a click would take. @param {Place | null} place */
  const offer = (place) => {
    const start = plot.meaning.start && place && inside(place) ? startAt(valuesAt(place)) : null;
    const possible = Boolean(start?.values);
    offered = place && start && { ...place, words: possible ? `click: ${start.words}` : start.words, possible };
    invalidate(plot);
  };

  /** @param {{x: number, y: number}} values of a first impact */
  const start = (values) => {
    if (!plot.meaning.start || !page.ghost) return;
    const found = startAt(values);
    offer(null);
    if (found?.values) return page.ghost.offer(plot, values, found.values, found.words);
    page.ghost.drop();
    page.say(found ? found.words : 'Nothing can be released: a parameter is not a number.');
  };

  /** Selects what lies between two places; with numbers no longer than the pixels tell. @param {Place} from @param {Place} to */
  const brush = (from, to) => {
    const { width, height, x, y } = plot.frame;
    const [one, other] = [valuesAt(from), valuesAt(to)];
    /** @param {number} a @param {number} b @param {number} pixel @returns {import('../axes.js').Range} */
    const range = (a, b, pixel) => {
      const decimals = Math.min(20, Math.max(0, Math.ceil(-Math.log10(pixel))));
      return { low: Number(Math.min(a, b).toFixed(decimals)), high: Number(Math.max(a, b).toFixed(decimals)) };
    };
    selection.set([
      [plot.meaning.x.column, range(one.x, other.x, (x.high - x.low) / width)],
      [plot.meaning.y.column, range(one.y, other.y, (y.high - y.low) / height)],
    ]);
  };

  const release = () => {
    pressed = null;
    dragging = false;
  };
  const cancel = () => {
    if (pressed && dragging) selection.set(pressed.before);
    release();
  };

  // The focus is for keys: whoever clicks goes on with the keys of the page.
  box.addEventListener('mousedown', (event) => event.preventDefault());
  box.addEventListener('pointerdown', (event) => {
    const place = placeIn(box, event);
    if (event.button !== 0 || !event.isPrimary || !inside(place)) return;
    pressed = { ...place, before: selection.ranges };
    box.setPointerCapture(event.pointerId);
  });
  box.addEventListener('pointermove', (event) => {
    const place = placeIn(box, event);
    if (!pressed) {
      page.point(nearest(place));
      return offer(place);
    }
    if (!dragging && Math.hypot(place.x - pressed.x, place.y - pressed.y) < SLIP) return;
    if (!dragging) offer(null);
    dragging = true;
    const { left, top, width, height } = plot.frame;
    brush(pressed, { x: clamped(place.x, left, width), y: clamped(place.y, top, height) });
  });
  box.addEventListener('pointerup', (event) => {
    if (!pressed) return;
    const place = { x: pressed.x, y: pressed.y };
    const dragged = dragging;
    release();
    if (dragged) return page.say(selection.words);
    // A finger is not as exact as the tip of a mouse, and does not hover.
    const touch = event.pointerType === 'touch';
    const again = tapped && Math.hypot(tapped.x - place.x, tapped.y - place.y) < (touch ? NEAR : SLIP);
    if (again && page.ghost?.offered?.plot === plot) return page.ghost.release();
    tapped = place;
    if (touch) page.point(nearest(place));
    start(valuesAt(place));
    // The reason stays to be read.
    if (touch && !page.ghost?.offered) offer(place);
  });
  box.addEventListener('pointercancel', cancel);
  box.addEventListener('pointerleave', (event) => {
    if (pressed || event.pointerType === 'touch') return;
    page.point(null);
    offer(null);
  });
  box.addEventListener('blur', () => page.point(null));

  addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || event.defaultPrevented || !selection.active) return;
    if (event.target instanceof Element && event.target.closest('input, select, textarea, dialog')) return;
    selection.set([]);
    page.say('Nothing selected');
  });
  box.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { begin, end } = impacts;
    const by = KEY_STEPS[event.key];
    const at = cursor !== null && cursor >= begin && cursor < end ? cursor : null;
    if (event.key === 'Escape' && pressed) cancel();
    else if (by !== undefined && end > begin) move(by, at, event.shiftKey);
    else if (event.key === 'Enter' && at !== null)
      start({ x: impacts.at(plot.meaning.x.column, at), y: impacts.at(plot.meaning.y.column, at) });
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  /** @param {number} by impacts @param {number | null} from @param {boolean} selects */
  function move(by, from, selects) {
    const { begin, end } = impacts;
    // The first key shows where one is.
    const to = from === null && Number.isFinite(by) ? end - 1 : (from ?? end - 1) + by;
    cursor = Math.min(end - 1, Math.max(begin, to));
    page.point(cursor);
    const words = plot.readout(cursor);
    if (selects) {
      anchor ??= from ?? cursor;
      const [low, high] = [impacts.at('n', anchor), impacts.at('n', cursor)].sort((a, b) => a - b);
      selection.set([['n', { low, high }]]);
    } else anchor = null;
    page.say(selects ? `${words}. ${selection.words}` : words);
  }
}

/** A release that a click in a plane offers: its mark and its impacts in all planes, with a button that releases it. */
export class Ghost {
  #page;
  #say;
  #words = h('p', {});
  #element = h(
    'div',
    { class: 'slip ghost', role: 'group', 'aria-label': 'Release offered' },
    this.#words,
    h('button', { type: 'button', class: 'primary', id: 'ghost-release', click: () => this.release() }, 'Release here'),
    h('button', { type: 'button', class: 'ghost-drop', 'aria-label': 'Drop it', click: () => this.drop() }, '×'),
  );
  /** @type {{plot: ImpactPlot, at: {x: number, y: number}, values: Record<string, number>, words: string} | null} */
  offered = null;
  #asking = new LatestRequest();

  /** @param {import('../../app/page.js').Page} page @param {(words: string) => void} say aloud */
  constructor(page, say) {
    this.#page = page;
    this.#say = say;
    // They are not the plot's, and the focus is for keys.
    for (const event of ['pointerdown', 'pointermove', 'pointerup'])
      this.#element.addEventListener(event, (one) => one.stopPropagation());
    addEventListener('keydown', (event) => this.#key(event), { capture: true });
    addEventListener('click', ({ target }) => {
      const inside = target instanceof Node && page.plots.some(({ figure }) => figure.box.contains(target));
      if (!inside) this.drop();
    });
  }

  /**
   * @param {ImpactPlot} plot that was clicked
   * @param {{x: number, y: number}} at values of the first impact
   * @param {Record<string, number>} values to release with
   * @param {string} words
   */
  offer(plot, at, values, words) {
    this.offered = { plot, at, values, words };
    this.#words.replaceChildren(...words.split(', ').flatMap((part) => [h('span', {}, part), ' ']));
    // At the end that is farther from its mark.
    const { low, high } = plot.frame.y;
    this.#element.classList.toggle('top', at.y < (low + high) / 2);
    plot.figure.box.append(this.#element);
    this.#show(null);
    this.#say(`${words}. Enter releases there, Escape drops it.`);
    void this.#follow(values);
  }

  release() {
    const offered = this.offered;
    if (!offered) return;
    this.drop();
    launch(this.#page, offered.values);
    this.#say(`Released anew for a first bounce there: ${offered.words}`);
  }

  drop() {
    if (!this.offered) return;
    this.#asking.cancel();
    this.offered = null;
    const focused = this.#element.contains(document.activeElement);
    const box = this.#element.parentElement;
    this.#element.remove();
    if (focused) box?.focus({ preventScroll: true });
    for (const plot of this.#page.plots) plot.ghost(null);
    // The scene shows the flights of what is typed again.
    this.#page.follow(false);
  }

  /** @param {import('../../run/run-state.js').RunState | null} run */
  #show(run) {
    const first = run && run.impacts.end > 0 ? run.impacts.row(0) : null;
    for (const plot of this.#page.plots) {
      const { x, y } = plot.meaning;
      const clicked = plot === this.offered?.plot;
      const at = clicked ? (this.offered?.at ?? null) : first && { x: first[x.column], y: first[y.column] };
      plot.ghost({ at, clicked, run });
    }
  }

  /** Asks for its impacts. @param {Record<string, number>} values */
  async #follow(values) {
    const signal = this.#asking.next();
    const query = typedQuery(this.#page);
    if (!query) return;
    for (const [path, value] of Object.entries(values)) query.set(`scene.${path}`, String(value));
    try {
      const answer = await get(`v1/trajectories?${query}&bounces=${SHOWN}`, signal);
      if (signal.aborted) return;
      const run = recordedRun(answer);
      this.#show(run);
      this.#page.view.preview(run);
    } catch (error) {
      // Its mark and its words are there all the same; a refusal says why there is no run.
      if (!signal.aborted && error instanceof Problem && error.errors.length > 0)
        this.#words.textContent = error.errors.map(({ detail }) => detail).join(' ');
    }
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (!this.offered || event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const target = event.target instanceof Element ? event.target : null;
    if (event.key === 'Escape') this.drop();
    else if (event.key === 'Enter' && (target === this.offered.plot.figure.box || !target?.closest(OWN_ENTER)))
      this.release();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/**
 * The selected ranges; where an axis has none, as wide as the plot.
 * @param {CanvasRenderingContext2D} context
 * @param {ImpactPlot} plot
 * @param {Selection} selection
 */
function drawBrush(context, { frame, meaning }, selection) {
  const [across, up] = [meaning.x, meaning.y].map(
    ({ column }) => selection.ranges.find(([name]) => name === column)?.[1],
  );
  if (!across && !up) return;
  const { left, top, width, height } = frame;
  const x0 = across ? clamped(toX(frame, across.low), left, width) : left;
  const x1 = across ? clamped(toX(frame, across.high), left, width) : left + width;
  const y0 = up ? clamped(toY(frame, up.high), top, height) : top;
  const y1 = up ? clamped(toY(frame, up.low), top, height) : top + height;
  const { accent, ink } = theme();
  context.globalAlpha = 0.1;
  context.fillStyle = accent;
  context.fillRect(x0, y0, x1 - x0, y1 - y0);
  context.globalAlpha = 1;
  context.lineWidth = 1;
  context.strokeStyle = ink;
  context.strokeRect(x0, y0, x1 - x0, y1 - y0);
}

/** @param {CanvasRenderingContext2D} context @param {ImpactPlot} plot @param {Offer} offer */
function drawOffer(context, { frame: { left, top, width } }, { x, y, words, possible }) {
  const { ink, strike } = theme();
  context.lineWidth = 1.5;
  if (possible) {
    line(context, ink, x - 6, y, x + 6, y);
    line(context, ink, x, y - 6, x, y + 6);
  }
  const colour = possible ? ink : strike;
  text(context, words, left + width, top - 6, {
    colour,
    size: 11,
    align: 'right',
    baseline: 'bottom',
    widest: width - 44,
  });
}
