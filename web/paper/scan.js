// A place for the reader's own scan of a figure, beside the computed picture or over it. The scan stays in the browser.

import { h } from '../dom/elements.js';

/** Largest file that is read. */
const LIMIT_BYTES = 30e6;
/** Steps of the arrow keys, in parts of the picture's width. */
const STEP = 0.005;

export class ScanPlace {
  element;
  /** The scan over the computed picture. */
  layer = h('div', { class: 'scan-layer', hidden: true });
  #canvas = h('canvas', { class: 'scan', tabindex: 0, role: 'img' });
  #told = h('p', { class: 'muted', role: 'status' });
  #beside = h('div', { class: 'scan-beside', hidden: true });
  #controls;
  #over = false;
  /** Place and size of the scan over the picture, in parts of the picture's width. */
  #x = 0;
  #y = 0;
  #size = 1;
  /** Last place of the pointer in a drag; null between drags. @type {{x: number, y: number} | null} */
  #held = null;

  /**
   * @param {string} place of the figure in the paper
   * @param {boolean} picture there is a computed one, over which the scan can lie
   */
  constructor(place, picture) {
    const file = h('input', {
      type: 'file',
      accept: 'image/*',
      'aria-label': `Your scan of ${place}`,
      change: () => file.files?.[0] && void this.#take(file.files[0]),
    });
    const slider = (
      /** @type {string} */ name,
      /** @type {[number, number, number]} */ [min, max, value],
      /** @type {(value: number) => void} */ set,
    ) => {
      const input = h('input', {
        type: 'range',
        min,
        max,
        step: 0.01,
        value,
        input: () => {
          set(Number(input.value));
          this.#lay();
        },
      });
      return h('label', { class: 'scan-control' }, name, input);
    };
    const over = h('input', {
      type: 'checkbox',
      change: () => {
        this.#over = over.checked;
        this.#lay();
      },
    });
    this.#controls = h(
      'div',
      { class: 'scan-controls', hidden: true },
      picture ? h('label', { class: 'check' }, over, 'Over the computed picture') : null,
      picture
        ? slider('Opacity', [0.05, 1, 0.5], (value) => this.#canvas.style.setProperty('opacity', String(value)))
        : null,
      picture ? slider('Size', [0.2, 2, 1], (value) => (this.#size = value)) : null,
      h('button', { type: 'button', click: () => this.#remove(file) }, 'Remove the scan'),
    );
    this.#canvas.setAttribute('aria-label', `Your scan of ${place}; arrow keys move it over the picture`);
    this.element = h(
      'div',
      {
        class: 'scan-place',
        dragover: (/** @type {DragEvent} */ event) => event.preventDefault(),
        drop: (/** @type {DragEvent} */ event) => {
          event.preventDefault();
          event.stopPropagation();
          const dropped = event.dataTransfer?.files[0];
          if (dropped) void this.#take(dropped);
        },
      },
      h('p', {}, `Drop your scan of ${place} here, or choose a file. It stays in this browser.`),
      file,
      this.#told,
      this.#controls,
      this.#beside,
    );
    this.#listen();
  }

  #listen() {
    const canvas = this.#canvas;
    canvas.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!step || !this.#over) return;
      event.preventDefault();
      event.stopPropagation();
      this.#x += step[0] * STEP * (event.shiftKey ? 10 : 1);
      this.#y += step[1] * STEP * (event.shiftKey ? 10 : 1);
      this.#lay();
    });
    canvas.addEventListener('pointerdown', ({ clientX, clientY, pointerId }) => {
      if (!this.#over) return;
      canvas.setPointerCapture(pointerId);
      this.#held = { x: clientX, y: clientY };
    });
    canvas.addEventListener('pointermove', ({ clientX, clientY }) => {
      if (!this.#held) return;
      const width = this.layer.clientWidth || 1;
      this.#x += (clientX - this.#held.x) / width;
      this.#y += (clientY - this.#held.y) / width;
      this.#held = { x: clientX, y: clientY };
      this.#lay();
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => (this.#held = null));
  }

  /** @param {File} file */
  async #take(file) {
    if (file.size > LIMIT_BYTES) {
      this.#told.textContent = `${file.name} has ${(file.size / 1e6).toFixed(0)} MB; at most ${LIMIT_BYTES / 1e6} MB are read.`;
      return;
    }
    try {
      const image = await createImageBitmap(file);
      Object.assign(this.#canvas, { width: image.width, height: image.height });
      this.#canvas.getContext('2d')?.drawImage(image, 0, 0);
      image.close();
    } catch {
      this.#told.textContent = `${file.name} is not a picture that this browser reads. Save a page of the paper as PNG or JPEG.`;
      return;
    }
    this.#told.textContent = `${file.name} is shown.`;
    this.#controls.hidden = false;
    this.#lay();
  }

  /** @param {HTMLInputElement} file */
  #remove(file) {
    file.value = '';
    this.#told.textContent = 'The scan is removed.';
    this.#controls.hidden = true;
    this.layer.hidden = true;
    this.#beside.hidden = true;
    Object.assign(this.#canvas, { width: 0, height: 0 });
  }

  /** Puts the scan beside the picture or over it. */
  #lay() {
    const { style } = this.#canvas;
    this.layer.hidden = !this.#over;
    this.#beside.hidden = this.#over;
    const home = this.#over ? this.layer : this.#beside;
    if (this.#canvas.parentElement !== home) home.append(this.#canvas);
    style.setProperty('width', this.#over ? `${100 * this.#size}%` : '100%');
    style.setProperty('left', this.#over ? `${100 * this.#x}%` : '0');
    style.setProperty('top', this.#over ? `${this.#y * this.layer.clientWidth}px` : '0');
  }
}
