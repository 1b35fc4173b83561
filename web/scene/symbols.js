// The symbols of the paper's Fig. 1, each drawn where it belongs: l, ρ, θ, α, β and n.

import { paced } from '../dom/debounce.js';
import { byId } from '../dom/elements.js';
import { fixedQuantity } from '../dom/numbers.js';
import { derivedOf } from '../physics/body.js';
import { remember, remembered } from '../api/remembered.js';

const STORED = 'equipoise.symbols';
/** The spoken values follow the picture at most so often, ms. */
const SPOKEN_MS = 1000;
/** Distance of dimension lines from the rod, px. */
const ASIDE = 36;
/** An arc of fewer pixels is not seen. */
const LEAST_PX = 1;

/** The symbols and their values now, in words. @param {Drawn} drawn */
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

/** The place at a distance along a direction that is turned from upright. @param {Place} from @param {number} turned rad @param {number} px */
const at = (from, turned, px) => ({ x: from.x - px * Math.sin(turned), y: from.y - px * Math.cos(turned) });

/** @param {Drawn} drawn */
export function drawSymbols({ stage, scene, pose, table, half, struck }) {
  const { surface, metre } = stage;
  const { context } = surface;
  const { contact_distance, radius_of_gyration: rho } = derivedOf(scene);
  const centre = { x: stage.x(pose.x), y: stage.y(pose.y) };
  const middle = { x: stage.x(table.x), y: stage.y(table.y) };
  const l = contact_distance * metre;
  /** @param {Place} from @param {Place} to @param {number[]} dashes */
  const dashed = (from, to, dashes) => surface.line('muted', from.x, from.y, to.x, to.y, { dashes });
  /** A name on a ground that hides the lines behind it. @param {string} name @param {Place} place its middle */
  const label = (name, { x, y }) => {
    context.beginPath();
    context.rect(x - 6, y - 8, 12, 16);
    surface.faintly(0.75, () => surface.fill('surface'));
    surface.text(name, x, y, { colour: 'ink', size: 15, italic: true, align: 'center', baseline: 'middle' });
  };
  /** An arc between two directions from upright, and its name. @param {string} name @param {Place} about @param {number} from rad @param {number} to @param {number} radius px */
  const angle = (name, about, from, to, radius) => {
    if (Math.abs(to - from) * radius > LEAST_PX) {
      context.beginPath();
      context.arc(about.x, about.y, radius, -Math.PI / 2 - from, -Math.PI / 2 - to, to > from);
      surface.stroke('ink');
    }
    label(name, at(about, (from + to) / 2, radius + 11));
  };
  /** A length along the rod from its centre, beside it, with its name. @param {string} name @param {number} length px */
  const dimension = (name, length) => {
    const side = pose.theta > 0 ? -1 : 1;
    const across = pose.theta + (side * Math.PI) / 2;
    const begin = at(centre, across, ASIDE);
    const end = at(begin, pose.theta, length);
    surface.line('ink', begin.x, begin.y, end.x, end.y);
    for (const tip of [begin, end]) {
      const [one, other] = [at(tip, across, 4), at(tip, across, -4)];
      surface.line('ink', one.x, one.y, other.x, other.y);
    }
    label(name, at(at(begin, pose.theta, length / 2), across, 11));
  };
  // The tilt lies between the level and the face of the table, on the side where the table is the higher one.
  const level = table.alpha >= 0 ? -Math.PI / 2 : Math.PI / 2;
  const width = Math.max(24, half * metre);
  dashed(middle, at(middle, level, width + 22), [2, 3]);
  angle('α', middle, level, level + table.alpha, width);
  // A strike has its own normal.
  if (!struck) {
    const tip = at(middle, table.alpha, Math.max(60, 2.1 * l));
    dashed(middle, tip, [4, 4]);
    label('n', { x: tip.x + (table.alpha > 0 ? -9 : 9), y: tip.y });
  }
  if (l === 0) return;
  const foot = at(centre, pose.theta, -l);
  const rhoPx = (rho ?? 0) * metre;
  dashed(centre, at(centre, 0, Math.max(1.5 * l, rhoPx + 40)), [2, 3]);
  // Along the normal from the contact point, while that is not on the table.
  dashed(foot, at(foot, table.alpha, 0.55 * l), [2, 3]);
  // Within the picture.
  angle('θ', centre, 0, pose.theta, Math.max(20, Math.min(Math.max(l, rhoPx) + 14, centre.y - 22)));
  angle('β', foot, table.alpha, pose.theta, 0.5 * l);
  dimension('l', -l);
  if (rho !== null) dimension('ρ', rhoPx);
}

/** Offers the symbols at their button. @param {import('./scene-view.js').SceneView} view */
export function bringSymbols(view) {
  const words = byId('symbols-words');
  const button = byId('symbols');
  const isOn = () => button.getAttribute('aria-pressed') === 'true';
  const speak = paced(SPOKEN_MS, (/** @type {Drawn} */ drawn) => {
    words.textContent = isOn() ? `Drawn in the scene: ${spokenSymbols(drawn)}.` : '';
  });
  const show = (/** @type {boolean} */ on) => {
    button.setAttribute('aria-pressed', String(on));
    remember(STORED, on);
    words.textContent = '';
    view.measure(on);
  };
  button.addEventListener('click', () => show(!isOn()));
  view.followers.push((drawn) => {
    if (!isOn()) return;
    drawSymbols(drawn);
    speak(drawn);
  });
  show(remembered(STORED, false));
}
