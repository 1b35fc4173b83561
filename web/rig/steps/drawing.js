// The rig at its release, to scale: the body over the table, its lengths, and the tilt that meets it.

import { quantity } from '../../dom/numbers.js';
import { derivedOf, drawable } from '../../physics/body.js';
import { html } from '../../vendor/preact/preact.js';

/** @typedef {import('../../api/scene-fields.js').Scene} Scene */

/** Size of the picture, px of its own, with room around what is drawn. */
const [WIDTH, HEIGHT, ROOM] = [300, 250, 26];
/** Least half width that is shown, in body lengths. */
const BESIDE = 1.1;

/** The tilt of the table by its law at the angle of the release; null where it takes more than that. @param {Scene} scene */
function tiltOf({ table = {}, release = {} }) {
  const theta = release.theta ?? 0;
  if (table.feedback) return table.feedback.theta === undefined ? null : -table.feedback.theta * theta;
  return typeof table.tilt_gain === 'number' ? table.tilt_gain * theta : null;
}

/** @param {{scene: Scene, derived: import('contract').Derived | null}} props */
export function Drawing({ scene: typed, derived }) {
  const scene = drawable(typed, derived);
  /** @type {import('contract').Derived} */
  const { contact_distance: l, radius_of_gyration: rho, outline } = derivedOf(scene);
  const { height = 0, theta = 0 } = typed.release ?? {};
  const alpha = tiltOf(typed) ?? 0;
  const top = height + Math.max(l, rho ?? 0, ...(outline ?? []).map(([x, y]) => Math.hypot(x, y)));
  const half = Math.max(BESIDE * Math.max(l, 0.05), ...(outline ?? []).map(([x, y]) => Math.hypot(x, y)));
  const reach = half * 0.95;
  const low = Math.min(height - l, -reach * Math.abs(Math.sin(alpha)));
  const metre = Math.min((HEIGHT - 2 * ROOM) / (top - low || 1), (WIDTH - 4 * ROOM) / (2 * half));
  const [x0, y0] = [WIDTH / 2 + ROOM / 2, HEIGHT - ROOM + low * metre];
  const at = (/** @type {number} */ x, /** @type {number} */ y) =>
    `${(x0 + x * metre).toFixed(1)} ${(y0 - y * metre).toFixed(1)}`;
  /** A point of the body, turned with it. @param {number} x @param {number} y */
  const turned = (x, y) =>
    at(x * Math.cos(theta) - y * Math.sin(theta), height + x * Math.sin(theta) + y * Math.cos(theta));
  const table = (/** @type {number} */ tilt) =>
    `M${at(-reach * Math.cos(tilt), -reach * Math.sin(tilt))}L${at(reach * Math.cos(tilt), reach * Math.sin(tilt))}`;
  const upper = Math.max(l, rho ?? 0);
  const body = outline
    ? `M${outline.map(([x, y]) => turned(x, y)).join('L')}Z`
    : `M${turned(0, -l)}L${turned(0.045 * upper, -0.85 * l)}L${turned(0.045 * upper, upper)}L${turned(-0.045 * upper, upper)}L${turned(-0.045 * upper, -0.85 * l)}Z`;
  const side = x0 - half * metre - 10;
  const words = [
    l > 0 ? `contact ${quantity(l, 'm', 3)} from the centre of gravity` : 'a point',
    rho !== null && `radius of gyration ${quantity(rho, 'm', 3)}`,
    `dropped from ${quantity(height, 'm', 3)} at ${quantity(theta, 'rad', 3)}`,
    `the table tilts ${quantity(alpha, 'rad', 3)} for it`,
  ].filter(Boolean);
  return html`<figure class="drawing">
    <svg viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label=${`The rig to scale: ${words.join(', ')}.`}>
      <path class="table" d=${table(0)} />
      ${alpha !== 0 && html`<path class="table tilted" d=${table(alpha)} />`}
      <path class="measure" d=${`M${side} ${y0}V${y0 - height * metre}m-4 0h8M${side - 4} ${y0}h8`} />
      <text class="words" x=${side - 6} y=${y0 - (height * metre) / 2} text-anchor="end"><tspan class="sign">y₀</tspan></text>
      <path class="upright" d=${`M${at(0, height)}V${(y0 - top * metre - 6).toFixed(1)}`} />
      ${l > 0 && html`<path class="body" d=${body} />`}
      ${l > 0 && rho !== null && [-rho, rho].map((way) => html`<path class="gyration" d=${`M${turned(-0.09 * l, way)}L${turned(0.09 * l, way)}`} />`)}
      <circle class="centre" cx=${x0} cy=${y0 - height * metre} r="5" />
      ${l > 0 && html`<text class="words sign" x=${Number(turned(0.16 * l, -l / 2).split(' ')[0])} y=${Number(turned(0.16 * l, -l / 2).split(' ')[1])}>l</text>`}
      ${l > 0 && rho !== null && html`<text class="words sign" x=${Number(turned(0.16 * l, rho).split(' ')[0])} y=${Number(turned(0.16 * l, rho).split(' ')[1]) + 4}>ρ</text>`}
      ${theta !== 0 && l > 0 && html`<text class="words sign" x=${x0 + (theta > 0 ? -22 : 14)} y=${y0 - top * metre - 8}>θ₀</text>`}
    </svg>
    <figcaption class="muted">${alpha === 0 ? 'At its release, to scale' : `The table meets it at ${quantity(alpha, 'rad', 3)}`}</figcaption>
  </figure>`;
}
