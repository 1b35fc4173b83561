// The state of a live run as this page knows it: its impacts, its clock, its scene and what was done to it.

import { setAt } from '../api/scene-fields.js';
import { arcAfter, poseOn } from '../physics/flight.js';
import { Impacts } from './impacts.js';

/** @typedef {'idle' | 'connecting' | 'running' | 'paused' | 'lost' | 'ended'} Phase */

/** The parts of hello and of every ack that a clock needs. @typedef {{now_ms: number, run_time: number, speed: number, paused: boolean}} Reading */

/** The server's time and the run's time on this machine, whose own clock may be wrong. */
class Clock {
  // Server time less local time, in ms. A message is late by its way, so the largest difference seen is nearest to the truth.
  #offset_ms = -Infinity;
  /** @type {Reading} */
  #anchor = { now_ms: 0, run_time: 0, speed: 1, paused: true };

  static #local() {
    return performance.timeOrigin + performance.now();
  }

  /** A new connection measures anew: the machine may have slept. */
  forget() {
    this.#offset_ms = -Infinity;
  }

  /** @param {Reading} reading */
  read({ now_ms, run_time, speed, paused }) {
    this.#offset_ms = Math.max(this.#offset_ms, now_ms - Clock.#local());
    this.#anchor = { now_ms, run_time, speed, paused };
  }

  get speed() {
    return this.#anchor.speed;
  }

  get paused() {
    return this.#anchor.paused;
  }

  /** Seconds since the release, in the run's own time. */
  runTime() {
    const { now_ms, run_time, speed, paused } = this.#anchor;
    if (paused || this.#offset_ms === -Infinity) return run_time;
    return run_time + (Math.max(0, Clock.#local() + this.#offset_ms - now_ms) / 1000) * speed;
  }
}

export class RunState {
  impacts;
  clock = new Clock();
  /** @type {Phase} */
  phase = 'idle';
  /** The scene of the next strike. @type {Scene | null} */
  scene = null;
  /** The scene at the release. @type {Scene | null} */
  released = null;
  /** The flight from the release to the first impact. @type {Arc | null} */
  fall = null;
  /** The strike after the newest impact, as the server foresees it. @type {NextStrike | null} */
  nextStrike = null;
  /** @type {Outcome | null} */
  outcome = null;
  /** @type {Intervention[]} */
  interventions = [];
  /** The query that replays this run. */
  query = new URLSearchParams();
  /** The time in which the table holds the body; null before a run is caught. @type {import('../physics/table.js').Holds | null} */
  holds = null;
  /** The time that the reader looks at; null while it is the present. @type {number | null} */
  past = null;
  /** Pace at which the past is played, in times real time; 0 while it stands still. */
  replayed = 0;
  /** @type {Watcher[]} */
  #watchers = [];

  /** @param {number} [kept] most impacts that are kept */
  constructor(kept) {
    this.impacts = new Impacts(kept);
  }

  /** Tells one more of news, after those who came before. @param {Watcher} watcher */
  watch(watcher) {
    this.#watchers.push(watcher);
  }

  /** @template {keyof Watcher} N @param {N} news @param {Parameters<Required<Watcher>[N]>} details */
  tell(news, ...details) {
    for (const watcher of this.#watchers) /** @type {any} */ (watcher)[news]?.(...details);
  }

  clear() {
    this.past = null;
    this.replayed = 0;
    this.impacts.clear();
    this.outcome = null;
    this.interventions = [];
    this.scene = null;
    this.released = null;
    this.fall = null;
    this.nextStrike = null;
    this.holds = null;
    this.tell('cleared');
  }

  /** @param {Phase} phase */
  become(phase) {
    this.phase = phase;
    this.tell('changed');
  }

  /** The phase in words; empty where there is no run. */
  get words() {
    return {
      idle: '',
      connecting: 'Connecting…',
      running: 'Running',
      paused: 'Paused',
      lost: 'Connection lost',
      ended: `Ended: ${(this.fate === 'kept' ? this.outcome : this.#end)?.kind.replaceAll('_', ' ')}`,
    }[this.phase];
  }

  /** The end in contact after the bounces, else that of the bounces. */
  get #end() {
    return this.outcome?.contact ?? this.outcome;
  }

  /** The state of the body at the end: at rest on the table, fallen, or neither; null before the end. @returns {'kept' | 'fell' | 'over' | null} */
  get fate() {
    if (this.phase !== 'ended' || !this.#end) return null;
    const { kind } = this.#end;
    if (kind === 'held' || kind === 'rests_on_edge' || (this.outcome?.contact && kind === 'completed')) return 'kept';
    return ['completed', 'settled', 'diverged', 'too_long'].includes(kind) ? 'over' : 'fell';
  }

  /** True while there is a run to act on. */
  get active() {
    return this.phase === 'running' || this.phase === 'paused';
  }

  /** The newest time of the run, s since its release. */
  get present() {
    return this.phase === 'ended' ? (this.outcome?.t ?? Infinity) : this.clock.runTime();
  }

  /** The time to draw. */
  get shown() {
    return this.past ?? this.present;
  }

  /** Pace of the time to draw, in times real time; 0 while it stands still. */
  get pace() {
    if (this.past !== null) return this.replayed;
    return this.phase === 'running' ? this.clock.speed : 0;
  }

  /** The past as it is shown; null in the present. @returns {'plays' | 'stands' | null} */
  get replay() {
    if (this.past === null) return null;
    return this.replayed > 0 ? 'plays' : 'stands';
  }

  /** Brings the scene up to date with impacts and interventions. */
  rebuild() {
    this.scene = this.#sceneAt((this.impacts.last?.n ?? 0) + 1);
    if (this.scene && this.nextStrike) this.scene.derived.target = this.nextStrike.target;
  }

  /** The scene in force at an impact, or null before the server has greeted. @param {number} n */
  #sceneAt(n) {
    if (!this.released) return null;
    const scene = structuredClone(this.released);
    for (const { impact, set } of this.interventions) {
      if (impact <= n) for (const [path, value] of Object.entries(set)) setAt(scene, path, value);
    }
    return scene;
  }

  /** The scene with all interventions, also those that wait for their impact. */
  get asked() {
    return this.#sceneAt(Infinity);
  }

  /** The scene of the first strike after `t`. @param {number} t */
  sceneAfter(t) {
    const place = this.placeAt(t);
    if (this.interventions.length === 0 || place === this.impacts.end - 1) return this.scene;
    return this.#sceneAt(place === null ? 1 : this.impacts.at('n', place) + 1);
  }

  /** The place of the last impact not after `t`, or null before the first. @param {number} t */
  placeAt(t) {
    const place = this.impacts.lastUpTo('t', t);
    return place < this.impacts.begin ? null : place;
  }

  /** The flight at `t`. @param {number} t */
  arcAt(t) {
    const place = this.placeAt(t);
    if (!this.scene) return null;
    return place === null ? this.fall : arcAfter(this.impacts.row(place), this.scene);
  }

  /** The place of the body at `t`, or null before the server has greeted. @param {number} t */
  poseAt(t) {
    const arc = this.arcAt(t);
    return arc && this.scene && poseOn(arc, t, this.scene);
  }
}
