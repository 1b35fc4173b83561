// Pointer and keys on one chart of the impacts: point at one, select some, set where a run first lands.

import { drawBrush, drawOffer } from './overlay.js';
import { invalidate, placeIn } from '../surface.js';
import { angleStart, velocityStart, within } from '../../physics/first-impact.js';

/** @typedef {import('./impact-plot.js').ImpactPlot} ImpactPlot */
/** @typedef {import('../axes.js').Range} Range */
/** @typedef {{x: number, y: number}} Place px from the corner of a plot's box */

/**
 * @typedef {object} PointerParts
 * @property {import('../../run/impacts.js').Impacts} impacts
 * @property {import('../../run/selection.js').Selection} selection
 * @property {() => import('../../api/scene-fields.js').Scene | null} typed what a run would be released with; null while some of it is no value
 * @property {import('../../api/scene-fields.js').Field[]} fields
 * @property {import('./ghost.js').Ghost | null} ghost the release that a click offers; null where nothing is released
 * @property {(place: number | null) => void} point at an impact, in all plots
 * @property {(words: string) => void} say aloud
 */

/** Less than this is a click that slipped, px. */
const SLIP = 5;
/** An impact or a place as near as this is meant, px. */
const NEAR = 24;
/** Impacts that page up and page down go. */
const LEAP = 10;

/** @param {ImpactPlot} plot @param {PointerParts} page */
export function listen(plot, page) {
  const { box } = plot.figure;
  const { impacts, selection } = page;
  /** @type {(Place & {id: number, before: import('../../run/selection.js').Limits[]}) | null} */
  let pressed = null;
  let dragging = false;
  /** The place that a click or a tap has offered. @type {Place | null} */
  let tapped = null;
  /** The impact that keys stand at, and where they began to select. @type {number | null} */
  let cursor = null;
  /** @type {number | null} */
  let anchor = null;

  /** The action that a click would take. @type {import('./overlay.js').Offer | null} */
  let offered = null;
  plot.selection = selection;
  plot.over = (context) => {
    drawBrush(context, plot, selection);
    if (offered) drawOffer(context, plot, offered);
  };
  for (const [name, value] of Object.entries({ role: 'application', 'aria-roledescription': 'chart', tabindex: '0' }))
    box.setAttribute(name, value);

  /** @param {PointerEvent} event @returns {Place} */
  const placeOf = (event) => placeIn(box, event);
  /** @param {Place} place */
  const inside = ({ x, y }) => {
    const { left, top, width, height } = plot.frame;
    return x >= left && x <= left + width && y >= top && y <= top + height;
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

  /** @param {number} x @param {number} y values of a first impact */
  const startAt = (x, y) => {
    const scene = page.typed();
    return (
      scene &&
      within(plot.meaning.start === 'angle' ? angleStart(scene, x, y) : velocityStart(scene, x, y), page.fields)
    );
  };

  /** Shows the action that a click would take. @param {Place | null} place */
  const offer = (place) => {
    const values = plot.meaning.start && place && inside(place) ? valuesAt(place) : null;
    const start = values && startAt(values.x, values.y);
    offered =
      place && start
        ? { ...place, words: start.values ? `click: ${start.words}` : start.words, possible: start.values !== null }
        : null;
    invalidate(plot);
  };

  /** @param {number} x @param {number} y */
  const start = (x, y) => {
    if (!plot.meaning.start || !page.ghost) return;
    const found = startAt(x, y);
    offer(null);
    if (found?.values) return page.ghost.offer(plot, { x, y }, found.values, found.words);
    page.ghost.drop();
    page.say(found ? found.words : 'Nothing can be released: a parameter is not a number.');
  };

  /** Selects what lies between two places; with numbers no longer than the pixels tell. @param {Place} from @param {Place} to */
  const brush = (from, to) => {
    const { width, height, x, y } = plot.frame;
    const [one, other] = [valuesAt(from), valuesAt(to)];
    /** @param {number} a @param {number} b @param {number} pixel @returns {Range} */
    const range = (a, b, pixel) => {
      const decimals = Math.min(20, Math.max(0, Math.ceil(-Math.log10(pixel))));
      return { low: Number(Math.min(a, b).toFixed(decimals)), high: Number(Math.max(a, b).toFixed(decimals)) };
    };
    selection.set([
      [plot.meaning.x.column, range(one.x, other.x, (x.high - x.low) / width)],
      [plot.meaning.y.column, range(one.y, other.y, (y.high - y.low) / height)],
    ]);
  };
  const count = () => `${selection.places.length} of ${impacts.end - impacts.begin} bounces selected`;

  const release = () => {
    if (pressed && box.hasPointerCapture(pressed.id)) box.releasePointerCapture(pressed.id);
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
    const place = placeOf(event);
    if (event.button !== 0 || !event.isPrimary || !inside(place)) return;
    pressed = { ...place, id: event.pointerId, before: selection.ranges };
    box.setPointerCapture(event.pointerId);
  });
  box.addEventListener('pointermove', (event) => {
    const place = placeOf(event);
    if (!pressed) {
      page.point(nearest(place));
      return offer(place);
    }
    if (!dragging && Math.hypot(place.x - pressed.x, place.y - pressed.y) < SLIP) return;
    if (!dragging) offer(null);
    dragging = true;
    const { left, top, width, height } = plot.frame;
    brush(pressed, {
      x: Math.min(left + width, Math.max(left, place.x)),
      y: Math.min(top + height, Math.max(top, place.y)),
    });
  });
  box.addEventListener('pointerup', (event) => {
    if (!pressed) return;
    const place = { x: pressed.x, y: pressed.y };
    const dragged = dragging;
    release();
    if (dragged) return page.say(count());
    // A finger is not as exact as the tip of a mouse.
    const near = event.pointerType === 'touch' ? NEAR : SLIP;
    const again = tapped !== null && Math.hypot(tapped.x - place.x, tapped.y - place.y) < near;
    if (again && page.ghost?.offered?.plot === plot) return page.ghost.release();
    tapped = place;
    if (event.pointerType === 'touch') page.point(nearest(place));
    const values = valuesAt(place);
    start(values.x, values.y);
    // A finger does not hover, so that the reason stays to be read.
    if (event.pointerType === 'touch' && !page.ghost?.offered) offer(place);
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
    if (event.key === 'Escape' && pressed) cancel();
    else if (end > begin && move(event)) {
      /* done */
    } else if (event.key === 'Enter' && cursor !== null && cursor >= begin && cursor < end)
      start(impacts.at(plot.meaning.x.column, cursor), impacts.at(plot.meaning.y.column, cursor));
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  /** @param {KeyboardEvent} event @returns {boolean} whether it was for moving */
  function move({ key, shiftKey }) {
    const { begin, end } = impacts;
    const step = {
      ArrowRight: 1,
      ArrowUp: 1,
      ArrowLeft: -1,
      ArrowDown: -1,
      PageUp: LEAP,
      PageDown: -LEAP,
      Home: -Infinity,
      End: Infinity,
    }[key];
    if (step === undefined) return false;
    const from = cursor !== null && cursor >= begin && cursor < end ? cursor : null;
    // The first key shows where one is.
    cursor =
      from === null && Number.isFinite(step) ? end - 1 : Math.min(end - 1, Math.max(begin, (from ?? end - 1) + step));
    page.point(cursor);
    const words = plot.meaning.readout(impacts, cursor);
    if (shiftKey) {
      anchor ??= from ?? cursor;
      const [low, high] = [impacts.at('n', anchor), impacts.at('n', cursor)].sort((a, b) => a - b);
      selection.set([['n', { low, high }]]);
    } else anchor = null;
    page.say(shiftKey ? `${words}. ${count()}` : words);
    return true;
  }
}
