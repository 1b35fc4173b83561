// Requests to the server: JSON answers, and refusals as errors. Live streams are in run/run.js.

/** The most impacts of one run that the server computes for a request. */
export const MOST_IMPACTS = 100_000;

/** A refusal by the server, with the fields it blames. */
export class Problem extends Error {
  /** @param {string} title @param {string} detail @param {ProblemError[]} errors @param {number} status */
  constructor(title, detail, errors, status) {
    super(detail || title);
    this.title = title;
    this.errors = errors;
    this.status = status;
  }
}

/** A failed request in words: the server's own, or that it does not answer. @param {unknown} error */
export function wordsOf(error) {
  if (!(error instanceof Problem)) return 'The server does not answer.';
  return error.errors.map(({ detail }) => detail).join(' ') || error.message;
}

/** The build that answered last. */
export const server = { build: '' };

/** A response that is a success. @param {string} path @param {RequestInit} request */
export async function asked(path, request) {
  const response = await fetch(path, request);
  server.build = response.headers.get('equipoise-build') ?? server.build;
  if (response.ok) return response;
  const body = await response.json().catch(() => ({}));
  throw asProblem(body, response.status, response.statusText);
}

/** @param {string} path @param {AbortSignal} [signal] @returns {Promise<any>} */
export const get = async (path, signal) =>
  (await asked(path, { signal, headers: { accept: 'application/json' } })).json();

/** A problem, as the server writes it, as an error. @param {any} body @param {number} status @param {string} [title] if it has none */
export const asProblem = (body, status, title = '') =>
  new Problem(body.title ?? title, body.detail ?? '', body.errors ?? [], status);
