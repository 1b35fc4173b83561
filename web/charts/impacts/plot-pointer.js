// Pointer and keys on one chart of the impacts: point at one, select some, offer a release whose first impact is there.

import { drags, keepsFocus } from '../../dom/drag.js';
import { pressedIn } from '../../dom/elements.js';
import { toX, toY } from '../axes.js';
import { KEY_STEPS } from '../readable/chart-reader.js';
import { invalidate } from '../surface.js';

/** @typedef {import('../../run/selection.js').Selection} Selection */
/** The action of a click at a place. @typedef {Place & {words: string, possible: boolean}} Offer */

/** Less than this is a click that slipped, px. */
const SLIP = 5;
/** An impact or a place as near as this is meant, px. */
const NEAR = 24;

/** @param {number} value @param {number} low @param {number} size */
const clamped = (value, low, size) => Math.min(low + size, Math.max(low, value));

/**
 * @param {ImpactPlot} plot
 * @param {{impacts: Impacts, selection: Selection, releases: Releases | null, point: (place: number | null) => void, say: (words: string) => void}} parts
 * without `releases` nothing is released; `point` points at an impact in all plots
 */
export function listen(plot, { impacts, selection, releases, point, say }) {
  const { box } = plot.figure;
  const columns = [plot.meaning.x.column, plot.meaning.y.column];
  /** The selection before a drag. */
  let before = selection.ranges;
  /** The place that a click or a tap has offered. @type {Place | null} */
  let tapped = null;
  /** The impact that keys stand at, and where they began to select. @type {number | null} */
  let cursor = null;
  /** @type {number | null} */
  let anchor = null;
  /** @type {Offer | null} */
  let offered = null;
  plot.selection = selection;
  plot.over = (surface) => {
    drawBrush(surface, plot, selection);
    if (offered) drawOffer(surface, plot, offered);
  };
  for (const [name, value] of Object.entries({ role: 'application', 'aria-roledescription': 'chart', tabindex: '0' }))
    box.setAttribute(name, value);

  /** The nearest place in the frame. @param {Place} place */
  const within = ({ x, y }) => {
    const { left, top, width, height } = plot.frame;
    return { x: clamped(x, left, width), y: clamped(y, top, height) };
  };

  /** @param {Place} place */
  const inside = (place) => {
    const { x, y } = within(place);
    return x === place.x && y === place.y;
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

  /** Shows the action of a click. @param {Place | null} place */
  const offer = (place) => {
    const start = place && inside(place) ? releases?.startAt(plot, valuesAt(place)) : null;
    const possible = Boolean(start?.values);
    offered = place && start ? { ...place, words: possible ? `click: ${start.words}` : start.words, possible } : null;
    invalidate(plot);
  };

  /** Selects what lies between two places; with numbers no longer than the pixels tell. @param {Place} from @param {Place} to */
  const brush = (from, to) => {
    const { width, height, x, y } = plot.frame;
    const [one, other] = [valuesAt(from), valuesAt(to)];
    /** @param {number} a @param {number} b @param {number} pixel @returns {Interval} */
    const range = (a, b, pixel) => {
      const decimals = Math.min(20, Math.max(0, Math.ceil(-Math.log10(pixel))));
      return { low: Number(Math.min(a, b).toFixed(decimals)), high: Number(Math.max(a, b).toFixed(decimals)) };
    };
    selection.set([
      [columns[0], range(one.x, other.x, (x.high - x.low) / width)],
      [columns[1], range(one.y, other.y, (y.high - y.low) / height)],
    ]);
  };

  keepsFocus(box);
  const cancel = drags(box, box, SLIP, {
    press: (place) => {
      before = selection.ranges;
      return inside(place);
    },
    drag: (place, from, begins) => {
      if (begins) offer(null);
      brush(from, within(place));
    },
    release: (place, dragged, { pointerType }) => {
      if (dragged) return say(selection.words);
      // A finger is not as exact as the tip of a mouse, and does not hover.
      const touch = pointerType === 'touch';
      const again = tapped && Math.hypot(tapped.x - place.x, tapped.y - place.y) < (touch ? NEAR : SLIP);
      if (again && releases?.isOfferedIn(plot)) return releases.release();
      tapped = place;
      if (touch) point(nearest(place));
      offer(null);
      releases?.offer(plot, valuesAt(place));
      // The reason stays to be read.
      if (touch && !releases?.isOfferedIn(plot)) offer(place);
    },
    cancel: (dragged) => {
      if (dragged) selection.set(before);
    },
    hover: (place) => {
      point(nearest(place));
      offer(place);
    },
  });
  box.addEventListener('pointerleave', ({ pointerType }) => {
    if (pointerType === 'touch') return;
    point(null);
    offer(null);
  });
  box.addEventListener('blur', () => point(null));

  addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || event.defaultPrevented || !selection.active) return;
    if (pressedIn(event, 'input, select, textarea, dialog')) return;
    selection.set([]);
    say('Nothing selected');
  });
  box.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { begin, end } = impacts;
    const by = KEY_STEPS[event.key];
    const at = cursor !== null && cursor >= begin && cursor < end ? cursor : null;
    if (event.key === 'Escape' && cancel()) return event.preventDefault();
    if (by !== undefined && end > begin) move(by, at, event.shiftKey);
    else if (event.key === 'Enter' && at !== null)
      releases?.offer(plot, { x: impacts.at(columns[0], at), y: impacts.at(columns[1], at) });
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
    point(cursor);
    const words = plot.readout(cursor);
    if (selects) {
      anchor ??= from ?? cursor;
      const [low, high] = [impacts.at('n', anchor), impacts.at('n', cursor)].sort((a, b) => a - b);
      selection.set([['n', { low, high }]]);
    } else anchor = null;
    say(selects ? `${words}. ${selection.words}` : words);
  }
}

/** The selected ranges; where an axis has none, as wide as the plot. @param {Surface} surface @param {ImpactPlot} plot @param {Selection} selection */
function drawBrush(surface, { frame, meaning }, selection) {
  const [across, up] = [meaning.x, meaning.y].map(
    ({ column }) => selection.ranges.find(([name]) => name === column)?.[1],
  );
  if (!across && !up) return;
  const { left, top, width, height } = frame;
  const x0 = across ? clamped(toX(frame, across.low), left, width) : left;
  const x1 = across ? clamped(toX(frame, across.high), left, width) : left + width;
  const y0 = up ? clamped(toY(frame, up.high), top, height) : top;
  const y1 = up ? clamped(toY(frame, up.low), top, height) : top + height;
  surface.context.beginPath();
  surface.context.rect(x0, y0, x1 - x0, y1 - y0);
  surface.faintly(0.1, () => surface.fill('accent'));
  surface.stroke('ink');
}

/** @param {Surface} surface @param {ImpactPlot} plot @param {Offer} offer */
function drawOffer(surface, { frame: { left, top, width } }, { x, y, words, possible }) {
  const colour = possible ? 'ink' : 'strike';
  if (possible) {
    surface.line(colour, x - 6, y, x + 6, y, { width: 1.5 });
    surface.line(colour, x, y - 6, x, y + 6, { width: 1.5 });
  }
  surface.text(words, left + width, top - 6, {
    colour,
    size: 11,
    align: 'right',
    baseline: 'bottom',
    widest: width - 44,
  });
}
