// Requests to the server: JSON answers, and refusals as errors. Live streams are in run/connection.js.

/** The most impacts of one run that the server computes for a request. */
export const MOST_IMPACTS = 100_000;

/** A refusal by the server, with the fields it blames. */
export class Problem extends Error {
  /**
   * @param {string} title
   * @param {string} detail
   * @param {import('contract').ProblemError[]} errors
   * @param {number} status
   */
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

/**
 * @param {string} path
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export async function get(path, signal) {
  const response = await fetch(path, { signal, headers: { accept: 'application/json' } });
  server.build = response.headers.get('equipoise-build') ?? server.build;
  if (response.ok) return response.json();
  throw await problemOf(response);
}

/** A problem, as the server writes it, as an error. @param {any} body @param {number} status @param {string} [title] if it has none */
export const asProblem = (body, status, title = '') =>
  new Problem(body.title ?? title, body.detail ?? '', body.errors ?? [], status);

/** The error of a response that is no success. @param {Response} response */
export async function problemOf(response) {
  const body = await response.json().catch(() => ({}));
  return asProblem(body, response.status, response.statusText);
}
