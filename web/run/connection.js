// The connection of a run: what its messages change, how it is resumed after a loss, and when silence counts as one.

import { fromColumns, impactOf } from './impact-messages.js';
import { Holds } from '../physics/holds.js';
import { interventionsOf } from './interventions.js';
import { LiveStream } from './live-stream.js';

/** @typedef {import('./run-state.js').RunState} RunState */
/** @typedef {import('./impacts.js').Impact} Impact */
/**
 * @typedef {import('contract').LiveHello | import('contract').LiveAck | import('contract').LiveImpact
 *   | import('contract').LiveImpacts | import('contract').LiveHold | import('contract').LiveGap | import('contract').LiveEnd
 *   | import('contract').LiveProblem} ServerMessage
 */

/** An impact may be this late, in wall time, before a connection that says nothing counts as lost. */
const OVERDUE_S = 5;
/** Time for which a run goes on in contact after its bounces, s, where its address names no other. */
const HOLD_S = 6;

/** A query of the page as one of the live run. @param {URLSearchParams} query */
function liveQuery(query) {
  const live = new URLSearchParams(query);
  if (!live.has('hold')) live.set('hold', String(HOLD_S));
  return live;
}

/** The outcome of a run, with its end in contact if it has one. @param {import('contract').LiveEnd} end */
const endOf = ({ outcome, hold_end: contact }) =>
  contact ? { ...outcome, contact, t: contact.t, detail: `${outcome.detail}; then ${contact.detail}` } : outcome;

export class Connection {
  #run;
  /** True when the run is shown from its first impact. */
  #whole;
  #epoch_ms = 0;
  /** @type {LiveStream | null} */
  #stream;
  /** @type {number | undefined} */
  #overdue;

  /**
   * @param {RunState} run with its query
   * @param {boolean} whole
   * @param {(problem: import('../api/client.js').Problem) => void} refused for good
   */
  constructor(run, whole, refused) {
    this.#run = run;
    this.#whole = whole;
    const first = liveQuery(run.query);
    if (first.has('epoch_ms') && whole) first.set('from', '1');
    this.#stream = new LiveStream(`v1/live?${first}`, () => this.#resumption(), {
      message: (message) => this.#hear(message),
      lost: (seconds) => {
        run.become('lost');
        run.watcher.lost(seconds);
      },
      refused,
    });
  }

  #resumption() {
    const { impacts, query: replay } = this.#run;
    const query = liveQuery(replay);
    if (impacts.last || this.#whole) query.set('from', String((impacts.last?.n ?? 0) + 1));
    return `v1/live?${query}`;
  }

  retry() {
    this.#stream?.retry();
  }

  /** @param {Record<string, unknown>} message */
  send(message) {
    this.#stream?.send(message);
  }

  close() {
    clearTimeout(this.#overdue);
    this.#stream?.close();
    this.#stream = null;
  }

  /** @param {ServerMessage} message */
  #hear(message) {
    const run = this.#run;
    switch (message.type) {
      case 'hello':
        if (this.#epoch_ms && message.epoch_ms !== this.#epoch_ms) run.clear();
        this.#epoch_ms = message.epoch_ms;
        run.released = { ...message.scene, derived: message.derived };
        run.nextStrike = message.first_strike;
        run.fall = {
          ...message.release,
          theta_dot: message.release.theta_dot ?? 0,
          theta: message.release.theta ?? 0,
          duration: message.flight_time ?? 0,
        };
        run.clock.forget();
        this.#read(message);
        run.watcher.lost(NaN);
        break;
      case 'ack':
        run.nextStrike = message.next_strike;
        this.#read(message);
        break;
      case 'impact':
        this.#take([impactOf(message)], message.next_strike);
        break;
      case 'impacts':
        this.#take(fromColumns(message.columns), message.next_strike);
        break;
      case 'hold':
        run.holds ??= new Holds();
        run.holds.append(message.columns);
        this.#expect();
        run.watcher.changed();
        break;
      case 'gap':
        run.impacts.missing += message.to - message.from + 1;
        break;
      case 'end':
        run.outcome = endOf(message);
        this.close();
        run.become('ended');
        break;
      case 'problem':
        run.watcher.problem({ title: message.title, detail: message.detail ?? '', errors: message.errors ?? [] });
    }
  }

  /** @param {import('contract').LiveHello | import('contract').LiveAck} message */
  #read(message) {
    const run = this.#run;
    run.clock.read(message);
    run.query = new URLSearchParams(message.url.split('?')[1] ?? '');
    run.query.delete('from');
    if (Number(run.query.get('hold')) === HOLD_S) run.query.delete('hold');
    run.interventions = interventionsOf(run.query);
    run.rebuild();
    if (!run.outcome) run.become(message.paused ? 'paused' : 'running');
    this.#expect();
  }

  /** @param {Impact[]} fresh @param {import('contract').LiveNextStrike | null} next */
  #take(fresh, next) {
    const run = this.#run;
    run.nextStrike = next;
    const known = run.impacts.last?.n ?? 0;
    for (const impact of fresh) {
      if (impact.n <= known) continue;
      impact.series = run.interventions.filter(
        (one) => one.impact <= impact.n && Object.keys(one.set).length > 0,
      ).length;
      run.impacts.append(impact);
    }
    if (run.interventions.length > 0) run.rebuild();
    this.#expect();
    run.watcher.struck();
  }

  /** Waits for the next impact: a connection that is silent for too long after it is dropped. */
  #expect() {
    clearTimeout(this.#overdue);
    const run = this.#run;
    if (run.phase !== 'running') return;
    const arc = run.arcAt(Infinity);
    const next = Math.max(arc ? arc.t + arc.duration : 0, run.holds?.until ?? 0);
    const wait_s = Math.max(0, next - run.clock.runTime()) / run.clock.speed;
    this.#overdue = setTimeout(
      () => {
        if (run.phase === 'running') this.#stream?.drop();
      },
      (wait_s + OVERDUE_S) * 1000,
    );
  }
}
