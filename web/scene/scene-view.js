// The body and the table to scale: the typed scene before its release, or the run at the time of its clock.

import { h } from '../dom/elements.js';
import { fixed, fixedQuantity, number, quantity } from '../dom/numbers.js';
import { contactDistance, drawable } from '../physics/body.js';
import { arcFrom, poseOn } from '../physics/flight.js';
import { World, drawFlights } from './world.js';

const stillness = matchMedia('(prefers-reduced-motion: reduce)');

export class SceneView extends World {
  /** The pose in a hand, and words on it. @type {{pose: Pose, words: string} | null} */
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
  /** The run that the typed scene will have, once it is known. @type {RunState | null} */
  #ahead = null;
  /** The typed scene falls from its release since then, at a speed, until its run is there. @type {{since_ms: number, speed: number} | null} */
  #falls = null;

  /** @param {HTMLElement} box @param {HTMLElement} readout @param {Run} run */
  constructor(box, readout, run) {
    super(box, 1);
    this.readout = readout;
    this.run = run;
    // Not the box, in which there may be controls.
    this.canvas = this.layers[0].canvas;
    this.canvas.setAttribute('role', 'img');
    this.canvas.ariaLabel = 'The scene';
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
    const label = h('label', { class: 'motion check' }, motion, 'Draw the flights, not only the strikes');
    const follow = () => {
      label.hidden = !stillness.matches;
      this.#moving = !stillness.matches;
      motion.checked = this.#moving;
      this.redraw();
    };
    box.after(label);
    stillness.addEventListener('change', follow);
    follow();
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
    const known = ofCase && ofCase !== this.#ofCase ? ofCase : this.#known;
    this.#ofCase = ofCase;
    this.learn(known);
  }

  /** Takes the server's word for what follows from the typed scene. @param {Derived | null} derived */
  learn(derived) {
    this.#known = derived;
    if (this.run.phase === 'idle') this.forget();
    this.redraw();
  }

  /** Shows where the typed scene will fly. @param {RunState} run */
  preview(run) {
    this.#ahead = run;
    this.learn(run.released?.derived);
  }

  /** Draws rulers, symbols and numbers of strikes, or none of them. @param {boolean} measured */
  measure(measured) {
    this.measured = measured;
    this.redraw();
  }

  /** Lets the typed scene fall from its release to its first contact, until its run is there. @param {number} speed */
  fall(speed) {
    this.#falls = this.#moving ? { since_ms: performance.now(), speed } : null;
    this.redraw();
  }

  /**
   * Draws the typed scene in this pose, whatever runs; null ends that.
   * @param {Pose | null} pose
   * @param {string} [words] on it
   * @param {boolean} [grows] the picture makes room for it; under a pointer it must not, since places would move
   */
  hold(pose, words = '', grows = false) {
    if (pose && grows) this.contain(this.drawn, pose.y);
    this.#held = pose && { pose, words };
    this.redraw();
  }

  /** The camera and the scale start over with a new run. */
  reset() {
    this.x = 0;
    this.forget();
    this.redraw();
  }

  /** @override @param {number} now_ms */
  draw(now_ms) {
    const { run } = this;
    const live = run.phase !== 'idle' && run.scene !== null;
    if (this.#held) this.#drawRelease(this.drawn, now_ms);
    else if (live && this.#drawing) this.#drawing.draw(now_ms, this.#moving);
    else if (live) this.#loadDrawing();
    else if (this.#draft) this.#drawRelease(this.drawn, now_ms);
    else this.drawGrid();
    if (live) this.#falls = null;
    if (this.#drawing?.falls) return this.seen && this.#moving;
    return this.seen && (this.#falls !== null || (live && this.#drawing !== null && run.pace > 0 && this.#moving));
  }

  #loadDrawing() {
    void import('./run-drawing.js').then(
      ({ RunDrawing }) => {
        this.#drawing ??= new RunDrawing(this);
        this.redraw();
      },
      () => {},
    );
  }

  /** The pose of the typed scene on its first fall, held where the contact point meets the table; at its release before it is dropped. @param {Scene} scene @param {number} now_ms */
  #fallen(scene, now_ms) {
    const arc = arcFrom(scene, Infinity);
    const l = contactDistance(scene);
    arc.y = Math.max(arc.y, l * Math.cos(arc.theta));
    const { since_ms, speed } = this.#falls ?? { since_ms: now_ms, speed: 1 };
    let t = Math.max(0, (speed * (now_ms - since_ms)) / 1000);
    let pose = poseOn(arc, t, scene);
    // Below the table it waits for the server.
    for (let step = 0; step < 12 && pose.y < l * Math.cos(pose.theta); step += 1) {
      t *= 0.9;
      pose = poseOn(arc, t, scene);
    }
    return { released: arc, pose };
  }

  /** Draws the typed scene, in a hand or at its release. @param {Scene} scene @param {number} now_ms */
  #drawRelease(scene, now_ms) {
    const held = this.#held;
    const fall = this.#fallen(scene, now_ms);
    const { pose } = held ?? fall;
    const { released } = fall;
    // In a hand the body moves, and not the world.
    if (!held) {
      this.contain(scene, released.y);
      this.x = released.x;
    }
    const table = { x: pose.x + contactDistance(scene) * Math.sin(pose.theta), y: 0, alpha: 0 };
    this.paint(scene, pose, table, {
      under: (stage) => {
        if (!held && this.#ahead) drawFlights(stage, this.#ahead);
      },
    });
    const height = scene.release?.height ?? 0;
    this.readout.textContent =
      held?.words ?? `Released at ${fixed(height, 3)} m, θ ${fixedQuantity(pose.theta, 'rad', 3)}`;
    if (!held)
      this.canvas.ariaLabel = `The scene before release: the centre of gravity ${number(height)} m high, tilted by ${quantity(pose.theta, 'rad')}`;
  }
}
