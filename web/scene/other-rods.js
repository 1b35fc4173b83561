// The rods of other runs on the same stage, at the same time since their release.

import { poseOn } from '../physics/flight.js';
import { drawRod } from './bodies.js';

/** @typedef {{run: import('../run/run-state.js').RunState, colour: import('./bodies.js').RodColour}} OtherRod */

const OPACITY = 0.6;

/** @param {CanvasRenderingContext2D} context @param {import('./camera.js').Scale} scale @param {OtherRod[]} others @param {number} t s */
export function drawOthers(context, scale, others, t) {
  for (const { run, colour } of others) {
    const arc = run.arcAt(t);
    if (arc && run.scene) drawRod(context, scale, run.scene, poseOn(arc, t, run.scene), { colour, opacity: OPACITY });
  }
}
