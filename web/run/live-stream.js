// One live stream over a WebSocket that comes back by itself. Knows messages and retries, not what a run or the page makes of them.

import { Problem, asProblem, get } from '../api/client.js';

/**
 * @typedef {object} Listener
 * @property {(message: any) => void} message
 * @property {(seconds: number) => void} lost the seconds until the next try; 0 while it is being made
 * @property {(problem: Problem) => void} refused for good
 */

const LONGEST_WAIT_S = 15;
// Close code of a server that has too much to do just now.
const TRY_AGAIN_LATER = 1013;
const UPGRADE_REQUIRED = 426;

export class LiveStream {
  /** @type {WebSocket | null} */
  #socket = null;
  #listener;
  #resumeUrl;
  #failures = 0;
  /** Counts how often in a row the server has answered a plain request after its WebSocket had failed. */
  #barred = 0;
  #greeted = false;
  #closed = false;
  /** @type {number | undefined} */
  #timer;
  #due_ms = 0;

  /**
   * @param {string} url path and query
   * @param {() => string} resumeUrl where to go on after a loss
   * @param {Listener} listener
   */
  constructor(url, resumeUrl, listener) {
    this.#listener = listener;
    this.#resumeUrl = resumeUrl;
    this.#open(url);
  }

  /** @param {string} url */
  #open(url) {
    this.#greeted = false;
    const socket = new WebSocket(new URL(url, document.baseURI.replace(/^http/, 'ws')), 'equipoise.v1');
    this.#socket = socket;
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
      this.#listener.message(message);
    };
    socket.onclose = async ({ code }) => {
      if (this.#closed || this.#socket !== socket) return;
      if (code === TRY_AGAIN_LATER) problem = null;
      else if (!this.#greeted) problem ??= await this.#refusal(url);
      if (this.#closed || this.#socket !== socket) return;
      if (problem) return this.#listener.refused(problem);
      this.#wait();
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
      if (this.#barred > 2)
        return new Problem(
          'No live connection',
          'The server answers, but no WebSocket gets through to it; a proxy on the way may not pass one on.',
          [],
          error.status,
        );
    }
    return null;
  }

  #wait() {
    const wait_s = Math.min(LONGEST_WAIT_S, 2 ** this.#failures);
    this.#failures += 1;
    this.#due_ms = performance.now() + wait_s * 1000;
    this.#count();
  }

  #count() {
    clearTimeout(this.#timer);
    const left_ms = this.#due_ms - performance.now();
    if (left_ms <= 0) return this.retry();
    this.#listener.lost(Math.ceil(left_ms / 1000));
    this.#timer = setTimeout(() => this.#count(), left_ms % 1000 || 1000);
  }

  /** Now instead of at the end of the countdown. */
  retry() {
    clearTimeout(this.#timer);
    this.#listener.lost(0);
    this.#open(this.#resumeUrl());
  }

  /** Gives up on a connection that has gone quiet without closing. */
  drop() {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
    this.#wait();
  }

  /** @param {Record<string, unknown>} message @returns {boolean} false when there is no connection to send on */
  send(message) {
    if (!this.#greeted || this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  close() {
    this.#closed = true;
    clearTimeout(this.#timer);
    const socket = this.#socket;
    const end = () => socket?.close(1000);
    // A browser reports a socket closed before it is open as an error.
    if (socket?.readyState === WebSocket.CONNECTING) socket.onopen = end;
    else end();
  }
}
