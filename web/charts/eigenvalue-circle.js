// The eigenvalues of one bounce on the unit circle, as a dial of the tilt gain.

import { Figure } from './figure.js';
import { onThemeChange } from './theme.js';
import { fixed } from '../dom/numbers.js';
import { invalidate, surfaces } from './surface.js';

/** @typedef {import('contract').Stability} Stability */

export class EigenvalueCircle {
  figure;
  #surface;
  /** @type {Stability | null} */
  #answer = null;
  /** The gain that is being set, before the server has answered for it. @type {number | null} */
  #gain = null;
  /** Comes with the first answer. @type {typeof import('./eigenvalue-drawing.js').drawEigenvalues | null} */
  #drawing = null;

  constructor() {
    this.figure = new Figure(
      'circle',
      'Eigenvalues',
      'Of one bounce: on the circle a dial of the tilt gain, off it balance is lost.',
      {
        head: ['eigenvalue', 'real', 'imaginary', 'modulus'],
        rows: () =>
          (this.#answer?.linear?.eigenvalues ?? []).map(({ re, im, modulus }, index) => [
            String(index + 1),
            fixed(re, 6),
            fixed(im, 6),
            fixed(modulus, 6),
          ]),
      },
    );
    this.layers = surfaces(this.figure.box, 1, () => this.redraw());
    [this.#surface] = this.layers;
    onThemeChange(() => this.redraw());
  }

  redraw() {
    invalidate(this);
  }

  /** @param {Stability | null} answer */
  show(answer) {
    this.#answer = answer;
    this.#gain = answer?.linear?.tilt_gain?.value ?? null;
    invalidate(this);
  }

  /** @param {number} gain */
  preview(gain) {
    this.#gain = gain;
    invalidate(this);
  }

  /** @param {number} now_ms */
  draw(now_ms) {
    if (!this.#drawing) {
      if (this.#answer) void this.#load();
      return false;
    }
    const words = this.#drawing(this.#surface, this.#answer, this.#gain);
    this.figure.read(words);
    this.figure.name(now_ms, () => `Eigenvalues of one bounce on the unit circle. ${words}`);
    this.figure.list(now_ms);
    return false;
  }

  async #load() {
    const module = await import('./eigenvalue-drawing.js').catch(() => null);
    if (module) this.#drawing = module.drawEigenvalues;
    if (module) this.redraw();
  }
}
