// The parts of the page and the state that they share.

import { byId } from '../dom/elements.js';
import { RunControls } from '../run/controls.js';
import { Run } from '../run/run.js';
import { SceneView } from '../scene/scene-view.js';
import { TypedScene } from '../form/typed-scene.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../form/form.js').Form} Form */

/**
 * The page at a moment.
 * @typedef {object} State
 * @property {Scene} scene
 * @property {Scene} releasedAs
 * @property {import('contract').Preset | null} chosen
 * @property {string | null} run the query that replays it
 * @property {string} pins the part of the address of the pinned runs
 */

/** The field that the paper varies. */
export const GAIN = 'table.tilt_gain';

/** The typed scene with the parts that show it. */
export class Page extends TypedScene {
  /** The form of the typed scene. It comes after the first plot. @type {Form | null} */
  form = null;
  /** @type {import('contract').Preset[]} */
  cases = [];
  /** The case that the scene began with. @type {import('contract').Preset | null} */
  chosen = null;
  /** The typed scene when the run began. @type {Scene} */
  releasedAs = {};
  /** The panels' part of the address, until the panels are there. */
  panelLink = new URLSearchParams();
  /** The panels below the fold; they come after the first plot. @type {import('../panels/panels.js').Panels | null} */
  panels = null;
  /** The time line over the run; it comes late as well. @type {{toggle: () => boolean, step: (by: number) => boolean, toNow: () => void, replayFall: () => void} | null} */
  timeline = null;
  /** Runs that stay as references. @type {{pin: () => void, query: () => URLSearchParams, restore: (link: URLSearchParams) => string[]} | null} */
  pins = null;
  /** Undo and redo; it comes after the first plot. @type {{record: (words: string) => void, edit: (path: string, final: boolean) => void} | null} */
  history = null;
  /** True for a run that began without being asked for: the address names its scene only, until somebody acts on it. */
  byItself = false;
  /** An address without a run was opened. */
  opened = () => {};
  /** Marks the critical gain on its track, once that is there. */
  markGain = () => {};
  /** The newest verdict. @type {import('../panels/card.js').Judged | null} */
  judged = null;
  /** The case that the address names and that there is not. @type {string | null} */
  unknown = null;
  /** True while the run has lost the server. */
  away = false;
  /** True while the last catch or throw is that of a panel, which tells of problems with it. */
  guidedByPanel = false;
  /** The element that names the scene's case. */
  chooser = byId('case', HTMLSelectElement);
  /** Comes after the first plot, with what asks for verdicts. @type {import('../panels/verdict/verdict.js').Verdict | null} */
  verdict = null;
  /** Asks for what belongs to the typed scene, once it is there; true when answers on the scene before are void. @type {(another: boolean) => void} */
  follow = () => {};
  /** The line on the run, once there is a run. @type {import('../panels/verdict/this-run.js').ThisRun | null} */
  thisRun = null;
  /** Charts of the bounces; they come after the first picture. @type {import('../charts/impacts/impact-plot.js').ImpactPlot[]} */
  plots = [];
  /** The bounces to come, which may be there before the charts. @type {import('../run/run-state.js').RunState | null} */
  ahead = null;
  /** Comes with them. @type {import('../charts/eigenvalue-circle.js').EigenvalueCircle | null} */
  circle = null;
  /** True while a change of a value drops the body anew; else the run under way takes it, where it can. */
  anew = true;
  run = new Run();
  view = new SceneView(byId('scene-frame'), byId('scene-readout'), this.run);
  controls;

  /** @param {(page: Page) => import('../run/controls.js').Actions} actionsOf */
  constructor(actionsOf) {
    super();
    this.view.measure(false);
    this.controls = new RunControls(byId('controls'), byId('timeline'), actionsOf(this));
  }

  /** Speed of the runs, in times real time. */
  get speed() {
    return this.controls.speed;
  }

  set speed(speed) {
    this.controls.speed = speed;
  }

  /** Leads to the first value that is wrong. */
  showFault() {
    this.panels?.show('values');
    this.form?.complain();
    this.form?.focusError();
  }

  /** The panels' part of the address. */
  get panelQuery() {
    return this.panels?.query() ?? this.panelLink;
  }
}
