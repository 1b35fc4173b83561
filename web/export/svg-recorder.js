// A canvas context that writes SVG: drawings are recorded with all their digits, while a context of a scratch canvas keeps styles and
// transformations. It knows the shapes that this page draws; words stand upright.

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

  /** @satisfies {Partial<CanvasRenderingContext2D> & {content: () => string}} */
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
    moveTo(x, y) {
      path += `M${at(x, y)}`;
    },
    lineTo(x, y) {
      path += `${path ? 'L' : 'M'}${at(x, y)}`;
    },
    closePath() {
      if (path) path += 'Z';
    },
    rect(x, y, width, height) {
      path += `M${at(x, y)}L${at(x + width, y)}L${at(x + width, y + height)}L${at(x, y + height)}Z`;
    },
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
    /** A layer is cleared as a whole. */
    clearRect() {
      drawn = [];
    },
    fillText(words, x, y, widest = Infinity) {
      const [, slant, points, family] = /^(italic )?([\d.]+)px (.+)$/.exec(state.font) ?? ['', '', '10', 'sans-serif'];
      const size = Number(points);
      const font = ` font-family="${escaped(family)}" font-size="${size}"${slant ? ' font-style="italic"' : ''}`;
      const fits = state.measureText(words).width <= widest;
      const squeezed = fits ? '' : ` textLength="${short(widest)}" lengthAdjust="spacingAndGlyphs"`;
      add(
        `<text x="${short(x)}" y="${short(y + SHIFTS[state.textBaseline] * size)}" fill="${state.fillStyle}" text-anchor="${ANCHORS[state.textAlign]}"${font}${squeezed}${look()}>${escaped(words)}</text>`,
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
