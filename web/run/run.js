// A live run over a WebSocket: what the messages of the server change, how the connection comes back after a loss, and when silence counts as one.

import { Problem, asProblem, get } from '../api/client.js';
import { Holds } from '../physics/table.js';
import { fromColumns, impactOf } from './impacts.js';
import { interventionsOf } from './interventions.js';
import { RunState } from './run-state.js';

/**
 * @typedef {import('contract').LiveHello | import('contract').LiveAck | import('contract').LiveImpact
 *   | import('contract').LiveImpacts | import('contract').LiveHold | import('contract').LiveGap | import('contract').LiveEnd
 *   | import('contract').LiveProblem} ServerMessage
 */

/** The longest time between two tries to come back, s. */
const LONGEST_WAIT_S = 15;
/** Close code of a server that has too much to do just now. */
const TRY_AGAIN_LATER = 1013;
const UPGRADE_REQUIRED = 426;
/** An impact may be this late, in wall time, before a connection that says nothing counts as lost. */
const OVERDUE_S = 5;
/** Time for which a run goes on in contact after its bounces, s, where its address names no other. */
const HOLD_S = 6;

export class Run extends RunState {
  /** @type {Connection | null} */
  #connection = null;
  /** The kind of the message sent last: a problem that comes back is about it. */
  sent = '';

  /** True when that was a catch or a throw. */
  get guided() {
    return this.sent === 'catch' || this.sent === 'throw';
  }

  /** @param {URLSearchParams} query @param {boolean} [whole] a run that is already under way is shown from its first impact */
  start(query, whole = true) {
    this.stop();
    this.query = new URLSearchParams(query);
    this.query.delete('from');
    this.clear();
    this.sent = '';
    this.become('connecting');
    this.#connection = new Connection(this, whole, (problem) => {
      // The server may refuse to tell the whole past of a run, and still tell its present.
      if (whole && query.has('epoch_ms')) return this.start(this.query, false);
      this.stop();
      this.tell('refused', problem);
    });
  }

  stop() {
    this.#connection?.close();
    this.#connection = null;
    this.become('idle');
  }

  /** Ends the run and forgets it. */
  reset() {
    this.stop();
    this.clear();
  }

  retry() {
    this.#connection?.retry();
  }

  /** Sends a message to the run, where there is a connection. @param {{type: string} & Record<string, unknown>} message */
  send(message) {
    this.sent = message.type;
    this.#connection?.send(message);
  }
}

class Connection {
  #run;
  #whole;
  #refused;
  #epoch_ms = 0;
  /** @type {WebSocket | null} */
  #socket = null;
  #greeted = false;
  #closed = false;
  /** Tries since the server has greeted, and how often in a row it has answered a plain request after its WebSocket had failed. */
  #failures = 0;
  #barred = 0;
  /** The next try, by the clock of this machine. */
  #due_ms = 0;
  /** @type {number | undefined} */
  #countdown;
  /** @type {number | undefined} */
  #overdue;

  /** @param {Run} run with its query @param {boolean} whole true when it is shown from its first impact @param {(problem: Problem) => void} refused for good */
  constructor(run, whole, refused) {
    this.#run = run;
    this.#whole = whole;
    this.#refused = refused;
    this.#open(run.query.has('epoch_ms') && whole ? 1 : null);
  }

  /** @param {number | null} from the first impact that is told; null for those to come */
  #open(from) {
    const query = new URLSearchParams(this.#run.query);
    if (!query.has('hold')) query.set('hold', String(HOLD_S));
    if (from !== null) query.set('from', String(from));
    const url = `v1/live?${query}`;
    const socket = new WebSocket(new URL(url, document.baseURI.replace(/^http/, 'ws')), 'equipoise.v1');
    this.#socket = socket;
    this.#greeted = false;
    /** @type {Problem | null} */
    let problem = null;
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      if (message.type === 'hello') {
        this.#greeted = true;
        this.#failures = 0;
        this.#barred = 0;
      } else if (message.type === 'problem' && !this.#greeted) {
        problem = asProblem(message, 422);
        return;
      }
      this.#hear(message);
    };
    const isOld = () => this.#closed || this.#socket !== socket;
    socket.onclose = async ({ code }) => {
      if (isOld()) return;
      if (code === TRY_AGAIN_LATER) problem = null;
      else if (!this.#greeted) problem ??= await this.#refusal(url);
      if (isOld()) return;
      if (problem) this.#refused(problem);
      else this.#wait();
    };
  }

  /**
   * A browser hides why a handshake was refused; the same request without the handshake tells it.
   * @param {string} url
   * @returns {Promise<Problem | null>} null when the server is not there, or wants nothing but the handshake
   */
  async #refusal(url) {
    try {
      await get(url);
    } catch (error) {
      if (!(error instanceof Problem) || error.status >= 500) {
        this.#barred = 0;
        return null;
      }
      if (error.status !== UPGRADE_REQUIRED) return error;
      // Once or twice says little: the server may have come back between the two requests.
      this.#barred += 1;
      const words = 'The server answers, but no WebSocket gets through to it; a proxy on the way may not pass one on.';
      if (this.#barred > 2) return new Problem('No live connection', words, [], error.status);
    }
    return null;
  }

  #wait() {
    this.#due_ms = performance.now() + 1000 * Math.min(LONGEST_WAIT_S, 2 ** this.#failures);
    this.#failures += 1;
    this.#count();
  }

  #count() {
    clearTimeout(this.#countdown);
    const left_ms = this.#due_ms - performance.now();
    if (left_ms <= 0) return this.retry();
    this.#lost(Math.ceil(left_ms / 1000));
    this.#countdown = setTimeout(() => this.#count(), left_ms % 1000 || 1000);
  }

  /** @param {number} seconds to the next try; 0 while it is being made */
  #lost(seconds) {
    this.#run.become('lost');
    this.#run.tell('lost', seconds);
  }

  /** Now instead of at the end of the countdown: goes on after the newest impact. */
  retry() {
    if (this.#closed) return;
    clearTimeout(this.#countdown);
    this.#lost(0);
    const { last } = this.#run.impacts;
    this.#open(last || this.#whole ? (last?.n ?? 0) + 1 : null);
  }

  /** Sends a message while there is a connection. @param {Record<string, unknown>} message */
  send(message) {
    if (this.#greeted && this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  close() {
    this.#closed = true;
    clearTimeout(this.#overdue);
    clearTimeout(this.#countdown);
    const socket = this.#socket;
    const end = () => socket?.close(1000);
    // A browser reports a socket closed before it is open as an error.
    if (socket?.readyState === WebSocket.CONNECTING) socket.onopen = end;
    else end();
  }

  /** @param {ServerMessage} message */
  #hear(message) {
    const run = this.#run;
    switch (message.type) {
      case 'hello': {
        const { release, flight_time } = message;
        if (this.#epoch_ms && message.epoch_ms !== this.#epoch_ms) run.clear();
        this.#epoch_ms = message.epoch_ms;
        run.released = { ...message.scene, derived: message.derived };
        run.nextStrike = message.first_strike;
        run.fall = {
          ...release,
          theta_dot: release.theta_dot ?? 0,
          theta: release.theta ?? 0,
          duration: flight_time ?? 0,
        };
        run.clock.forget();
        this.#read(message);
        break;
      }
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
        run.tell('changed');
        break;
      case 'gap':
        run.impacts.missing += message.to - message.from + 1;
        break;
      case 'end': {
        const { outcome, hold_end: contact } = message;
        const detail = `${outcome.detail}; then ${contact?.detail}`;
        run.outcome = contact ? { ...outcome, contact, t: contact.t, detail } : outcome;
        this.close();
        run.become('ended');
        break;
      }
      case 'problem':
        run.tell('problem', { title: message.title, detail: message.detail ?? '', errors: message.errors ?? [] });
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

  /** @param {Impact[]} fresh @param {NextStrike | null} next */
  #take(fresh, next) {
    const run = this.#run;
    const changes = run.interventions.filter(({ set }) => Object.keys(set).length > 0);
    const known = run.impacts.last?.n ?? 0;
    run.nextStrike = next;
    for (const one of fresh) {
      if (one.n <= known) continue;
      one.series = changes.filter(({ impact }) => impact <= one.n).length;
      run.impacts.append(one);
    }
    if (run.interventions.length > 0) run.rebuild();
    this.#expect();
    run.tell('struck');
  }

  /** Waits for the next impact: a connection that is silent for too long after it is given up, and may not even close. */
  #expect() {
    clearTimeout(this.#overdue);
    const run = this.#run;
    if (run.phase !== 'running') return;
    const arc = run.arcAt(Infinity);
    const next = Math.max(arc ? arc.t + arc.duration : 0, run.holds?.until ?? 0);
    const wait_s = Math.max(0, next - run.clock.runTime()) / run.clock.speed;
    const drop = () => {
      if (run.phase !== 'running') return;
      const socket = this.#socket;
      this.#socket = null;
      socket?.close();
      this.#wait();
    };
    this.#overdue = setTimeout(drop, (wait_s + OVERDUE_S) * 1000);
  }
}
