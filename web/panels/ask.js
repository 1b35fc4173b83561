// Answers of the server that follow the page: one question at a time, and the newest next.

import { Problem, get, wordsOf } from '../api/client.js';
import { Follower } from '../api/latest-request.js';
import { html, useEffect, useMemo, useState } from '../vendor/preact/preact.js';
import { words } from './parts.js';

/** Time after which a server that did not answer is asked again, ms. */
const AGAIN_MS = 3000;

/**
 * @template A
 * @typedef {object} Answer
 * @property {A | null} answer the newest; null before the first
 * @property {string | null} of the path that it answers
 * @property {boolean} current it answers what is asked now
 * @property {Problem | null} problem of what is asked now
 * @property {string} lost words on a server that does not answer; '' for one that does
 */

/** @typedef {{answer: any, of: string | null, problem: Problem | null, lost: string}} State */

/** @param {(change: (before: State) => State) => void} set @param {number} quiet_ms @param {(path: string) => Promise<any>} ask */
function follower(set, quiet_ms, ask) {
  /** @type {string | null} */
  let wanted = null;
  let since = '';
  let timer = 0;
  /** @type {Follower<string>} */
  const asks = new Follower(async (path) => {
    try {
      const answer = await ask(path);
      since = '';
      set(() => ({ answer, of: path, problem: null, lost: '' }));
    } catch (error) {
      const problem = error instanceof Problem ? error : null;
      since = problem ? '' : since || new Date().toLocaleTimeString();
      const lost = `${wordsOf(error)} It has not since ${since}, and is asked again every ${AGAIN_MS / 1000} s.`;
      set((before) => (problem ? { ...before, of: path, problem, lost: '' } : { ...before, lost }));
      if (since && path === wanted) timer = setTimeout(() => asks.want(path), AGAIN_MS);
    }
  }, 0);
  return (/** @type {string | null} */ path) => {
    wanted = path;
    clearTimeout(timer);
    if (path !== null) timer = setTimeout(() => asks.want(path), quiet_ms);
  };
}

/**
 * The answer to a path, which may change at every frame.
 * @param {string | null} path null while there is nothing to ask
 * @param {number} [quiet_ms] time without a change before it is asked
 * @param {(path: string) => Promise<any>} [ask]
 * @returns {Answer<any>}
 */
export function useAnswer(path, quiet_ms = 0, ask = get) {
  const [state, set] = useState(/** @type {State} */ ({ answer: null, of: null, problem: null, lost: '' }));
  const follow = useMemo(() => follower(set, quiet_ms, ask), []);
  useEffect(() => follow(path), [path]);
  useEffect(() => () => follow(null), []);
  const current = path !== null && state.of === path && state.lost === '' && state.problem === null;
  return { ...state, current, problem: state.of === path ? state.problem : null };
}

/**
 * An answer, dimmed while another one is asked for; in its place a refusal, or that the server is lost.
 * @param {{asked: Answer<any>, id?: string, children: (answer: any) => unknown}} props
 */
export const Answered = ({ asked: { answer, current, problem, lost }, id, children }) =>
  html`${lost && html`<p role="status">${lost}</p>`}
    ${problem && html`<p role="status">${words(wordsOf(problem))}</p>`}
    ${answer && !lost && !problem && html`<div class=${current ? 'answered' : 'answered stale'} id=${id}>${children(answer)}</div>`}`;
