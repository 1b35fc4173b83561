// Pictures of the page's canvases for files: as pixels, or drawn once more as SVG.

import { escaped } from '../charts/svg.js';
import { colourOf } from '../charts/theme.js';
import { h } from '../dom/elements.js';
import { svgRecorder } from './svg-recorder.js';

/** @param {CanvasView} view @param {string} title */
function svgOf(view, title) {
  const { layers } = view;
  const kept = layers.map(({ context }) => context);
  const recorders = layers.map((_, index) => svgRecorder(`layer-${index}`));
  layers.forEach((layer, index) => {
    layer.context = recorders[index];
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
  const parts = [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`,
    `<title>${escaped(title)}</title>`,
    `<rect width="100%" height="100%" fill="${colourOf('surface')}"/>`,
    ...recorders.map((recorder) => recorder.content()),
    '</svg>\n',
  ];
  return new Blob([parts.join('\n')], { type: 'image/svg+xml' });
}

/** @param {CanvasView} view @returns {Promise<Blob>} */
function pngOf({ layers }) {
  const { width, height } = layers[0].canvas;
  const sheet = h('canvas', { width, height });
  const context = /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d'));
  context.fillStyle = colourOf('surface');
  context.fillRect(0, 0, width, height);
  for (const { canvas } of layers) context.drawImage(canvas, 0, 0);
  return new Promise((resolve, reject) =>
    sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png'),
  );
}

/** Saves what a view shows. @param {CanvasView} view @param {string} title @param {string} name of the file, whose end is its format */
export const savePicture = async (view, title, name) =>
  download(name.endsWith('.svg') ? svgOf(view, title) : await pngOf(view), name);

/** @param {unknown} content @param {string} name */
export const downloadJson = (content, name) =>
  download(new Blob([`${JSON.stringify(content, null, 2)}\n`], { type: 'application/json' }), name);

/** @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  h('a', { href: url, download: name }).click();
  // The browser has taken it by then.
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
