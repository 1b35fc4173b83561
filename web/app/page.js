// The page: its parts with the state that they share, its scene and its run as queries, its address, and the actions on the run.

import { MOST_IMPACTS } from '../api/client.js';
import { differences, playedAt, same, valueAt } from '../api/scene-fields.js';
import { sceneQuery } from '../api/scene-query.js';
import { debounce } from '../dom/debounce.js';
import { byId } from '../dom/elements.js';
import { clearNotice } from '../dom/notices.js';
import { keepAngles } from '../dom/units.js';
import { Run } from '../run/run.js';
import { SceneView } from '../scene/scene-view.js';
import { TypedScene } from '../form/typed-scene.js';

/** An address of the page. @param {URLSearchParams | null} query */
const whole = (query) => new URL(query ? `?${query}` : '', location.href).href;

/** The field that the paper varies. */
export const GAIN = 'table.tilt_gain';

/** The typed scene with the parts that show it. */
export class Page extends TypedScene {
  /** The form of the typed scene. It comes after the first plot. @type {Form | null} */
  form = null;
  /** @type {Case[]} */
  cases = [];
  /** The case that the scene began with. @type {Case | null} */
  chosen = null;
  /** The typed scene when the run began. @type {Scene} */
  releasedAs = {};
  /** The panels' part of the address, until the panels are there. */
  panelLink = new URLSearchParams();
  /** The panels below the fold; they come after the first plot. @type {Panels | null} */
  panels = null;
  /** The time line over the run; it comes late as well. @type {ReturnType<typeof import('../timeline/timeline.js').bringTimeline> | null} */
  timeline = null;
  /** Shows another run beside this one, or none, under a name. @type {(id: string, other: Other | null) => void} */
  others = () => {};
  /** Runs that stay as references. @type {{pin: () => void, query: () => URLSearchParams, restore: (link: URLSearchParams) => string[]} | null} */
  pins = null;
  /** Undo and redo; it comes after the first plot. @type {{record: (words: string) => void, edit: (path: string, final: boolean) => void} | null} */
  history = null;
  /** True for a run that began without being asked for: the address names its scene only, until somebody acts on it. */
  byItself = false;
  /** Marks the critical gain on its track, once that is there. */
  markGain = () => {};
  /** The newest verdict. @type {Judged | null} */
  judged = null;
  /** The case that the address names and that there is not. @type {string | null} */
  unknown = null;
  /** Begins the game anew that is on, in place of its run. @type {(() => void) | null} */
  game = null;
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
  /** Charts of the bounces; they come after the first picture. @type {ImpactPlot[]} */
  plots = [];
  /** The bounces to come, which may be there before the charts. @type {RunState | null} */
  ahead = null;
  /** Comes with them. @type {import('../charts/eigenvalue-circle.js').Circle | null} */
  circle = null;
  /** True while a change of a value drops the body anew; else the run under way takes it, where it can. */
  anew = true;
  run = new Run();
  view = new SceneView(byId('scene-frame'), byId('scene-readout'), this.run);
  /** Speed, kick, catch and throw; they come after the first picture. @type {{draw: () => void, kick: () => void, blame: (words: string) => void} | null} */
  sliders = null;
  #speed = 1;

  constructor() {
    super();
    this.view.measure(false);
  }

  /** Speed of the run under way, and of those to come, in times real time. */
  get speed() {
    return this.#speed;
  }

  set speed(speed) {
    this.#speed = speed;
    this.sliders?.draw();
  }

  /** Leads to the first value that is wrong. */
  showFault() {
    this.panels?.show('values');
    this.form?.complain();
    this.form?.focusError();
  }

  /** The typed scene as a query; null while some of it is no value. */
  get typedQuery() {
    return this.complete && sceneQuery(this.complete, this.chosen, this.fields);
  }

  /** The scene of the plots: that of the run with its interventions, else the typed one. */
  get playedQuery() {
    const { run, chosen, fields } = this;
    if (!run.released) return this.typedQuery;
    const query = sceneQuery(run.released, chosen, fields);
    for (const [key, value] of run.query) if (key.startsWith('interventions.')) query.set(key, value);
    return query;
  }

  /** The request that answers with the impacts of the plots. */
  get impactsPath() {
    const query = this.playedQuery;
    return query && `v1/trajectories?${query}&bounces=${Math.min(MOST_IMPACTS, this.run.impacts.last?.n ?? 100)}`;
  }

  /** Fields whose typed value the run does not play. */
  get unplayed() {
    const { typed, releasedAs, fields } = this;
    const { asked, released } = this.run;
    if (!typed || !asked) return [];
    // The server has filled in what was left open at the release.
    const open = (/** @type {string} */ path) =>
      [typed, releasedAs].every((scene) => valueAt(scene, path) === undefined) &&
      same(valueAt(asked, path), valueAt(released ?? {}, path));
    return fields.filter((field) => !same(playedAt(typed, field), playedAt(asked, field)) && !open(field.field));
  }

  /** True while the typed scene is its case. */
  get unchanged() {
    const { chosen, typed = {}, fields } = this;
    return chosen !== null && differences(fields, typed, chosen.scene).length === 0;
  }

  /** Adds what the panels show. @param {URLSearchParams} query */
  #withPanels(query) {
    for (const [key, value] of this.panels?.query() ?? this.panelLink) query.set(key, value);
    keepAngles(query);
    return query;
  }

  /** The run with epoch and clock, or the typed scene, and what the panels show; null while there is no such scene. @param {boolean} live true to name the run */
  #query(live) {
    const { run, chosen, fields, speed } = this;
    const named = live ? run.released : null;
    const query = named ? sceneQuery(named, chosen, fields) : this.typedQuery;
    if (!query) return null;
    if (named) {
      // The server spells the scene out; the name of the case says it shorter and for people.
      for (const [key, value] of run.query) if (key !== 'preset' && !key.startsWith('scene.')) query.set(key, value);
    } else if (speed !== 1) query.set('speed', String(speed));
    return this.#withPanels(query);
  }

  updateAddress() {
    const touched = [...this.run.query.keys()].some((key) => /^(interventions|clock)\./.test(key));
    const query = this.#query(!this.byItself || touched);
    if (!query) return;
    history.replaceState(null, '', `?${query}`);
    // The same scene is a rig.
    const scene = this.typedQuery;
    byId('rig', HTMLAnchorElement).href = scene ? `rig?${scene}` : 'rig';
  }

  updateAddressSoon = debounce(150, () => this.updateAddress());

  /** A new entry of the browser's history. @param {URLSearchParams} query of a scene */
  pushAddress(query) {
    history.pushState(null, '', `?${this.#withPanels(query)}`);
  }

  /** The address that replays the run from its release, with all that was done to it. */
  get replayAddress() {
    const query = this.playedQuery;
    if (query && this.speed !== 1) query.set('speed', String(this.speed));
    return whole(query && this.#withPanels(query));
  }

  /** The address that joins the run where it is by now. */
  get liveAddress() {
    return whole(this.#query(true));
  }

  /** Releases the typed scene. @param {Iterable<string[]>} [deeds] what is done to its run, as in its address */
  start(deeds = []) {
    const query = this.typedQuery;
    if (!query) return this.showFault();
    query.set('speed', String(this.speed));
    for (const [key, value] of deeds) query.set(key, value);
    this.releasedAs = this.typed ?? {};
    this.byItself = false;
    clearNotice('run');
    performance.mark('run asked for');
    this.run.start(query);
  }

  /** Runs, pauses or resumes; in the past, plays it or holds it. */
  toggle() {
    const { run } = this;
    if (this.timeline?.toggle()) return;
    if (this.game && run.phase === 'ended') return this.game();
    if (run.phase === 'idle' || run.phase === 'ended') {
      this.history?.record('the release');
      this.start();
    } else if (run.active) run.send({ type: run.clock.paused ? 'resume' : 'pause' });
  }

  /** To the next strike. */
  step() {
    if (this.timeline?.step(1)) return;
    // Only a run that stands still can step.
    if (!this.run.clock.paused) this.run.send({ type: 'pause' });
    this.run.send({ type: 'step' });
  }

  /** From the release again, with what is typed now. */
  restart() {
    const { run } = this;
    if (run.phase === 'idle') return;
    if (this.game) return this.game();
    this.history?.record('the restart');
    this.timeline?.toNow();
    if (!run.active || this.unplayed.length > 0) this.start();
    else run.send({ type: 'restart' });
  }

  /** Does something to the run. @param {string} words that undo names @param {Parameters<Run['send']>[0]} message */
  act(words, message) {
    this.history?.record(words);
    this.timeline?.toNow();
    this.run.send(message);
  }

  /** @param {number} value */
  setSpeed(value) {
    this.speed = value;
    if (this.run.active) this.run.send({ type: 'speed', value });
    else this.updateAddressSoon();
  }

  /** Sends the live parameters that the run does not play yet; some make sense only together. */
  sendChanges = debounce(100, () => {
    const { run, typed } = this;
    if (!typed || !run.active) return;
    // Another kind of control law is no change of a value: it needs a restart.
    const swapped = Boolean(typed.table?.feedback) !== Boolean(run.asked?.table?.feedback);
    const changes = this.unplayed
      .filter(({ live, field }) => live && !(swapped && /^table\.(tilt_gain$|feedback)/.test(field)))
      .map((field) => [field.field, playedAt(typed, field)])
      .filter(([, value]) => value !== undefined);
    if (changes.length > 0) run.send({ type: 'set', ...Object.fromEntries(changes) });
  });
}
