// The eigenvalues of one bounce: a mark for each, on the unit circle with a scale of the tilt gain, along which the pair of the angle moves.

import { marginOf } from '../api/answers.js';
import { fixed, number } from '../dom/numbers.js';
import { inWords } from '../dom/typeset.js';
import { html, render } from '../vendor/preact/preact.js';
import { ticks } from './axes.js';
import { Figure } from './figure.js';

/** Size of the picture and of a length of 1, px. */
const [WIDTH, HEIGHT, ONE] = [320, 226, 80];
/** Largest real part that has its place. */
const EDGE = 1.85;
/** Distance at which two eigenvalues are one mark. */
const NEAR = 1e-6;

const toX = (/** @type {number} */ re) => WIDTH / 2 + ONE * re;
const toY = (/** @type {number} */ im) => HEIGHT / 2 - ONE * im;

/** @param {number} re @param {number} im @param {string} text @param {Record<string, string>} [more] */
const words = (re, im, text, more) =>
  html`<text x=${toX(re)} y=${toY(im) + 4} text-anchor="middle" font-size="12" fill="var(--muted)" ...${more}>${text}</text>`;

/** @param {number[]} from @param {number[]} to @param {string} colour @param {Record<string, string | number>} [more] */
const line = ([a, b], [c, d], colour, more) =>
  html`<line x1=${toX(a)} y1=${toY(b)} x2=${toX(c)} y2=${toY(d)} stroke=${`var(--${colour})`} ...${more} />`;

/** The path of the angle's eigenvalues over the tilt gain. @param {number} lower @param {number} critical @param {boolean} isPair */
function path(lower, critical, isPair) {
  const dashed = { 'stroke-width': 2.5, 'stroke-dasharray': '6 4' };
  const start = isPair ? 0 : 1;
  const parts = [
    line([start, 0], [EDGE, 0], 'series-3', dashed),
    line([-start, 0], [-EDGE, 0], 'strike', dashed),
    words(1.06, -0.2, `κ = ${number(lower)}`, { 'text-anchor': 'start' }),
    words(-1.06, -0.2, `κ = ${number(critical)}`, { 'text-anchor': 'end' }),
  ];
  if (!isPair) return [...parts, line([-1, 0], [1, 0], 'series-0', { 'stroke-width': 2.5 })];
  for (const gain of ticks({ low: lower, high: critical }, 6)) {
    const residue = (gain - lower) / (critical - lower);
    // The ends have words of their own.
    if (residue < 0.06 || residue > 0.94) continue;
    const [re, im] = [1 - 2 * residue, 2 * Math.sqrt(residue * (1 - residue))];
    parts.push(line([0.96 * re, 0.96 * im], [1.04 * re, 1.04 * im], 'muted', { 'stroke-width': 1.5 }));
    parts.push(words(1.17 * re, 1.17 * im, number(gain)));
  }
  return parts;
}

/** The angle by which a small deviation turns at every bounce. @param {number} rotation */
function turn(rotation) {
  const [re, im] = [Math.cos(rotation), Math.sin(rotation)];
  const arc = `M${toX(0.3)} ${toY(0)}A${0.3 * ONE} ${0.3 * ONE} 0 0 0 ${toX(0.3 * re)} ${toY(0.3 * im)}`;
  return [
    line([0, 0], [re, im], 'muted'),
    html`<path d=${arc} fill="none" stroke="var(--muted)" />`,
    words(0.44 * Math.cos(rotation / 2), 0.44 * Math.sin(rotation / 2), 'σ', { 'font-style': 'italic' }),
  ];
}

/** @param {NonNullable<Stability['linear']>} linear */
function marks({ eigenvalues, energy_eigenvalue: energy }) {
  const all = eigenvalues.filter(({ re, im }) => Number.isFinite(re + im));
  const same = (/** @type {{re: number, im: number}} */ a, /** @type {{re: number, im: number}} */ b) =>
    Math.hypot(a.re - b.re, a.im - b.im) < NEAR;
  return all.flatMap((value, index) => {
    const count = all.filter((other) => same(value, other)).length;
    if (all.findIndex((other) => same(value, other)) < index) return [];
    const { re, im } = value;
    if (Math.abs(re) > EDGE)
      return [words(Math.sign(re) * 1.7, 0.16, re > 0 ? `${number(re, 3)} →` : `← ${number(re, 3)}`)];
    // Those of drift and height are rings.
    const ring = [1, energy].some((one) => one !== null && same(value, { re: one, im: 0 }));
    const fill = ring ? 'var(--surface)' : 'var(--ink)';
    return [
      html`<circle cx=${toX(re)} cy=${toY(im)} r="5" fill=${fill} stroke="var(--ink)" stroke-width="1.5" />`,
      count > 1 && words(re + 0.16, im + 0.14, `×${count}`),
    ];
  });
}

/** @param {Stability} answer @param {NonNullable<Stability['linear']>} linear */
function eigenvalueMarks(answer, linear) {
  const gain = marginOf(answer, 'table.tilt_gain');
  const [lower, critical] = [gain?.below?.limit, gain?.above?.limit];
  const isPair = linear.residue !== null;
  const scaled = lower !== undefined && critical !== undefined && critical > lower;
  const rim = `var(--${scaled && isPair ? 'series-0' : 'line'})`;
  return html`<svg class="figure" viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} aria-hidden="true">
    <circle cx=${toX(0)} cy=${toY(0)} r=${ONE} fill="var(--faint)" stroke=${rim} stroke-width="2" />
    ${line([-EDGE, 0], [EDGE, 0], 'line')}
    ${line([0, -1.3], [0, 1.3], 'line')}
    ${words(EDGE, -0.42, 'Re λ', { 'font-style': 'italic', 'text-anchor': 'end' })}
    ${words(0.06, 1.3, 'Im λ', { 'font-style': 'italic', 'text-anchor': 'start' })}
    ${scaled && path(lower, critical, isPair)}
    ${linear.rotation && linear.rotation > 0.05 && turn(linear.rotation)}
    ${marks(linear)}
  </svg>`;
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

export class EigenvalueCircle {
  figure;
  /** @type {Stability | null} */
  #answer = null;

  constructor() {
    const rows = () => this.#answer?.linear?.eigenvalues ?? [];
    this.figure = new Figure(
      'circle',
      'Eigenvalues',
      'Of one bounce: on the circle a dial of the tilt gain, off it balance is lost.',
      ['eigenvalue', 'real', 'imaginary', 'modulus'],
      () => rows().map(({ re, im, modulus }, index) => [index + 1, ...[re, im, modulus].map((one) => fixed(one, 6))]),
    );
  }

  /** @param {Stability} answer */
  show(answer) {
    this.#answer = answer;
    const words = wordsOf(answer);
    this.figure.read(words);
    this.figure.name(() => `Eigenvalues of one bounce on the unit circle. ${words}`);
    this.figure.list();
    render(answer.linear ? eigenvalueMarks(answer, answer.linear) : 'No linear map here', this.figure.box);
  }
}
