// A live run as this page knows it: its impacts, its clock, what was done to it. Not for the screen.

import { Clock } from './clock.js';
import { Impacts } from './impacts.js';
import { fromColumns, fromMessage } from './impact-messages.js';
import { Live } from './live-stream.js';
import { arcAfter, strikeAfter } from '../physics/flight.js';
import { interventionsOf } from '../app/link.js';
import { setAt } from '../api/scene-fields.js';

/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('./impacts.js').Impact} Impact */
/**
 * @typedef {import('contract').LiveHello | import('contract').LiveAck | import('contract').LiveImpact | import('contract').LiveImpacts
 *   | import('contract').LiveGap | import('contract').LiveEnd | import('contract').LiveProblem} ServerMessage
 */
/** @typedef {'idle' | 'connecting' | 'running' | 'paused' | 'lost' | 'ended'} Phase */

// How late an impact may be, in wall time, before a connection that says nothing counts as lost.
const OVERDUE_S = 5;

/**
 * @typedef {object} Watcher
 * @property {() => void} changed phase, scene, speed or address
 * @property {() => void} struck there are new impacts
 * @property {() => void} cleared a new run: all that was drawn is void
 * @property {(seconds: number) => void} lost
 * @property {(problem: import('../api/client.js').Problem) => void} refused
 * @property {(message: {title: string, detail: string, errors: import('contract').ProblemError[]}) => void} problem with one message
 */

export class Run {
  impacts = new Impacts();
  clock = new Clock();
  /** @type {Phase} */
  phase = 'idle';
  /** What the next strike will be played with. @type {Scene | null} */
  scene = null;
  /** @type {import('contract').Outcome | null} */
  outcome = null;
  /** @type {import('../app/link.js').Intervention[]} */
  interventions = [];
  /** The query that replays this run. */
  query = new URLSearchParams();
  build = '';

  /** @type {Live | null} */
  #live = null;
  #watcher;
  /** Whether it is shown from its first impact. */
  #whole = true;
  #epoch = 0;
  /** What it was released with. @type {Scene | null} */
  released = null;
  /** @type {import('../physics/flight.js').Arc | null} */
  #fall = null;
  /** @type {number | undefined} */
  #overdue;

  /** @param {Watcher} watcher */
  constructor(watcher) {
    this.#watcher = watcher;
  }

  /**
   * @param {URLSearchParams} query
   * @param {boolean} [whole] a run that is already under way is shown from its first impact
   */
  start(query, whole = true) {
    this.stop();
    this.query = new URLSearchParams(query);
    this.query.delete('from');
    this.#clear();
    const first = new URLSearchParams(this.query);
    this.#whole = whole;
    const joins = first.has('epoch') && whole;
    if (joins) first.set('from', '1');
    this.#become('connecting');
    this.#live = new Live(`v1/live?${first}`, () => this.#resumption(), {
      message: (message) => this.#hear(message),
      lost: (seconds) => {
        this.#become('lost');
        this.#watcher.lost(seconds);
      },
      refused: (problem) => {
        // Its whole past may be too much for the server to tell, where its present is not.
        if (joins) return this.start(query, false);
        this.stop();
        this.#watcher.refused(problem);
      },
    });
  }

  #resumption() {
    const query = new URLSearchParams(this.query);
    if (this.impacts.last || this.#whole) query.set('from', String((this.impacts.last?.n ?? 0) + 1));
    return `v1/live?${query}`;
  }

  stop() {
    clearTimeout(this.#overdue);
    this.#live?.close();
    this.#live = null;
    this.#become('idle');
  }

  /** No run, and nothing of the one before. */
  reset() {
    this.stop();
    this.#clear();
  }

  retry() {
    this.#live?.retry();
  }

  #clear() {
    this.impacts.clear();
    this.outcome = null;
    this.interventions = [];
    this.scene = null;
    this.released = null;
    this.#epoch = 0;
    this.#fall = null;
    this.#watcher.cleared();
  }

  /** @param {Phase} phase */
  #become(phase) {
    this.phase = phase;
    this.#watcher.changed();
  }

  /** How it is going, in words; nothing where there is none. */
  get words() {
    return {
      idle: '',
      connecting: 'Connecting…',
      running: 'Running',
      paused: 'Paused',
      lost: 'Connection lost',
      ended: `Ended: ${this.outcome?.kind.replaceAll('_', ' ')}`,
    }[this.phase];
  }

  /** True while there is a run to act on. */
  get active() {
    return this.phase === 'running' || this.phase === 'paused';
  }

  toggle() {
    return this.#live?.send({ type: this.clock.paused ? 'resume' : 'pause' }) ?? false;
  }

  /** A step is a step of a run that stands still. */
  step() {
    if (!this.clock.paused) this.#live?.send({ type: 'pause' });
    return this.#live?.send({ type: 'step' }) ?? false;
  }

  /** @param {number} value */
  setSpeed(value) {
    return this.#live?.send({ type: 'speed', value }) ?? false;
  }

  /** @param {Record<string, unknown>} values by field path */
  set(values) {
    return this.#live?.send({ type: 'set', ...values }) ?? false;
  }

  /** @param {Record<string, number>} velocities */
  kick(velocities) {
    return this.#live?.send({ type: 'kick', ...velocities }) ?? false;
  }

  restart() {
    return this.#live?.send({ type: 'restart' }) ?? false;
  }

  /** @param {ServerMessage} message */
  #hear(message) {
    switch (message.type) {
      case 'hello':
        if (this.#epoch && message.epoch !== this.#epoch) this.#clear();
        this.#epoch = message.epoch;
        this.released = message.scene;
        this.build = message.build ?? '';
        this.#fall = {
          ...message.release,
          theta_dot: message.release.theta_dot ?? 0,
          theta: message.release.theta ?? 0,
          duration: message.flight_time ?? 0,
        };
        this.clock.forget();
        this.#read(message);
        this.#watcher.lost(NaN);
        break;
      case 'ack':
        this.#read(message);
        break;
      case 'impact':
        this.#take([fromMessage(message)]);
        break;
      case 'impacts':
        this.#take(fromColumns(message.columns));
        break;
      case 'gap':
        this.impacts.missing += message.to - message.from + 1;
        break;
      case 'end':
        this.outcome = message.outcome;
        clearTimeout(this.#overdue);
        // There is nothing more to hear.
        this.#live?.close();
        this.#live = null;
        this.#become('ended');
        break;
      case 'problem':
        this.#watcher.problem({ title: message.title, detail: message.detail ?? '', errors: message.errors ?? [] });
    }
  }

  /** @param {import('contract').LiveHello | import('contract').LiveAck} message */
  #read(message) {
    this.clock.read(message);
    this.query = new URLSearchParams(message.url.split('?')[1] ?? '');
    this.query.delete('from');
    this.interventions = interventionsOf(this.query);
    this.#rebuild();
    if (!this.outcome) this.#become(message.paused ? 'paused' : 'running');
    this.#expect();
  }

  #rebuild() {
    this.scene = this.#sceneAt((this.impacts.last?.n ?? 0) + 1);
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

  /** The scene with all that was set, waiting for its impact or not. */
  get asked() {
    return this.#sceneAt(Infinity);
  }

  /** @param {Impact[]} fresh */
  #take(fresh) {
    const known = this.impacts.last?.n ?? 0;
    for (const impact of fresh) {
      if (impact.n <= known) continue;
      impact.series = this.interventions.filter(
        (one) => one.impact <= impact.n && Object.keys(one.set).length > 0,
      ).length;
      this.impacts.append(impact);
    }
    if (this.interventions.length > 0) this.#rebuild();
    this.#expect();
    this.#watcher.struck();
  }

  #expect() {
    clearTimeout(this.#overdue);
    if (this.phase !== 'running') return;
    const arc = this.arcAt(Infinity);
    const wait_s = arc ? Math.max(0, arc.t + arc.duration - this.clock.runTime()) / this.clock.speed : 0;
    this.#overdue = setTimeout(
      () => {
        if (this.phase === 'running') this.#live?.drop();
      },
      (wait_s + OVERDUE_S) * 1000,
    );
  }

  /** The place of the last impact not after `t`, or null before the first. @param {number} t */
  placeAt(t) {
    const { impacts } = this;
    for (let place = impacts.end - 1; place >= impacts.begin; place -= 1) if (impacts.at('t', place) <= t) return place;
    return null;
  }

  /** The flight the rod is on at `t`. @param {number} t */
  arcAt(t) {
    const place = this.placeAt(t);
    if (!this.scene) return null;
    return place === null ? this.#fall : arcAfter(this.impacts.row(place), this.scene);
  }

  /** The next strike to come, when there is one. @param {import('../physics/flight.js').Arc} arc */
  nextStrike(arc) {
    return this.scene && arc.duration > 0 ? strikeAfter(arc, this.scene) : null;
  }
}
