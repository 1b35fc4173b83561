// A place for the reader's own scan of a figure, beside the computed picture or over it. The scan stays in the browser.

import { html, useLayoutEffect, useRef, useState } from '../vendor/preact/preact.js';

/** Largest file that is read. */
const LIMIT_BYTES = 30e6;
/** Steps of the arrow keys, in parts of the picture's width. */
const STEP = 0.005;

/** Place and size of the scan over the picture, in parts of the picture's width. */
const LAID = { over: false, opacity: 0.5, x: 0, y: 0, size: 1 };
const SLIDERS = /** @type {const} */ ([
  ['opacity', 'Opacity', 0.05, 1],
  ['size', 'Size', 0.2, 2],
]);

/**
 * @param {string} place of the figure in the paper
 * @param {boolean} picture there is a computed one, over which the scan can lie
 * @returns {{layer: unknown, element: unknown}} the scan over the picture, and its place with the controls
 */
export function useScan(place, picture) {
  const [image, show] = useState(/** @type {ImageBitmap | null} */ (null));
  const [told, tell] = useState('');
  const [laid, lay] = useState(LAID);
  const file = useRef(/** @type {HTMLInputElement | null} */ (null));
  const take = async (/** @type {File | undefined} */ given) => {
    if (!given) return;
    const { name, size } = given;
    if (size > LIMIT_BYTES)
      return tell(`${name} has ${(size / 1e6).toFixed(0)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`);
    try {
      show(await createImageBitmap(given));
      tell(`${name} is shown.`);
    } catch {
      tell(`${name} is not a picture that this browser reads. Save a page of the paper as PNG or JPEG.`);
    }
  };
  const remove = () => {
    if (file.current) file.current.value = '';
    show(null);
    tell('The scan is removed.');
  };
  const drop = (/** @type {DragEvent} */ event) => {
    event.preventDefault();
    event.stopPropagation();
    void take(event.dataTransfer?.files[0]);
  };
  const set = (/** @type {Partial<typeof LAID>} */ part) => lay((before) => ({ ...before, ...part }));
  const move = (/** @type {number} */ dx, /** @type {number} */ dy) =>
    lay((before) => ({ ...before, x: before.x + dx, y: before.y + dy }));
  const scan = image && html`<${Scan} image=${image} place=${place} laid=${laid} move=${move} />`;
  return {
    layer: laid.over && scan && html`<div class="scan-layer">${scan}</div>`,
    element: html`<div class="scan-place" onDragOver=${(/** @type {Event} */ event) => event.preventDefault()} onDrop=${drop}>
      <p>Drop your scan of ${place} here, or choose a file. It stays in this browser.</p>
      <input
        type="file"
        accept="image/*"
        aria-label=${`Your scan of ${place}`}
        ref=${file}
        onChange=${() => void take(file.current?.files?.[0])}
      />
      <p class="muted" role="status">${told}</p>
      ${
        image &&
        html`<div class="scan-controls">
        ${
          picture &&
          html`<label class="check">
          <input type="checkbox" checked=${laid.over} onChange=${() => set({ over: !laid.over })} />
          Over the computed picture
        </label>`
        }
        ${
          picture &&
          SLIDERS.map(
            ([name, words, min, max]) => html`<label class="scan-control">${words}
          <input type="range" min=${min} max=${max} step="0.01" value=${laid[name]} onInput=${(/** @type {{currentTarget: HTMLInputElement}} */ { currentTarget }) => set({ [name]: Number(currentTarget.value) })} />
        </label>`,
          )
        }
        <button type="button" onClick=${remove}>Remove the scan</button>
      </div>`
      }
      ${!laid.over && scan && html`<div class="scan-beside">${scan}</div>`}
    </div>`,
  };
}

/** The scan itself; over the picture the pointer and the arrow keys move it. @param {{image: ImageBitmap, place: string, laid: typeof LAID, move: (dx: number, dy: number) => void}} props */
function Scan({ image, place, laid: { over, opacity, x, y, size }, move }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const held = useRef(/** @type {PointerEvent | null} */ (null));
  useLayoutEffect(() => canvas.current?.getContext('2d')?.drawImage(image, 0, 0), [image]);
  const key = (/** @type {KeyboardEvent} */ event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step || !over) return;
    event.preventDefault();
    event.stopPropagation();
    const far = STEP * (event.shiftKey ? 10 : 1);
    move(step[0] * far, step[1] * far);
  };
  const press = (/** @type {PointerEvent} */ event) => {
    if (!over) return;
    canvas.current?.setPointerCapture(event.pointerId);
    held.current = event;
  };
  const drag = (/** @type {PointerEvent} */ event) => {
    if (!held.current) return;
    const width = canvas.current?.parentElement?.clientWidth || 1;
    move((event.clientX - held.current.clientX) / width, (event.clientY - held.current.clientY) / width);
    held.current = event;
  };
  const release = () => {
    held.current = null;
  };
  // A margin in per cent is one of the width, above as well.
  const style = over
    ? { width: `${100 * size}%`, left: `${100 * x}%`, marginTop: `${100 * y}%`, opacity }
    : { width: '100%' };
  return html`<canvas
    class="scan"
    tabindex="0"
    role="img"
    aria-label=${`Your scan of ${place}; arrow keys move it over the picture`}
    width=${image.width}
    height=${image.height}
    style=${style}
    ref=${canvas}
    onKeyDown=${key}
    onPointerDown=${press}
    onPointerMove=${drag}
    onPointerUp=${release}
    onPointerCancel=${release}
  />`;
}
