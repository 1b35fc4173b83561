// The body and the table to scale: the typed scene before its release, or the run at the time of its clock.

import { CanvasView } from '../charts/surface.js';
import { h } from '../dom/elements.js';
import { fixed, fixedQuantity, number, quantity } from '../dom/numbers.js';
import { contactDistance, drawable } from '../physics/body.js';
import { poseOn } from '../physics/flight.js';
import { drawFlights, drawRod, drawTable } from './bodies.js';
import { Camera, drawGrid, drawRulers, drawTarget } from './camera.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../run/run.js').Run} Run */
/** @typedef {import('contract').Derived} Derived */
/** @typedef {import('./bodies.js').Drawn} Drawn */

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class SceneView extends CanvasView {
  /** Draws marks on the floor. @type {((surface: import('../charts/surface.js').Surface, scale: import('./camera.js').Scale, scene: Scene) => void) | null} */
  under = null;
  /** The tilt of a table in somebody's hand, rad. @type {number | null} */
  tilt = null;
  /** The rods of other runs on this stage. @type {import('./bodies.js').OtherRod[]} */
  others = [];
  /** Parts that go with the drawn body; some draw over it. @type {((drawn: Drawn) => void)[]} */
  followers = [];
  /** @type {import('./run-drawing.js').Parts} */
  #parts;
  /** The pose in a hand, and words on it. @type {{pose: import('../physics/flight.js').Pose, words: string} | null} */
  #held = null;
  /** The scene to draw while there is no run. @type {Scene | null} */
  #draft = null;
  /** Quantities that the server derived from it in the last answer. @type {Derived | null} */
  #known = null;
  /** The case whose word was taken for it. @type {Derived | null} */
  #ofCase = null;
  /** Flights in between are drawn unless motion is unwanted. */
  #moving = !stillness.matches;
  /** Draws runs, once a run has begun. @type {import('./run-drawing.js').RunDrawing | null} */
  #drawing = null;
  /** The run that the typed scene will have, once it is known. @type {import('../run/run-state.js').RunState | null} */
  #ahead = null;
  /** The typed scene falls from its release since then, at a speed, until its run is there. @type {{since_ms: number, speed: number} | null} */
  #falls = null;

  /**
   * @param {HTMLElement} box
   * @param {HTMLElement} readout
   * @param {Run} run
   */
  constructor(box, readout, run) {
    super(box, 1);
    const [surface] = this.layers;
    // Not the box, in which there may be controls.
    surface.canvas.setAttribute('role', 'img');
    surface.canvas.setAttribute('aria-label', 'The scene');
    this.#parts = {
      run,
      readout,
      surface,
      camera: new Camera(surface),
      guests: this,
      paint: (moment) => this.#paint(moment),
    };
    this.#offerMotion(box);
  }

  /** Lets people who want less motion have the flights all the same. @param {HTMLElement} box */
  #offerMotion(box) {
    const motion = h('input', {
      type: 'checkbox',
      change: () => {
        this.#moving = motion.checked;
        this.redraw();
      },
    });
    motion.checked = this.#moving;
    const label = h(
      'label',
      { class: 'motion check', hidden: !stillness.matches },
      motion,
      'Draw the flights, not only the strikes',
    );
    box.after(label);
    stillness.addEventListener('change', () => {
      label.hidden = !stillness.matches;
      this.#moving = !stillness.matches;
      motion.checked = this.#moving;
      this.redraw();
    });
  }

  /** The typed scene with what is known to follow from it. @returns {Scene} */
  get drawn() {
    return drawable(this.#draft ?? {}, this.#known);
  }

  /**
   * @param {Scene | null} scene
   * @param {Derived | null} ofCase what follows from the case that it began with: holds until the server answers for the scene itself
   */
  draft(scene, ofCase = null) {
    this.#draft = scene;
    if (ofCase && ofCase !== this.#ofCase) this.#known = ofCase;
    this.#ofCase = ofCase;
    if (this.#parts.run.phase === 'idle') this.#parts.camera.forget();
    this.redraw();
  }

  /** Takes the server's word for what follows from the typed scene. @param {Derived} derived */
  learn(derived) {
    this.#known = derived;
    if (this.#parts.run.phase === 'idle') this.#parts.camera.forget();
    this.redraw();
  }

  /** Shows where the typed scene will fly. @param {import('../run/run-state.js').RunState} run */
  preview(run) {
    this.#ahead = run;
    this.learn(run.released?.derived);
  }

  /** Draws rulers, symbols and numbers of strikes, or none of them. @param {boolean} measured */
  measure(measured) {
    this.#parts.camera.measured = measured;
    this.redraw();
  }

  /** Lets the typed scene fall from its release to its first contact, until its run is there. @param {number} speed */
  fall(speed) {
    this.#falls = this.#moving ? { since_ms: performance.now(), speed } : null;
    this.redraw();
  }

  /**
   * Draws the typed scene in this pose, whatever runs; null ends that.
   * @param {import('../physics/flight.js').Pose | null} pose
   * @param {string} [words] on it
   * @param {boolean} [grows] the picture makes room for it; under a pointer it must not, since places would move
   */
  hold(pose, words = '', grows = false) {
    if (pose && grows) this.#parts.camera.contain(this.drawn, pose.y);
    this.#held = pose && { pose, words };
    this.redraw();
  }

  /** @param {import('./run-drawing.js').Moment} moment */
  #paint({ scene, pose, table, colour, under, beside, over }) {
    const { camera, surface } = this.#parts;
    const { scale } = camera;
    const half = camera.halfTable(scene);
    drawGrid(surface, camera);
    drawTarget(surface, camera, scene);
    under?.(scale);
    drawTable(surface.context, scale, table, half, camera.floor);
    beside?.(scale);
    drawRod(surface.context, scale, scene, pose, { colour });
    const struck = over?.(scale) ?? false;
    for (const follow of this.followers) follow({ scene, pose, table, struck, half, scale, zoom: surface.zoom });
    drawRulers(surface, camera);
  }

  /** The camera and the scale start over with a new run. */
  reset() {
    this.#parts.camera.x = 0;
    this.#parts.camera.forget();
    this.redraw();
  }

  /** @override @param {number} now_ms */
  draw(now_ms) {
    const { run, surface, camera } = this.#parts;
    const live = run.phase !== 'idle' && run.scene !== null;
    if (this.#held) this.#drawRelease(this.drawn, this.#held);
    else if (live && this.#drawing) this.#drawing.draw(now_ms, this.#moving);
    else if (live) this.#loadDrawing();
    else if (this.#draft) this.#drawRelease(this.drawn, null, now_ms);
    else drawGrid(surface, camera);
    if (live) this.#falls = null;
    if (this.#drawing?.falls) return this.seen && this.#moving;
    return this.seen && (this.#falls !== null || (live && this.#drawing !== null && run.pace > 0 && this.#moving));
  }

  /** The pose of the typed scene on its first fall, held where the contact point meets the table; null before it is dropped. @param {Scene} scene @param {number} now_ms */
  #fallen(scene, now_ms) {
    if (!this.#falls) return null;
    const { since_ms, speed } = this.#falls;
    const { x = 0, height = 0, theta = 0, x_dot = 0, y_dot = 0, theta_dot = 0 } = scene.release ?? {};
    const l = contactDistance(scene);
    const arc = {
      t: 0,
      x,
      y: Math.max(height, l * Math.cos(theta)),
      theta,
      x_dot,
      y_dot,
      theta_dot,
      duration: Infinity,
    };
    let t = Math.max(0, (speed * (now_ms - since_ms)) / 1000);
    let pose = poseOn(arc, t, scene);
    // Below the table it waits for the server.
    for (let step = 0; step < 12 && pose.y < l * Math.cos(pose.theta); step += 1) {
      t *= 0.9;
      pose = poseOn(arc, t, scene);
    }
    return pose;
  }

  #loadDrawing() {
    void import('./run-drawing.js').then(
      ({ RunDrawing }) => {
        this.#drawing ??= new RunDrawing(this.#parts);
        this.redraw();
      },
      () => {},
    );
  }

  /** @param {Scene} scene @param {{pose: import('../physics/flight.js').Pose, words: string} | null} held @param {number} [now_ms] */
  #drawRelease(scene, held = null, now_ms = 0) {
    const { readout, surface, camera } = this.#parts;
    const { height = 0, theta: released = 0, x: place = 0 } = scene.release ?? {};
    const l = contactDistance(scene);
    const highest = Math.max(height, l * Math.cos(released));
    const { x, y, theta } = held?.pose ?? this.#fallen(scene, now_ms) ?? { x: place, y: highest, theta: released };
    // In a hand the body moves, and not the world.
    if (!held) {
      camera.contain(scene, highest);
      camera.x = place;
    }
    this.#paint({
      scene,
      pose: { x, y, theta },
      table: { x: x + l * Math.sin(theta), y: 0, alpha: 0 },
      under: (scale) => {
        if (!held && this.#ahead) drawFlights(surface.context, scale, this.#ahead);
      },
    });
    if (held) {
      readout.textContent = held.words;
      return;
    }
    readout.textContent = `Released at ${fixed(height, 3)} m, θ ${fixedQuantity(theta, 'rad', 3)}`;
    surface.canvas.setAttribute(
      'aria-label',
      `The scene before release: the centre of gravity ${number(height)} m high, tilted by ${quantity(theta, 'rad')}`,
    );
  }
}
