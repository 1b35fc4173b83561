// A canvas context that writes SVG: drawings are recorded with all their digits, while a context of a scratch canvas keeps styles and
// transformations. It knows the shapes that this page draws.

import { escaped } from '../charts/svg.js';
import { h } from '../dom/elements.js';

/** @param {number} value */
const short = (value) => String(Math.round(value * 100) / 100);

const ANCHORS = { left: 'start', start: 'start', center: 'middle', right: 'end', end: 'end' };
/** Shift of text against its baseline, em. Not every reader of SVG knows `dominant-baseline`. */
const SHIFTS = { top: 0.8, hanging: 0.8, middle: 0.33, alphabetic: 0, ideographic: 0, bottom: -0.22 };

/** @param {string} name for its clip paths */
export function svgRecorder(name) {
  const state = /** @type {CanvasRenderingContext2D} */ (h('canvas', { width: 1, height: 1 }).getContext('2d'));
  let path = '';
  let clips = 0;
  /** The clip path in force, and those that `restore` brings back. */
  let clip = '';
  /** @type {string[]} */
  const kept = [];
  /** Shapes of one look one after another are one element. @type {{look: string, path: string, element: string}[]} */
  let drawn = [];

  /** @param {number} x @param {number} y */
  const at = (x, y) => {
    const place = state.getTransform().transformPoint({ x, y });
    return `${short(place.x)} ${short(place.y)}`;
  };
  const look = () => (state.globalAlpha === 1 ? clip : `${clip} opacity="${short(state.globalAlpha)}"`);
  /** @param {string} attributes */
  const shape = (attributes) => {
    if (!path) return;
    const last = drawn.at(-1);
    // Transparent marks add up where they overlap, so they stay apart.
    if (last?.look === attributes && state.globalAlpha === 1) last.path += path;
    else drawn.push({ look: attributes, path, element: '' });
  };
  /** @param {string} element */
  const add = (element) => drawn.push({ look: '', path: '', element });
  /** A shape that is no part of the path under way. @param {'fill' | 'stroke'} act @param {[number, number, number, number]} rectangle */
  const apart = (act, rectangle) => {
    const before = path;
    path = '';
    own.rect(...rectangle);
    own[act]();
    path = before;
  };

  const own = {
    save() {
      kept.push(clip);
      state.save();
    },
    restore() {
      clip = kept.pop() ?? '';
      state.restore();
    },
    beginPath() {
      path = '';
    },
    moveTo: (/** @type {number} */ x, /** @type {number} */ y) => {
      path += `M${at(x, y)}`;
    },
    lineTo: (/** @type {number} */ x, /** @type {number} */ y) => {
      path += `${path ? 'L' : 'M'}${at(x, y)}`;
    },
    closePath: () => {
      if (path) path += 'Z';
    },
    rect: (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ w, /** @type {number} */ height) => {
      path += `M${at(x, y)}L${at(x + w, y)}L${at(x + w, y + height)}L${at(x, y + height)}Z`;
    },
    /** @param {number} x @param {number} y @param {number} radius @param {number} from @param {number} to @param {boolean} [back] */
    arc(x, y, radius, from, to, back = false) {
      const r = short(radius);
      const on = (/** @type {number} */ angle) => at(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
      path += `${path && !path.endsWith('Z') ? 'L' : 'M'}${on(from)}`;
      // A whole circle is two halves: an arc from a point to itself is none.
      if (Math.abs(to - from) >= 2 * Math.PI) {
        path += `A${r} ${r} 0 1 1 ${on(from + Math.PI)}A${r} ${r} 0 1 1 ${on(from)}`;
        return;
      }
      const turn = (((back ? from - to : to - from) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
      path += `A${r} ${r} 0 ${turn > Math.PI ? 1 : 0} ${back ? 0 : 1} ${on(to)}`;
    },
    clip() {
      clips += 1;
      add(`<clipPath id="${name}-${clips}"><path d="${path}"/></clipPath>`);
      clip = ` clip-path="url(#${name}-${clips})"`;
    },
    fill: () => shape(` fill="${state.fillStyle}"${look()}`),
    stroke() {
      const dashes = state.getLineDash();
      const dashed = dashes.length > 0 ? ` stroke-dasharray="${dashes.join(' ')}"` : '';
      const cap = state.lineCap === 'butt' ? '' : ` stroke-linecap="${state.lineCap}"`;
      const width = short(state.lineWidth);
      shape(` fill="none" stroke="${state.strokeStyle}" stroke-width="${width}"${dashed}${cap}${look()}`);
    },
    fillRect: (/** @type {[number, number, number, number]} */ ...rectangle) => apart('fill', rectangle),
    strokeRect: (/** @type {[number, number, number, number]} */ ...rectangle) => apart('stroke', rectangle),
    /** A layer is cleared as a whole. */
    clearRect() {
      drawn = [];
    },
    /** @param {string} words @param {number} x @param {number} y @param {number} [widest] */
    fillText(words, x, y, widest = Infinity) {
      const [, slant, points, family] = /^(italic )?([\d.]+)px (.+)$/.exec(state.font) ?? ['', '', '10', 'sans-serif'];
      const size = Number(points);
      const font = ` font-family="${escaped(family)}" font-size="${size}"${slant ? ' font-style="italic"' : ''}`;
      const fits = state.measureText(words).width <= widest;
      const squeezed = fits ? '' : ` textLength="${short(widest)}" lengthAdjust="spacingAndGlyphs"`;
      const { a, b, c, d, e, f } = state.getTransform();
      const turned =
        b === 0 ? '' : ` transform="matrix(${[a, b, c, d, e, f].map((part) => part.toFixed(4)).join(' ')})"`;
      const [px, py] = b === 0 ? [x + e, y + f] : [x, y];
      add(
        `<text x="${short(px)}" y="${short(py + SHIFTS[state.textBaseline] * size)}" fill="${state.fillStyle}" text-anchor="${ANCHORS[state.textAlign]}"${font}${squeezed}${turned}${look()}>${escaped(words)}</text>`,
      );
    },
    /** @param {HTMLCanvasElement} image @param {number} x @param {number} y @param {number} [width] @param {number} [height] */
    drawImage(image, x, y, width = image.width, height = image.height) {
      const [left, top] = at(x, y).split(' ');
      const sharp = state.imageSmoothingEnabled ? '' : ' image-rendering="pixelated"';
      add(
        `<image x="${left}" y="${top}" width="${short(width)}" height="${short(height)}" href="${image.toDataURL()}"${sharp}${look()}/>`,
      );
    },
    /** The elements of what was drawn. */
    content: () => drawn.map(({ look, path, element }) => element || `<path d="${path}"${look}/>`).join('\n'),
  };
  // Corners are sharp, since their radius does not show at this size.
  const shapes = { ...own, roundRect: own.rect };
  return /** @type {CanvasRenderingContext2D & typeof own} */ (
    new Proxy(state, {
      get: (_, key) => {
        const found = Reflect.get(key in shapes ? shapes : state, key);
        return typeof found === 'function' && !(key in shapes) ? found.bind(state) : found;
      },
      set: (_, key, value) => Reflect.set(state, key, value),
    })
  );
}
