// Speed, kick, catch and throw under the scene; they come after the first picture. A kick of a chosen size stands in the time line.

import { catchIt, throwIt } from '../app/late/guide.js';
import { byId, h } from '../dom/elements.js';
import { number } from '../dom/numbers.js';
import { parse } from '../dom/typed-number.js';
import { UNITS, shownValue } from '../dom/units.js';
import { steady } from '../form/sliders.js';
import { Choice, NumberField } from '../panels/parts.js';
import { html, render } from '../vendor/preact/preact.js';
import { FASTEST, SLOWEST, VELOCITIES } from './interventions.js';

// The slider of the speed is logarithmic, with 1 where one finds it again.
const STEPS = 100;
const slow = Math.log(SLOWEST);
const span = Math.log(FASTEST) - slow;

/** @param {number} speed */
const placeOf = (speed) => Math.round(((Math.log(speed) - slow) / span) * STEPS);

/** @param {number} place */
function speedAt(place) {
  const speed = Math.exp(slow + (span * place) / STEPS);
  return Math.abs(Math.log(speed)) < span / STEPS ? 1 : Number(speed.toPrecision(2));
}

const CHOICES = Object.fromEntries(Object.entries(VELOCITIES).map(([name, { way, sign }]) => [name, `${way} ${sign}`]));

/** @type {[sign: string, label: string, name: string, by: 1 | -1][]} */
const DIRECTIONS = [
  ['←', 'Kick to the left', 'x_dot', -1],
  ['→', 'Kick to the right', 'x_dot', 1],
  ['↑', 'Kick upwards', 'y_dot', 1],
  ['↺', 'Kick counter-clockwise', 'theta_dot', 1],
  ['↻', 'Kick clockwise', 'theta_dot', -1],
];

/** The usual size of a kick, round in the unit that the page shows. @param {string} name of the velocity */
function usualOf(name) {
  const { usual, unit } = VELOCITIES[name];
  return parse(String(Number(shownValue(usual, unit).toPrecision(2))), unit) ?? usual;
}

/** @param {Page} page */
export function bringSliders(page) {
  // Beside elements that others have made.
  const root = h('div', { class: 'contents' });
  byId('controls').append(root);
  /** The speed as it was drawn last, and the place of its slider, which a hand may have moved since. */
  let speed = NaN;
  let place = 0;
  /** The velocity that a kick changes, and by how much. */
  let name = 'theta_dot';
  let by = usualOf(name);

  const blame = (/** @type {string} */ words) => {
    byId('kick-error').textContent = words;
  };

  /** Kicks by as much as is typed, or by another size. */
  const kick = (size = by) => {
    blame('');
    page.act('the kick', { type: 'kick', [name]: size });
  };

  /** @param {string} velocity that a kick changes, by its usual size */
  const choose = (velocity) => {
    name = velocity;
    by = usualOf(name);
    blame('');
    draw();
  };

  const hold = (/** @type {HTMLInputElement | null} */ slider) => {
    const giveBack = () => {
      place = placeOf(speed);
      draw();
    };
    if (slider) steady(slider, () => giveBack);
  };

  const draw = () => {
    if (page.speed !== speed) place = placeOf(page.speed);
    speed = page.speed;
    const disabled = !page.run.active;
    const shown = number(speedAt(place), 3);
    const turn = (/** @type {Event} */ { type, currentTarget }) => {
      place = /** @type {HTMLInputElement} */ (currentTarget).valueAsNumber;
      if (type === 'change') page.setSpeed(speedAt(place));
      else draw();
    };
    const guided = (/** @type {(page: Page) => void} */ deed) => () => {
      blame('');
      deed(page);
    };
    render(
      html`<div class="control speed">
          <label for="speed">Speed</label>
          <input type="range" id="speed" min="0" max=${STEPS} step="1" value=${place} ref=${hold}
            aria-valuetext=${`${shown} times real time`}
            onInput=${turn} onChange=${turn} />
          <output class="value" for="speed">×${shown}</output>
        </div>
        <div class="acts">
          <button type="button" id="kick" disabled=${disabled} onClick=${() => kick()}>Kick</button>
          <button type="button" id="catch-it" disabled=${disabled} onClick=${guided(catchIt)}>Catch</button>
          <button type="button" id="throw-it" disabled=${disabled} onClick=${guided(throwIt)}>Throw</button>
        </div>
        <p class="error" id="kick-error" role="status" />`,
      root,
    );
    const towards = (/** @type {string} */ velocity, /** @type {1 | -1} */ way) => () => {
      if (velocity !== name) choose(velocity);
      kick(way * Math.abs(by));
    };
    render(
      html`<div class="directions" role="group" aria-label="Kick towards">
          ${DIRECTIONS.map(
            ([sign, label, velocity, way]) =>
              html`<button type="button" aria-label=${label} disabled=${disabled} onClick=${towards(velocity, way)}>${sign}</button>`,
          )}
        </div>
        <${Choice} id="kick-what" label="What the kick changes" value=${name} choices=${CHOICES} changed=${choose} />
        <${NumberField} id="kick-by" label="By how much the kick changes it" unit=${VELOCITIES[name].unit} value=${by}
          changed=${(/** @type {number} */ size) => {
            by = size;
          }} />`,
      byId('kicks'),
    );
  };

  document.addEventListener(UNITS, () => choose(name));
  draw();
  return { draw, kick: () => kick(), blame };
}
