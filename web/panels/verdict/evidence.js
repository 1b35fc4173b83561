// The evidence on stability beyond the linear map, in sentences: rotation, chaos, predictability, basin.

import { Problem } from '../../api/client.js';
import { h } from '../../dom/elements.js';
import { prose } from '../../dom/typeset.js';
import { number, quantity } from '../../dom/numbers.js';
import { angles } from '../../dom/units.js';

/** @typedef {import('contract').Stability} Stability */

/** @param {number} angle */
const inBoth = (angle) =>
  `${quantity(angle, 'rad')}${angles() === 'deg' ? '' : ` (${quantity((angle * 180) / Math.PI, '°', 3)})`}`;

/** @param {Stability} answer @returns {(readonly [string, string])[]} name and sentence */
function sentences({ rotation_number: rotation, chaos, predictable_bounces: predictable }) {
  const found = [];
  if (rotation) {
    const {
      measured,
      small,
      resonance: { p, q, distance },
    } = rotation;
    const turns =
      measured === null
        ? `Small deviations make ${number(small)} turns a bounce`
        : `A fresh release makes ${number(measured)} turns a bounce, small deviations ${number(small)}`;
    found.push(
      /** @type {const} */ ([
        'Rotation',
        `${turns}; the nearest resonance is ${p}/${q}, ${number(distance, 2)} turns away.`,
      ]),
    );
  }
  if (chaos) {
    const part = chaos.chaotic
      ? 'Chaotic: nearby runs part exponentially'
      : 'Regular: nearby runs part no faster than evenly';
    found.push(
      /** @type {const} */ ([
        'Chaos',
        `${part} (MEGNO ${number(chaos.indicator, 3)} over ${number(chaos.bounces)} bounces; regular is up to 2).`,
      ]),
    );
  }
  if (predictable !== null)
    found.push(
      /** @type {const} */ ([
        'Predictable',
        `For ${number(predictable)} bounces: then rounding has grown to a thousandth of the bounce’s speed, and a single run means nothing.`,
      ]),
    );
  else if (chaos)
    found.push(
      /** @type {const} */ ([
        'Predictable',
        `For all ${number(chaos.bounces)} bounces watched: rounding stays below a thousandth of the bounce’s speed.`,
      ]),
    );
  return found;
}

/** @param {Stability} answer */
function basinSentence({ basin, no_basin: reason }) {
  if (!basin) return `There is none: ${reason}.`;
  const { theta, unbroken, holes, bounces, spacing } = basin;
  if (theta === 0)
    return `Released at rest anywhere aside, it does not survive ${number(bounces)} bounces; angles were tried every ${quantity(spacing, 'rad', 2)}.`;
  const gaps =
    holes.length === 0
      ? ''
      : `, and with ${holes.length === 1 ? 'a gap' : `${holes.length} gaps`} up to ${inBoth(theta)}`;
  return `Released at rest it survives ${number(bounces)} bounces from up to ${inBoth(unbroken)} to either side${gaps}; angles were tried every ${quantity(spacing, 'rad', 2)}.`;
}

/** The same in a line, for a first look. @param {Stability} answer */
function gist({ rotation_number: rotation, chaos, predictable_bounces: predictable }) {
  const near = rotation?.strong_resonance;
  const parts = [
    chaos && (chaos.chaotic ? 'chaotic' : 'regular'),
    rotation &&
      `${number(rotation.measured ?? rotation.small, 3)} turns a bounce${near ? `, near ${near.p}/${near.q}` : ''}`,
    predictable !== null
      ? `predictable for ${number(predictable)} bounces`
      : chaos && `predictable ≥ ${number(chaos.bounces)} bounces`,
  ]
    .filter((part) => part)
    .join(' · ');
  return parts ? parts[0].toUpperCase() + parts.slice(1) : 'Beyond the linear map';
}

/**
 * @param {Stability} answer
 * @param {() => Promise<Stability>} measure asks for the basin as well, which is dearer
 */
export function evidence(answer, measure) {
  const near = answer.rotation_number?.strong_resonance;
  const basin = h('span', { role: 'status' });
  const ask = h('button', { type: 'button', id: 'basin' }, 'Measure it');
  ask.addEventListener('click', async () => {
    ask.disabled = true;
    basin.replaceChildren('Trying some 400 release angles…');
    try {
      basin.replaceChildren(...prose(basinSentence(await measure())));
    } catch (error) {
      // If the scene has changed meanwhile, nobody sees this any more.
      ask.disabled = false;
      basin.replaceChildren(error instanceof Problem ? `${error.message} ` : 'The server did not answer. ', ask);
    }
  });
  basin.append('How far aside may it be released? ', ask);
  // A point has no angle that could turn or be released aside.
  if ('point' in answer.scene.body || !answer.fixed_point) return '';
  /** @param {string} name @param {...(Node | string)} words */
  const row = (name, ...words) => [h('dt', {}, name), h('dd', {}, ...words)];
  return h(
    'details',
    { class: 'evidence' },
    h('summary', {}, gist(answer)),
    h(
      'dl',
      { 'aria-label': 'Beyond the linear map' },
      ...sentences(answer).flatMap(([name, words]) => row(name, words)),
      ...(near
        ? row(
            'Resonance',
            `${near.p}/${near.q}: the rotation number is within ${number(near.distance, 2)} of it. Near it the basin may have a dent, which the linear verdict does not see.`,
          )
        : []),
      ...row('Basin', basin),
    ),
  );
}
