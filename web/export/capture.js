// Pictures of the page's canvases for files: as pixels, or drawn once more as SVG.

import { Recorder } from './svg-recorder.js';
import { h } from '../dom/elements.js';
import { theme } from '../charts/theme.js';

/** @typedef {import('../charts/surface.js').View & {layers: import('../charts/surface.js').Surface[], redraw: () => void}} Layered */

/** @param {Layered} view @param {string} title */
export function svgOf(view, title) {
  const { layers } = view;
  const kept = layers.map(({ context }) => context);
  const recorders = kept.map((context) => new Recorder(context));
  layers.forEach((layer, index) => {
    layer.context = /** @type {any} */ (recorders[index]);
  });
  try {
    view.redraw();
    view.draw(performance.now());
  } finally {
    layers.forEach((layer, index) => {
      layer.context = kept[index];
    });
    view.redraw();
  }
  const [width, height] = [layers[0].width, layers[0].height].map((length) => Math.round(length * 100) / 100);
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">\n<title>${title.replaceAll('&', '&amp;').replaceAll('<', '&lt;')}</title>\n<rect width="100%" height="100%" fill="${theme().surface}"/>\n${recorders.map((recorder, index) => recorder.content(`layer-${index}`)).join('\n')}\n</svg>\n`;
  return new Blob([svg], { type: 'image/svg+xml' });
}

/** @param {Layered} view @returns {Promise<Blob>} */
export function pngOf({ layers }) {
  const [
    {
      canvas: { width, height },
    },
  ] = layers;
  const sheet = h('canvas', { width, height });
  const context = /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d'));
  context.fillStyle = theme().surface;
  context.fillRect(0, 0, width, height);
  for (const { canvas } of layers) context.drawImage(canvas, 0, 0);
  return new Promise((resolve, reject) =>
    sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png'),
  );
}

/** @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  h('a', { href: url, download: name }).click();
  // The browser has taken it by then.
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
