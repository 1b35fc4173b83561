// The rod as a thing to take hold of: drag it to a height, a place and a tilt, let go, and it runs. By pointer, touch and keys.

import { launch } from '../app/scenes.js';
import { roundStep } from '../charts/axes.js';
import { placeIn } from '../charts/surface.js';
import { h } from '../dom/elements.js';
import { fixedQuantity } from '../dom/numbers.js';
import { angles } from '../dom/units.js';
import { contactDistance, derivedOf, reachAbove } from '../physics/body.js';

/** @typedef {import('../physics/flight.js').Pose} Pose */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {{x: number, y: number, from: Pose, tilts: boolean}} Press where the rod was taken hold of, px, and its pose then */

/** Less than this is a press that slipped, px. */
const SLIP = 4;
/** Beyond this share of the way from the centre of gravity to an end, the end is held and the rod tilts. */
const END = 0.5;
/** An end nearer than this cannot be told from the centre, px. */
const NEAR = 14;
/** A pointer brings the centre of gravity no nearer to an edge of the picture, px. */
const INSIDE = 14;
/** Room for a finger around the rod, px. */
const BROAD = 44;
/** Decimals of a tilt by pointer. */
const TILT_DECIMALS = 3;

const HINT =
  'Up and down lift and lower it, left and right tilt it, with Ctrl they move it sideways, with Shift they go ten times as far. Enter releases it, Escape puts it back.';

export class Grab {
  #page;
  #handle;
  #said = h('p', { class: 'unseen', role: 'status', id: 'grab-said' });
  /** As drawn last: the pose and its scale. @type {import('./bodies.js').Drawn | null} */
  #drawn = null;
  /** The pose in hand. @type {Pose | null} */
  #pose = null;
  /** @type {Press | null} */
  #pressed = null;
  #size = '';

  /** @param {HTMLElement} box of the scene @param {import('../app/page.js').Page} page */
  constructor(box, page) {
    this.#page = page;
    this.#handle = h('div', {
      id: 'grab',
      class: 'grab',
      role: 'application',
      tabindex: 0,
      'aria-roledescription': 'handle',
      'aria-label': `The rod, to be released from elsewhere. ${HINT}`,
      hidden: true,
    });
    box.append(this.#handle);
    box.after(this.#said);
    page.view.followers.push((drawn) => this.#follow(drawn));
    this.#listen(box);
    page.view.redraw();
  }

  /** Keeps the handle on the drawn body. @param {import('./bodies.js').Drawn} drawn */
  #follow(drawn) {
    this.#drawn = drawn;
    const { scale, scene, pose, zoom } = drawn;
    const [above, below] = [reachAbove(scene), contactDistance(scene)].map((reach) =>
      Math.max(reach * scale.metre * zoom + 8, BROAD / 2),
    );
    const { style } = this.#handle;
    const size = `${above.toFixed(1)} ${below.toFixed(1)}`;
    if (size !== this.#size) {
      this.#size = size;
      style.width = `${BROAD}px`;
      style.height = `${above + below}px`;
      style.transformOrigin = `50% ${above}px`;
      style.left = `${-BROAD / 2}px`;
      style.top = `${-above}px`;
    }
    style.transform = `translate(${(scale.x(pose.x) * zoom).toFixed(1)}px, ${(scale.y(pose.y) * zoom).toFixed(1)}px) rotate(${(-pose.theta).toFixed(4)}rad)`;
    this.#handle.hidden = false;
  }

  /** @param {HTMLElement} box */
  #listen(box) {
    const handle = this.#handle;
    // The focus is for keys: whoever drags goes on with the keys of the page.
    handle.addEventListener('mousedown', (event) => event.preventDefault());
    handle.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || !event.isPrimary || !this.#drawn) return;
      const place = placeIn(box, event);
      const from = this.#pose ?? this.#drawn.pose;
      this.#pressed = { ...place, from, tilts: this.#isAtEnd(place, from) };
      handle.setPointerCapture(event.pointerId);
    });
    handle.addEventListener('pointermove', (event) => {
      const place = placeIn(box, event);
      const pressed = this.#pressed;
      if (!pressed) {
        if (this.#drawn) handle.classList.toggle('tilts', this.#isAtEnd(place, this.#drawn.pose));
        return;
      }
      if (!handle.classList.contains('held')) {
        if (Math.hypot(place.x - pressed.x, place.y - pressed.y) < SLIP) return;
        handle.classList.add('held');
      }
      this.#drag(place, pressed);
    });
    handle.addEventListener('pointerup', () => {
      const dragged = handle.classList.contains('held') && this.#pressed !== null;
      this.#pressed = null;
      if (dragged) this.#release();
    });
    handle.addEventListener('pointercancel', () => this.#cancel());
    handle.addEventListener('blur', () => this.#cancel());
    handle.addEventListener('keydown', (event) => this.#key(event));
    addEventListener(
      'keydown',
      (event) => {
        if (event.key !== 'Escape' || !this.#pose) return;
        this.#cancel();
        event.preventDefault();
        event.stopPropagation();
      },
      { capture: true },
    );
  }

  /** True where the rod is held beside its centre of gravity. @param {{x: number, y: number}} place px @param {Pose} pose */
  #isAtEnd(place, pose) {
    const { scale, scene } = /** @type {import('./bodies.js').Drawn} */ (this.#drawn);
    const [dx, dy] = [place.x - scale.x(pose.x), place.y - scale.y(pose.y)];
    const up = -dx * Math.sin(pose.theta) - dy * Math.cos(pose.theta);
    const end = (up > 0 ? reachAbove(scene) : contactDistance(scene)) * scale.metre;
    return contactDistance(scene) > 0 && Math.abs(up) > Math.max(NEAR, END * end);
  }

  /** @param {{x: number, y: number}} place px @param {Press} pressed */
  #drag(place, { x, y, from, tilts }) {
    const { scale } = /** @type {import('./bodies.js').Drawn} */ (this.#drawn);
    if (!tilts) {
      // The picture does not move under a pointer, so the centre of gravity stays in it.
      const within = (/** @type {number} */ px, /** @type {number} */ end) => Math.min(end, Math.max(INSIDE, px));
      const right = within(scale.x(from.x) + place.x - x, scale.right - INSIDE);
      const down = within(scale.y(from.y) + place.y - y, Infinity);
      this.#hold({
        ...from,
        x: from.x + (right - scale.x(from.x)) / scale.metre,
        y: from.y - (down - scale.y(from.y)) / scale.metre,
      });
      return;
    }
    const about = (/** @type {number} */ px, /** @type {number} */ py) =>
      Math.atan2(px - scale.x(from.x), py - scale.y(from.y));
    const turn = about(place.x, place.y) - about(x, y);
    this.#hold({ ...from, theta: from.theta + Math.atan2(Math.sin(turn), Math.cos(turn)) });
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.altKey || event.metaKey || !this.#drawn) return;
    if (event.key === 'Enter' && this.#pose) this.#release();
    else if (event.key.startsWith('Arrow')) this.#nudge(event, this.#drawn);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** @param {KeyboardEvent} event @param {import('./bodies.js').Drawn} drawn */
  #nudge({ key, ctrlKey, shiftKey }, { pose, scale }) {
    const times = shiftKey ? 10 : 1;
    const by = key === 'ArrowUp' || key === 'ArrowRight' ? times : -times;
    // A step of the place is a few pixels.
    const step = roundStep(3 / scale.metre, 1) * by;
    const at = this.#pose ?? pose;
    this.#handle.classList.add('held');
    if (key === 'ArrowUp' || key === 'ArrowDown') this.#hold({ ...at, y: at.y + step });
    else if (ctrlKey) this.#hold({ ...at, x: at.x + step });
    // The right arrow tilts to the right, which is clockwise.
    else this.#hold({ ...at, theta: at.theta - by * (angles() === 'deg' ? Math.PI / 180 : 0.01) });
    this.#say(`Held ${this.#words()}. Enter releases it.`);
  }

  /** Takes a pose in hand, as near as a release allows. @param {Pose} wanted */
  #hold(wanted) {
    const drawn = /** @type {import('./bodies.js').Drawn} */ (this.#drawn);
    const { scene, scale } = drawn;
    const within = (/** @type {string} */ path, /** @type {number} */ value) => {
      const { minimum, maximum } = this.#page.fields.find((field) => field.field === path) ?? {};
      return Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, value));
    };
    const theta = contactDistance(scene) === 0 ? 0 : within('release.theta', rounded(wanted.theta, TILT_DECIMALS));
    // No finer than the pixels tell.
    const decimals = Math.max(0, Math.ceil(Math.log10(scale.metre)));
    const y = within('release.height', Math.max(lowestHeight(scene, theta), rounded(wanted.y, decimals)));
    this.#pose = { x: within('release.x', rounded(wanted.x, decimals)), y, theta };
    const byHand = this.#pressed !== null;
    const rest = byHand ? 'Let go to release it.' : 'Enter releases it, Escape puts it back.';
    this.#page.view.hold(this.#pose, `Held ${this.#words()}. ${rest}`, !byHand);
  }

  #words() {
    const { x, y, theta } = /** @type {Pose} */ (this.#pose);
    return `${fixedQuantity(y, 'm', 3)} high, tilted by ${fixedQuantity(theta, 'rad', 3)}, at x = ${fixedQuantity(x, 'm', 3)}`;
  }

  #release() {
    const pose = this.#pose;
    if (!pose) return;
    const words = this.#words();
    const typed = this.#page.complete;
    this.#letGo();
    if (!typed) return this.#say('Nothing is released: a setting is no number.');
    /** @type {Record<string, number>} */
    const values = { 'release.height': pose.y };
    if (!typed.body?.point) values['release.theta'] = pose.theta;
    if (pose.x !== (typed.release?.x ?? 0)) values['release.x'] = pose.x;
    // From a hand it starts at rest.
    for (const name of ['x_dot', 'y_dot', 'theta_dot']) if (typed.release?.[name]) values[`release.${name}`] = 0;
    launch(this.#page, values);
    this.#say(`Released ${words}`);
  }

  #cancel() {
    if (!this.#pose) return;
    this.#letGo();
    this.#say('Put back');
  }

  #letGo() {
    this.#pressed = null;
    this.#pose = null;
    this.#handle.classList.remove('held');
    this.#page.view.hold(null);
  }

  /** @param {string} words */
  #say(words) {
    this.#said.textContent = words;
  }
}

/** @param {number} value @param {number} decimals */
const rounded = (value, decimals) => Number(value.toFixed(Math.min(12, decimals)));

/** The height of the centre of gravity at which the body stands on the table, m. @param {Scene} scene @param {number} theta */
function lowestHeight(scene, theta) {
  const { contact_distance: l, outline } = derivedOf(scene);
  const corners = outline ?? [[0, -l]];
  return Math.max(...corners.map(([x, y]) => -(x * Math.sin(theta) + y * Math.cos(theta))));
}
