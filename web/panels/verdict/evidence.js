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
        `${part} (MEGNO ${number(chaos.indicator, 3)} over ${number(chaos.bounces)} impacts; regular is up to 2).`,
      ]),
    );
  }
  if (predictable !== null)
    found.push(
      /** @type {const} */ ([
        'Predictable',
        `For ${number(predictable)} impacts: then rounding has grown to a thousandth of the bounce’s speed, and a single run means nothing.`,
      ]),
    );
  else if (chaos)
    found.push(
      /** @type {const} */ ([
        'Predictable',
        `For all ${number(chaos.bounces)} impacts watched: rounding stays below a thousandth of the bounce’s speed.`,
      ]),
    );
  return found;
}

/** @param {Stability} answer */
function basinSentence({ basin, notes }) {
  if (!basin) return notes.find((note) => note.startsWith('basin')) ?? 'It has none here.';
  const { theta, unbroken, holes, bounces, spacing } = basin;
  if (theta === 0)
    return `Released at rest anywhere aside, it does not survive ${number(bounces)} impacts; angles were tried every ${quantity(spacing, 'rad', 2)}.`;
  const gaps =
    holes.length === 0
      ? ''
      : `, and with ${holes.length === 1 ? 'a gap' : `${holes.length} gaps`} up to ${inBoth(theta)}`;
  return `Released at rest it survives ${number(bounces)} impacts from up to ${inBoth(unbroken)} to either side${gaps}; angles were tried every ${quantity(spacing, 'rad', 2)}.`;
}

/** The same in a line, for a first look. @param {Stability} answer */
function gist({ rotation_number: rotation, chaos, predictable_bounces: predictable, notes }) {
  const near = /^resonance (1\/\d)/.exec(notes.find((note) => note.startsWith('resonance')) ?? '');
  const parts = [
    chaos && (chaos.chaotic ? 'chaotic' : 'regular'),
    rotation && `${number(rotation.measured ?? rotation.small, 3)} turns a bounce${near ? `, near ${near[1]}` : ''}`,
    predictable !== null
      ? `predictable for ${number(predictable)} impacts`
      : chaos && `predictable ≥ ${number(chaos.bounces)} impacts`,
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
  const resonance = answer.notes.find((note) => note.startsWith('resonance'));
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
      ...(resonance ? row('Resonance', ...prose(resonance.replace(/^resonance /, ''))) : []),
      ...row('Basin', basin),
    ),
  );
}
