// The symbols of the paper's Fig. 1, each drawn where it belongs: l, ρ, θ, α, β and n.

import { line, text } from '../charts/axes.js';
import { theme } from '../charts/theme.js';
import { byId, h } from '../dom/elements.js';
import { fixedQuantity } from '../dom/numbers.js';
import { derivedOf } from '../physics/body.js';
import { remember, remembered } from '../api/remembered.js';

/** @typedef {CanvasRenderingContext2D} Context */

/** The symbols in the order of the picture, with what they mean. @type {[string, string][]} */
const MEANINGS = [
  ['l', 'from the centre of gravity to the contact point'],
  ['ρ', 'radius of gyration: half masses at the two marks on the rod would turn like it'],
  ['θ', 'angle of the rod from upright, positive to the left'],
  ['α', 'tilt of the table from level, positive to the left'],
  ['β', 'angle from the table’s normal to the rod, θ − α'],
  ['n', 'normal of the table, along which it strikes'],
  ['P', 'impulse of a strike, along n without friction'],
];

const STORED = 'equipoise.symbols';
/** The spoken values follow the picture at most so often, ms. */
const SPOKEN_MS = 1000;
/** Distance of dimension lines from the rod, px. */
const ASIDE = 36;
/** An arc of fewer pixels is not seen. */
const LEAST_PX = 1;

/** The symbols and their values now, in words. @param {import('./bodies.js').Drawn} drawn */
function spokenSymbols({ scene, pose, table }) {
  const { contact_distance: l, radius_of_gyration: rho } = derivedOf(scene);
  const alpha = `α ${fixedQuantity(table.alpha, 'rad', 3)}`;
  if (l === 0) return alpha;
  const lengths = [`l ${fixedQuantity(l, 'm', 4)}`, rho === null ? '' : `ρ ${fixedQuantity(rho, 'm', 4)}`];
  const angles = [
    `θ ${fixedQuantity(pose.theta, 'rad', 3)}`,
    alpha,
    `β ${fixedQuantity(pose.theta - table.alpha, 'rad', 3)}`,
  ];
  return [...lengths, ...angles].filter(Boolean).join(', ');
}

/** @typedef {{x: number, y: number}} Place px */

/** @param {Context} context @param {import('./bodies.js').Drawn} drawn */
function drawSymbols(context, { scene, pose, table, scale, half, struck }) {
  const { muted } = theme();
  const { contact_distance, radius_of_gyration: rho } = derivedOf(scene);
  context.save();
  context.lineWidth = 1;
  const centre = { x: scale.x(pose.x), y: scale.y(pose.y) };
  const middle = { x: scale.x(table.x), y: scale.y(table.y) };
  const l = contact_distance * scale.metre;
  /** @param {Place} from @param {Place} to @param {number[]} dashes */
  const dashed = (from, to, dashes) => line(context, muted, from.x, from.y, to.x, to.y, dashes);
  // The tilt lies between the level and the face of the table, on the side where the table is the higher one.
  const level = table.alpha >= 0 ? -Math.PI / 2 : Math.PI / 2;
  const width = Math.max(24, half * scale.metre);
  dashed(middle, at(middle, level, width + 22), [2, 3]);
  angle(context, 'α', middle, level, level + table.alpha, width);
  // A strike has its own normal.
  if (!struck) {
    const tip = at(middle, table.alpha, Math.max(60, 2.1 * l));
    dashed(middle, tip, [4, 4]);
    label(context, 'n', tip.x + (table.alpha > 0 ? -9 : 9), tip.y);
  }
  if (l > 0) {
    const foot = at(centre, pose.theta, -l);
    const rhoPx = (rho ?? 0) * scale.metre;
    dashed(centre, at(centre, 0, Math.max(1.5 * l, rhoPx + 40)), [2, 3]);
    // Along the normal from the contact point, while that is not on the table.
    dashed(foot, at(foot, table.alpha, 0.55 * l), [2, 3]);
    // Within the picture.
    angle(context, 'θ', centre, 0, pose.theta, Math.max(20, Math.min(Math.max(l, rhoPx) + 14, centre.y - 22)));
    angle(context, 'β', foot, table.alpha, pose.theta, 0.5 * l);
    const side = pose.theta > 0 ? 1 : -1;
    dimension(context, 'l', centre, pose.theta, -l, side);
    if (rho !== null) dimension(context, 'ρ', centre, pose.theta, rhoPx, side);
  }
  context.restore();
}

/** The place at a distance along a direction that is turned from upright. @param {Place} from @param {number} turned rad @param {number} px */
const at = (from, turned, px) => ({ x: from.x - px * Math.sin(turned), y: from.y - px * Math.cos(turned) });

/**
 * An arc between two directions from upright, and its name.
 * @param {Context} context
 * @param {string} name
 * @param {Place} about
 * @param {number} from rad
 * @param {number} to rad
 * @param {number} radius px
 */
function angle(context, name, about, from, to, radius) {
  if (Math.abs(to - from) * radius > LEAST_PX) {
    context.strokeStyle = theme().ink;
    context.beginPath();
    context.arc(about.x, about.y, radius, -Math.PI / 2 - from, -Math.PI / 2 - to, to > from);
    context.stroke();
  }
  const place = at(about, (from + to) / 2, radius + 11);
  label(context, name, place.x, place.y);
}

/**
 * A length along the rod from its centre, beside it, with its name.
 * @param {Context} context
 * @param {string} name
 * @param {Place} centre
 * @param {number} theta
 * @param {number} length px along the rod
 * @param {1 | -1} side
 */
function dimension(context, name, centre, theta, length, side) {
  const { ink } = theme();
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  const beside = { x: centre.x + side * ASIDE * cos, y: centre.y - side * ASIDE * sin };
  const [other, middle] = [length, length / 2].map((px) => at(beside, theta, px));
  line(context, ink, beside.x, beside.y, other.x, other.y);
  for (const { x, y } of [beside, other]) line(context, ink, x - 4 * cos, y + 4 * sin, x + 4 * cos, y - 4 * sin);
  label(context, name, middle.x + side * 11 * cos, middle.y - side * 11 * sin);
}

/** A name on a ground that hides the lines behind it. @param {Context} context @param {string} name @param {number} x @param {number} y its middle */
function label(context, name, x, y) {
  const { ink, surface } = theme();
  context.globalAlpha = 0.75;
  context.fillStyle = surface;
  context.fillRect(x - 6, y - 8, 12, 16);
  context.globalAlpha = 1;
  text(context, name, x, y, { colour: ink, size: 15, italic: true, align: 'center', baseline: 'middle' });
}

/** Offers the symbols at their button, and explains the picture. @param {import('./scene-view.js').SceneView} view */
export function bringSymbols(view) {
  const words = h('p', { id: 'symbols-words', class: 'unseen' });
  const button = byId('symbols');
  const isOn = () => button.getAttribute('aria-pressed') === 'true';
  let spoken_ms = -Infinity;
  const show = (/** @type {boolean} */ on) => {
    button.setAttribute('aria-pressed', String(on));
    remember(STORED, on);
    words.textContent = '';
    spoken_ms = -Infinity;
    view.measure(on);
  };
  button.addEventListener('click', () => show(!isOn()));
  view.followers.push((drawn) => {
    if (!isOn()) return;
    drawSymbols(view.layers[0].context, drawn);
    const now_ms = performance.now();
    if (now_ms - spoken_ms < SPOKEN_MS) return;
    spoken_ms = now_ms;
    words.textContent = `Drawn in the scene: ${spokenSymbols(drawn)}.`;
  });
  byId('scene-frame').append(words);
  byId('panel-why').append(aboutPicture());
  show(remembered(STORED, false));
}

const aboutPicture = () =>
  h(
    'details',
    { id: 'about-picture', class: 'about-picture' },
    h('summary', {}, 'About this picture'),
    h(
      'p',
      {},
      'The rod flies in closed form, on the server’s clock. The table is known at its strikes; between them it is drawn on the smoothest way. ' +
        'Drag the rod by its middle to move it and by an end to tilt it; let go to release it. Before a release the faint path shows its first flights.',
    ),
    h('dl', {}, ...MEANINGS.map(([name, meaning]) => h('div', {}, h('dt', {}, name), h('dd', {}, meaning)))),
  );
