// The eigenvalues of one bounce on the unit circle, as a dial of the tilt gain: the server's picture with each answer.

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
  /** Come with the first answer. @type {{figureOf: typeof import('./readable/server-figure.js').figureOf, inWords: (text: string) => string} | null} */
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

  /** Shows an answer that has its dial. @param {Stability} answer */
  show(answer) {
    this.#answer = answer;
    if (this.#tools) this.#draw();
    else void this.#load();
  }

  #draw() {
    if (!this.#tools) return;
    const { figureOf, inWords } = this.#tools;
    const words = wordsOf(this.#answer, inWords);
    this.figure.read(words);
    this.figure.name(Infinity, () => `Eigenvalues of one bounce on the unit circle. ${words}`);
    this.figure.list(Infinity);
    const dial = this.#answer?.dial;
    if (dial) this.figure.box.replaceChildren(figureOf(dial));
    else this.figure.box.textContent = 'No linear map here';
  }

  /** The code and the styles of the server's pictures, which nothing needs before the first plot. */
  async #load() {
    const modules = await Promise.all([
      import('./readable/server-figure.js'),
      import('../dom/typeset.js'),
      figureStyles(),
    ]).catch(() => null);
    if (!modules) return;
    const [{ figureOf }, { inWords }] = modules;
    this.#tools = { figureOf, inWords };
    this.#draw();
  }
}

async function figureStyles() {
  const { styles } = await import('../dom/styles.js');
  await Promise.all(['charts/generated/figure-colours.css', 'charts/readable/server-figure.css'].map(styles));
}
