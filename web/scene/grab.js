// The rod as a thing to take hold of: drag it to a height, a place and a tilt, let go, and it runs. By pointer, touch and keys.

import { launch } from '../app/scenes.js';
import { drags, keepsFocus } from '../dom/drag.js';
import { byId, h } from '../dom/elements.js';
import { fixedQuantity, roundStep } from '../dom/numbers.js';
import { angles } from '../dom/units.js';
import { contactDistance, derivedOf, reachAbove } from '../physics/body.js';

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

/** @param {number} value @param {number} decimals */
const rounded = (value, decimals) => Number(value.toFixed(Math.min(12, decimals)));

/** The height of the centre of gravity at which the body stands on the table, m. @param {Scene} scene @param {number} theta */
function lowestHeight(scene, theta) {
  const { contact_distance: l, outline } = derivedOf(scene);
  const corners = outline ?? [[0, -l]];
  return Math.max(...corners.map(([x, y]) => -(x * Math.sin(theta) + y * Math.cos(theta))));
}

/** @param {Page} page */
export function bringGrab(page) {
  const { view } = page;
  const box = byId('scene-frame');
  /** The body as it was drawn last. @type {Drawn} */
  let drawn;
  /** The pose in hand. @type {Pose | null} */
  let pose = null;
  /** The pose when the rod was taken hold of by a pointer, which tilts it by an end. @type {{from: Pose, tilts: boolean} | null} */
  let pressed = null;
  /** Reaches of the handle above and below the centre of gravity. */
  let size = '';
  const said = h('p', { class: 'unseen', role: 'status', id: 'grab-said' });
  const handle = h('div', {
    id: 'grab',
    class: 'grab',
    role: 'application',
    tabindex: 0,
    'aria-roledescription': 'handle',
    'aria-label': `The rod, to be released from elsewhere. ${HINT}`,
    hidden: true,
  });

  const say = (/** @type {string} */ words) => {
    said.textContent = words;
  };

  const words = (/** @type {Pose} */ { x, y, theta }) =>
    `${fixedQuantity(y, 'm', 3)} high, tilted by ${fixedQuantity(theta, 'rad', 3)}, at x = ${fixedQuantity(x, 'm', 3)}`;

  const letGo = () => {
    pressed = null;
    pose = null;
    handle.classList.remove('held');
    view.hold(null);
  };

  const cancel = () => {
    if (!pose) return;
    letGo();
    say('Put back');
  };

  const release = () => {
    if (!pose) return;
    const { x, y, theta } = pose;
    const typed = page.complete;
    letGo();
    if (!typed) return say('Nothing is released: a setting is no number.');
    /** @type {Record<string, number>} */
    const values = { 'release.height': y };
    if (!typed.body?.point) values['release.theta'] = theta;
    if (x !== (typed.release?.x ?? 0)) values['release.x'] = x;
    // From a hand it starts at rest.
    for (const name of ['x_dot', 'y_dot', 'theta_dot']) if (typed.release?.[name]) values[`release.${name}`] = 0;
    launch(page, values);
    say(`Released ${words({ x, y, theta })}`);
  };

  /** Takes a pose in hand, as near as a release allows. @param {Pose} wanted */
  const hold = (wanted) => {
    const { scene, stage } = drawn;
    handle.classList.add('held');
    const within = (/** @type {string} */ path, /** @type {number} */ value) => {
      const { minimum, maximum } = page.fields.find((field) => field.field === path) ?? {};
      return Math.min(maximum ?? Infinity, Math.max(minimum ?? -Infinity, value));
    };
    const theta = contactDistance(scene) === 0 ? 0 : within('release.theta', rounded(wanted.theta, TILT_DECIMALS));
    // No finer than the pixels tell.
    const decimals = Math.max(0, Math.ceil(Math.log10(stage.metre)));
    const y = within('release.height', Math.max(lowestHeight(scene, theta), rounded(wanted.y, decimals)));
    pose = { x: within('release.x', rounded(wanted.x, decimals)), y, theta };
    const rest = pressed ? 'Let go to release it.' : 'Enter releases it, Escape puts it back.';
    view.hold(pose, `Held ${words(pose)}. ${rest}`, pressed === null);
  };

  /** True where the rod is held beside its centre of gravity. @param {Place} place @param {Pose} at */
  const isAtEnd = (place, at) => {
    const { stage, scene } = drawn;
    const [dx, dy] = [place.x - stage.x(at.x), place.y - stage.y(at.y)];
    const up = -dx * Math.sin(at.theta) - dy * Math.cos(at.theta);
    const end = (up > 0 ? reachAbove(scene) : contactDistance(scene)) * stage.metre;
    return contactDistance(scene) > 0 && Math.abs(up) > Math.max(NEAR, END * end);
  };

  /** @param {Place} place @param {Place} start of the drag */
  const drag = (place, start) => {
    // Escape has put it back.
    if (!pressed) return;
    const { stage } = drawn;
    const { from, tilts } = pressed;
    const [x, y] = [stage.x(from.x), stage.y(from.y)];
    if (tilts) {
      const about = (/** @type {Place} */ one) => Math.atan2(one.x - x, one.y - y);
      const turn = about(place) - about(start);
      return hold({ ...from, theta: from.theta + Math.atan2(Math.sin(turn), Math.cos(turn)) });
    }
    // The picture does not move under a pointer, so the centre of gravity stays in it.
    const within = (/** @type {number} */ px, /** @type {number} */ end) => Math.min(end, Math.max(INSIDE, px));
    const right = within(x + place.x - start.x, stage.surface.width - INSIDE) - x;
    const down = within(y + place.y - start.y, Infinity) - y;
    hold({ ...from, x: from.x + right / stage.metre, y: from.y - down / stage.metre });
  };

  /** @param {KeyboardEvent} event */
  const nudge = ({ key, ctrlKey, shiftKey }) => {
    const by = (shiftKey ? 10 : 1) * (key === 'ArrowUp' || key === 'ArrowRight' ? 1 : -1);
    // A step of the place is a few pixels.
    const step = roundStep(3 / drawn.stage.metre, 1) * by;
    const at = pose ?? drawn.pose;
    if (key === 'ArrowUp' || key === 'ArrowDown') hold({ ...at, y: at.y + step });
    else if (ctrlKey) hold({ ...at, x: at.x + step });
    // The right arrow tilts to the right, which is clockwise.
    else hold({ ...at, theta: at.theta - by * (angles() === 'deg' ? Math.PI / 180 : 0.01) });
    if (pose) say(`Held ${words(pose)}. Enter releases it.`);
  };

  /** Keeps the handle on the drawn body. @param {Drawn} body */
  const follow = (body) => {
    drawn = body;
    const { stage, scene, pose: at } = body;
    const { zoom } = stage.surface;
    const [above, below] = [reachAbove(scene), contactDistance(scene)].map((reach) =>
      Math.max(reach * stage.metre * zoom + 8, BROAD / 2),
    );
    const [x, y] = [stage.x(at.x), stage.y(at.y)].map((px) => (px * zoom).toFixed(1));
    const { style } = handle;
    const now = `${above.toFixed(1)} ${below.toFixed(1)}`;
    if (now !== size) {
      size = now;
      style.width = `${BROAD}px`;
      style.height = `${above + below}px`;
      style.transformOrigin = `50% ${above}px`;
      style.left = `${-BROAD / 2}px`;
      style.top = `${-above}px`;
    }
    style.transform = `translate(${x}px, ${y}px) rotate(${(-at.theta).toFixed(4)}rad)`;
    handle.hidden = false;
  };

  box.append(handle);
  box.after(said);
  keepsFocus(handle);
  drags(handle, box, SLIP, {
    press: (place) => {
      const from = pose ?? drawn.pose;
      pressed = { from, tilts: isAtEnd(place, from) };
      return true;
    },
    drag,
    release: () => {
      const held = pressed !== null && handle.classList.contains('held');
      pressed = null;
      if (held) release();
    },
    cancel,
    hover: (place) => handle.classList.toggle('tilts', isAtEnd(place, drawn.pose)),
  });
  handle.addEventListener('blur', cancel);
  handle.addEventListener('keydown', (event) => {
    if (event.altKey || event.metaKey) return;
    if (event.key === 'Enter' && pose) release();
    else if (event.key.startsWith('Arrow')) nudge(event);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  /** @param {KeyboardEvent} event */
  const putBack = (event) => {
    if (event.key !== 'Escape' || !pose) return;
    cancel();
    event.preventDefault();
    event.stopPropagation();
  };
  addEventListener('keydown', putBack, { capture: true });
  view.followers.push(follow);
  view.redraw();
}
