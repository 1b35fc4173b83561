// Draws the eigenvalues of one bounce on the unit circle, and says them in words.

import { MARGIN, drawAxes, line, ticks, toX, toY } from './axes.js';
import { SANS, SERIF, theme } from './theme.js';
import { fixed, number } from '../dom/numbers.js';
import { inWords } from '../dom/typeset.js';

/** @typedef {import('contract').Stability} Stability */
/** @typedef {{lower: number, critical: number, at: (gain: number) => number}} Residue of every gain */
/** @typedef {import('./surface.js').Surface} Surface */

/**
 * The pair of eigenvalues of the angle block at residue R: λ² − (2 − 4R)λ + 1 = 0.
 * @param {number} residue
 * @returns {{re: number, im: number}[]}
 */
function anglePair(residue) {
  const middle = 1 - 2 * residue;
  const square = residue * (residue - 1);
  const root = 2 * Math.sqrt(Math.abs(square));
  return square <= 0
    ? [
        { re: middle, im: root },
        { re: middle, im: -root },
      ]
    : [
        { re: middle + root, im: 0 },
        { re: middle - root, im: 0 },
      ];
}

const WIDEST = 6;

/** The residue as a function of the gain, where the closed form holds. @param {Stability | null} answer @returns {Residue | null} */
function residueOf(answer) {
  const gain = answer?.linear?.tilt_gain;
  if (answer?.linear?.residue == null || gain?.critical == null || gain.lower == null || gain.critical === gain.lower)
    return null;
  const { lower, critical } = gain;
  return { lower, critical, at: (/** @type {number} */ value) => (value - lower) / (critical - lower) };
}

/**
 * @param {Surface} surface
 * @param {Stability | null} answer
 * @param {number | null} gain that is set, before the server has answered for it
 * @returns {string} the words
 */
export function drawEigenvalues(surface, answer, gain) {
  const { context, width, height } = surface;
  const colours = theme();
  const linear = answer?.linear ?? null;
  const residue = residueOf(answer);
  const pair = residue && gain !== null ? anglePair(residue.at(gain)) : [];
  const largest = Math.max(
    1,
    ...pair.map(({ re }) => Math.abs(re)),
    ...(linear?.eigenvalues ?? []).map(({ modulus }) => modulus),
  );
  const half = Math.min(WIDEST, Math.max(1.55, largest * 1.2));
  const { left, top } = MARGIN;
  const room = { width: Math.max(1, width - left - MARGIN.right), height: Math.max(1, height - top - MARGIN.bottom) };
  const unit = Math.min(room.width, room.height) / (2 * half);
  const frame = {
    left,
    top,
    ...room,
    x: { low: -room.width / unit / 2, high: room.width / unit / 2 },
    y: { low: -room.height / unit / 2, high: room.height / unit / 2 },
  };
  context.clearRect(0, 0, width, height);
  drawAxes(context, frame, 'Re λ', 'Im λ');
  context.save();
  context.beginPath();
  context.rect(frame.left, frame.top, frame.width, frame.height);
  context.clip();
  drawTrail(context, frame, unit, residue, half);
  for (const { re, im } of linear?.eigenvalues ?? []) cross(context, toX(frame, re), toY(frame, im));
  const stable = residue !== null && gain !== null && residue.at(gain) > 0 && residue.at(gain) < 1;
  for (const { re, im } of pair) {
    const x = Math.min(frame.left + frame.width - 7, Math.max(frame.left + 7, toX(frame, re)));
    context.beginPath();
    if (stable) context.arc(x, toY(frame, im), 6, 0, 2 * Math.PI);
    else context.rect(x - 6, toY(frame, im) - 6, 12, 12);
    context.lineWidth = 2.5;
    context.strokeStyle = stable ? colours.accent : colours.strike;
    context.stroke();
  }
  context.restore();
  if (!linear) {
    context.font = `12px ${SANS}`;
    context.fillStyle = colours.muted;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(
      answer ? 'No linear map here' : 'Waiting for the server',
      frame.left + frame.width / 2,
      frame.top + frame.height / 2 - 14,
    );
  }
  return wordsOf(answer, gain, residue);
}

/** @param {Stability | null} answer @param {number | null} gain @param {Residue | null} residue */
function wordsOf(answer, gain, residue) {
  const { linear } = answer ?? {};
  if (!linear) return inWords(answer?.notes[0] ?? '');
  if (!residue || gain === null) return `spectral radius ${number(linear.spectral_radius)}`;
  const at = residue.at(gain);
  const turn =
    at > 0 && at < 1
      ? `   σ ${fixed((Math.acos(1 - 2 * at) * 180) / Math.PI, 1)}°`
      : `   max |λ| ${fixed(Math.max(...anglePair(at).map(({ re }) => Math.abs(re))), 3)}`;
  return `κ ${fixed(gain, 3)}   R ${fixed(at, 3)}${turn}`;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {import('./axes.js').Frame} frame
 * @param {number} unit px
 * @param {Residue | null} residue
 * @param {number} half
 */
function drawTrail(context, frame, unit, residue, half) {
  const colours = theme();
  const cx = toX(frame, 0);
  const cy = toY(frame, 0);
  context.beginPath();
  context.arc(cx, cy, unit, 0, 2 * Math.PI);
  context.lineWidth = residue ? 2.5 : 1.25;
  context.strokeStyle = residue ? colours.accent : colours.muted;
  context.globalAlpha = 0.55;
  context.stroke();
  context.globalAlpha = 1;
  if (!residue) return;
  // Beyond 1 and κ_c the pair leaves along the real axis.
  context.lineWidth = 2;
  context.globalAlpha = 0.6;
  context.setLineDash([5, 4]);
  line(context, colours.strike, cx - half * 2 * unit, cy, cx - unit, cy);
  line(context, colours.strike, cx + unit, cy, cx + half * 2 * unit, cy);
  context.setLineDash([]);
  context.globalAlpha = 1;
  if (unit < 34) return;
  const { lower, critical } = residue;
  context.font = `11px ${SANS}`;
  context.fillStyle = colours.muted;
  context.textBaseline = 'middle';
  context.textAlign = 'center';
  for (const gain of ticks({ low: lower, high: critical }, 5)) {
    if (gain - lower < (critical - lower) * 0.06 || critical - gain < (critical - lower) * 0.06) continue;
    const angle = Math.acos(1 - 2 * residue.at(gain));
    const [dx, dy] = [Math.cos(angle), -Math.sin(angle)];
    context.lineWidth = 1.5;
    line(
      context,
      colours.muted,
      cx + dx * (unit - 4),
      cy + dy * (unit - 4),
      cx + dx * (unit + 4),
      cy + dy * (unit + 4),
    );
    context.fillText(number(gain), cx + dx * (unit + 17), cy + dy * (unit + 13));
  }
  if (unit < 62) return;
  context.font = `italic 13px ${SERIF}`;
  context.fillStyle = colours.ink;
  // The ends of the dial are named inside the circle, where there is always room for them.
  context.textBaseline = 'bottom';
  context.textAlign = 'right';
  context.fillText(`κ = ${number(lower)}`, cx + unit - 9, cy - 4);
  context.textAlign = 'left';
  const from = cx - unit + 9;
  context.fillText('κ', from, cy - 4);
  const base = context.measureText('κ').width;
  context.fillText(` = ${number(critical)}`, from + base + 4, cy - 4);
  context.font = `italic 9px ${SERIF}`;
  context.fillText('c', from + base, cy - 1);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x
 * @param {number} y
 */
function cross(context, x, y) {
  context.lineWidth = 1.75;
  line(context, theme().ink, x - 4, y - 4, x + 4, y + 4);
  line(context, theme().ink, x - 4, y + 4, x + 4, y - 4);
}
