// The eigenvalues of one bounce on the unit circle, as a dial of the tilt gain.

import { marginOf } from '../api/margins.js';
import { Figure } from './figure.js';
import { fixed, number } from '../dom/numbers.js';

/** @typedef {import('contract').Stability} Stability */

/** An answer in a line. @param {Stability | null} answer @param {(text: string) => string} inWords for sentences of the server */
function wordsOf(answer, inWords) {
  const { linear } = answer ?? {};
  if (!linear) return inWords(answer?.notes[0] ?? '');
  const { residue, rotation, spectral_radius: radius } = linear;
  const gain = answer && marginOf(answer, 'table.tilt_gain');
  if (residue === null || !gain) return `spectral radius ${number(radius)}`;
  const turn = rotation === null ? `max |λ| ${fixed(radius, 3)}` : `σ ${fixed((rotation * 180) / Math.PI, 1)}°`;
  return `κ ${fixed(gain.value, 3)}   R ${fixed(residue, 3)}   ${turn}`;
}

export class EigenvalueCircle {
  figure;
  /** @type {Stability | null} */
  #answer = null;
  /** Come with the first answer. @type {{eigenvalueMarks: typeof import('./eigenvalue-marks.js').eigenvalueMarks, inWords: (text: string) => string} | null} */
  #tools = null;

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
  }

  /** @param {Stability} answer */
  show(answer) {
    this.#answer = answer;
    if (this.#tools) this.#draw();
    else void this.#load();
  }

  #draw() {
    if (!this.#tools) return;
    const { eigenvalueMarks, inWords } = this.#tools;
    const words = wordsOf(this.#answer, inWords);
    this.figure.read(words);
    this.figure.name(Infinity, () => `Eigenvalues of one bounce on the unit circle. ${words}`);
    this.figure.list(Infinity);
    const linear = this.#answer?.linear;
    if (this.#answer && linear) this.figure.box.replaceChildren(eigenvalueMarks(this.#answer, linear));
    else this.figure.box.textContent = 'No linear map here';
  }

  /** Code that nothing needs before the first answer, and the style of figures. */
  async #load() {
    const modules = await Promise.all([
      import('./eigenvalue-marks.js'),
      import('../dom/typeset.js'),
      import('../dom/styles.js').then(({ styles }) => styles('charts/readable/server-figure.css')),
    ]).catch(() => null);
    if (!modules) return;
    const [{ eigenvalueMarks }, { inWords }] = modules;
    this.#tools = { eigenvalueMarks, inWords };
    this.#draw();
  }
}
