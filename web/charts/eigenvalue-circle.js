// The eigenvalues of one bounce on the unit circle: the middle of the picture that the server draws of them, asked for while it is seen.

import { marginOf } from '../api/answers.js';
import { Follower } from '../api/latest-request.js';
import { fixed, number } from '../dom/numbers.js';
import { STUDY_SHEETS, styles } from '../dom/styles.js';
import { inWords } from '../dom/typeset.js';
import { makeFigure } from './figure.js';
import { serverFigure } from './readable/server-figure.js';

/** Height of the part that is shown, as a share of that of the plot. */
const SHOWN = 0.7;

/** The first plot of a picture, without its axes. @param {SVGSVGElement} figure */
function middleOf(figure) {
  const plot = figure.querySelector('rect');
  if (!plot) return;
  const [x, y, width, height] = ['x', 'y', 'width', 'height'].map((name) => Number(plot.getAttribute(name)));
  figure.setAttribute('viewBox', [x + 1, y + ((1 - SHOWN) / 2) * height, width - 2, SHOWN * height].join(' '));
}

/** An answer in a line. @param {Stability} answer */
function wordsOf(answer) {
  const { linear } = answer;
  if (!linear) return inWords(answer.notes[0] ?? '');
  const { residue, rotation, spectral_radius: radius } = linear;
  const gain = marginOf(answer, 'table.tilt_gain');
  if (residue === null || !gain) return `spectral radius ${number(radius)}`;
  const turn = rotation === null ? `max |λ| ${fixed(radius, 3)}` : `σ ${fixed((rotation * 180) / Math.PI, 1)}°`;
  return `κ ${fixed(gain.value, 3)}   R ${fixed(residue, 3)}   ${turn}`;
}

/** @typedef {ReturnType<typeof bringCircle>} Circle */

export function bringCircle() {
  /** @type {Judged | null} */
  let judged = null;
  let seen = false;
  /** The scene whose picture is there. */
  let drawn = '';
  const rows = () => judged?.answer.linear?.eigenvalues ?? [];
  const figure = makeFigure(
    'circle',
    'Eigenvalues',
    'Of one bounce: on the circle a dial of the tilt gain, off it balance is lost.',
    ['eigenvalue', 'real', 'imaginary', 'modulus'],
    () => rows().map(({ re, im, modulus }, index) => [index + 1, ...[re, im, modulus].map((one) => fixed(one, 6))]),
  );
  const pictures = new Follower(async (/** @type {string} */ scene, signal) => {
    if (scene === drawn) return;
    const asked = serverFigure(`v1/stability?${scene}&format=svg`, signal);
    const [picture] = await Promise.all([asked, styles(STUDY_SHEETS[0])]).catch(() => []);
    // The one before stays while the server does not answer.
    if (!picture) return;
    middleOf(picture);
    figure.box.replaceChildren(picture);
    drawn = scene;
  });
  const draw = () => {
    if (!seen || !judged) return;
    if (judged.answer.linear) return pictures.want(String(judged.scene));
    drawn = '';
    figure.box.replaceChildren('No linear map here');
  };
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    draw();
  }).observe(figure.box);
  return {
    figure,
    /** @param {Judged} newest */
    show: (newest) => {
      judged = newest;
      const words = wordsOf(newest.answer);
      figure.read(words);
      figure.name(() => `Eigenvalues of one bounce on the unit circle. ${words}`);
      figure.list();
      draw();
    },
  };
}
