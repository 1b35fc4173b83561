// An example of measured impacts: a run of the page's scene with other values of the unknown fields, as a camera would see it.

import { get } from '../../api/client.js';
import { number, quantity } from '../../dom/numbers.js';

/** Impacts of the run; the camera begins at the third. */
const [IMPACTS, BEFORE] = [63, 2];
/** Fewer show nothing. */
const LEAST = 12;
/** Noise of the camera, in s and rad. */
const SD = { t: 1e-3, theta: 2e-3 };
/** Share by which the unknown fields differ from those of the page. */
const HIDDEN = 0.02;
/** An impact that the camera misses, and one whose angle is read wrongly, by so many rad. */
const [MISSED, WRONG, OFF] = [20, 37, 0.1];
/** Time on the clock of the camera at the release, s. */
const CLOCK = 2.4;

/** A number from 0 to 1 that looks random, the same each time. @param {number} seed */
function uniform(seed) {
  const scattered = Math.sin(seed) * 43_758.5453;
  return scattered - Math.floor(scattered);
}

/** A normal deviate, by Box and Muller. @param {number} seed */
const normal = (seed) =>
  Math.sqrt(-2 * Math.log(1 - uniform(2 * seed + 1))) * Math.cos(2 * Math.PI * uniform(2 * seed + 2));

/**
 * A table of impacts, and words on what is hidden in it; null where the run of the scene ends too soon.
 * @param {URLSearchParams} scene
 * @param {import('./fields.js').Unknown[]} unknown
 * @returns {Promise<{file: File, about: string} | null>}
 */
export async function exampleOf(scene, unknown) {
  const hidden = unknown.flatMap(({ field, value }) => {
    const other = value && Number((value * (1 + HIDDEN)).toPrecision(4));
    const isWithin = other && other <= (field.maximum ?? Infinity) && other >= (field.minimum ?? -Infinity);
    return isWithin ? [{ field, value: other }] : [];
  });
  // Values beside those of the page may fall where it does not.
  for (const values of [hidden, []]) {
    const query = new URLSearchParams(scene);
    for (const { field, value } of values) query.set(`scene.${field.field}`, String(value));
    const { impacts } = await get(`v1/trajectories?${query}&bounces=${IMPACTS}`);
    if (impacts.t.length >= (values.length > 0 ? IMPACTS : LEAST))
      return { file: tableOf(impacts), about: words(values, impacts.t.length) };
  }
  return null;
}

/** @param {Record<'t' | 'theta', number[]>} impacts */
function tableOf({ t, theta }) {
  const rows = t.map((time, index) => {
    const angle = theta[index] + SD.theta * normal(2 * index + 1) + (index === WRONG ? OFF : 0);
    return `${(time + CLOCK + SD.t * normal(2 * index)).toFixed(5)},${angle.toFixed(5)}`;
  });
  const seen = rows.filter((_, index) => index >= BEFORE && index !== MISSED);
  return new File([`t (s),theta (rad)\n${seen.join('\n')}\n`], 'Example');
}

/** @param {{field: Field, value: number}[]} values @param {number} impacts */
function words(values, impacts) {
  const told = values.map(({ field, value }) => `${field.title.toLowerCase()} ${quantity(value, field.unit, 5)}`);
  const rig =
    told.length > 0 ? `the run of a rig with ${told.join(' and ')}, else as this scene` : 'the run of this scene';
  const faults = impacts > WRONG ? ' One bounce is missed, one angle wrong.' : '';
  return `Computed: ${rig}, with noise of ${number(SD.t * 1e3)} ms and ${quantity(SD.theta, 'rad')}.${faults}`;
}
