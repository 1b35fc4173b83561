// The server's resources by HTTP and the shapes of their answers. Not for the live stream.

/**
 * @typedef {Record<string, any>} Scene nested as in the contract
 *
 * @typedef {object} Field one row of the table of scene fields
 * @property {string} path dotted, such as `table.tilt_gain`
 * @property {string | null} symbol
 * @property {string} group
 * @property {string} title
 * @property {string} about
 * @property {string | null} unit
 * @property {'number' | 'integer' | 'choice' | 'boolean' | 'vertices'} kind
 * @property {number | null} minimum
 * @property {number | null} maximum
 * @property {number | string | boolean | null} default
 * @property {boolean} required
 * @property {string[] | null} choices
 * @property {boolean} live may be changed during a run
 *
 * @typedef {{quantity: string, symbol: string, unit: string, value: number | string | null, where: string, why?: string | null}} PaperValue
 * @typedef {{name: string, title: string, shows: string, scene: Scene, printed: PaperValue[], computed: PaperValue[]}} Case
 *
 * @typedef {{re: number, im: number, modulus: number}} Eigenvalue
 * @typedef {object} Linear
 * @property {'elliptic' | 'parabolic' | 'hyperbolic' | 'attracting'} class
 * @property {number | null} residue
 * @property {number | null} rotation
 * @property {number | null} spectral_radius
 * @property {Eigenvalue[]} eigenvalues
 * @property {{value: number, lower: number | null, critical: number | null, margin_below: number | null, margin_above: number | null} | null} tilt_gain
 * @property {{value: number, upper: number | null, eigenvalue: number | null, margin: number | null} | null} energy_gain
 *
 * @typedef {object} Stability
 * @property {Scene} scene
 * @property {{name: string, reason: string}} model
 * @property {string | null} verdict
 * @property {string | null} decided_by
 * @property {string | null} reason
 * @property {{theta: number, x_dot: number, y_dot: number, theta_dot: number | null, flight_time: number, apex_height: number} | null} fixed_point
 * @property {Linear | null} linear
 * @property {{coefficient: number, kind: string} | null} boundary
 * @property {{parameter: string, value: number, bifurcation: string, coefficient: number, kind: string, swing: number | null, heights: [number, number] | null}[] | null} loss_of_stability
 * @property {{coefficient: number, kind: string, escape_impacts: number | null, detail: string} | null} lyapunov
 * @property {{outcome: string, impacts: number, t: number, max_theta: number, demand: {tilt: number, tilt_rate: number, speed: number, stroke: number} | null, detail: string} | null} nonlinear
 * @property {number | null} drift_speed
 * @property {boolean | null} agree
 * @property {{measured: number | null, linear: number, resonance: {p: number, q: number, distance: number}} | null} rotation_number
 * @property {{indicator: number, chaotic: boolean, impacts: number} | null} chaos
 * @property {number | null} predictable_impacts
 * @property {{theta: number, impacts: number, holes: [number, number][], unbroken: number, tolerance: number, spacing: number} | null} basin
 * @property {string[]} notes
 *
 * @typedef {{kind: string, impacts: number, t: number, detail: string}} Outcome
 * @typedef {{pointer: string, detail: string}} FieldError
 */

/** A polygon's vertices, the one part of a scene that is no single value. @type {Field} */
const VERTICES = {
  path: 'body.vertices',
  symbol: null,
  group: 'body',
  title: 'Vertices',
  about: 'Of a polygon, in place of the two lengths: x and y of one in a line, counter-clockwise.',
  unit: 'm',
  kind: 'vertices',
  minimum: null,
  maximum: null,
  default: null,
  required: false,
  choices: null,
  live: false,
};

/** All that a scene is made of, group by group. @param {{fields: Field[]}} table @returns {Field[]} */
export function fieldsOf({ fields }) {
  const after = fields.findLastIndex(({ group }) => group === 'body') + 1;
  return fields.toSpliced(after, 0, VERTICES);
}

/** Two values of a field, vertices included. @param {unknown} one @param {unknown} other */
export const same = (one, other) => one === other || (Array.isArray(one) && String(one) === String(other));

/** Impacts of one run that the server computes at a request. */
export const MOST_IMPACTS = 100_000;

/** What the server refused, with the fields it blames. */
export class Problem extends Error {
  /**
   * @param {string} title
   * @param {string} detail
   * @param {FieldError[]} errors
   * @param {number} status
   */
  constructor(title, detail, errors, status) {
    super(detail || title);
    this.title = title;
    this.errors = errors;
    this.status = status;
  }
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

/** @param {Response} response that is no success */
export async function problemOf(response) {
  const body = await response.json().catch(() => ({}));
  return new Problem(body.title ?? response.statusText, body.detail ?? '', body.errors ?? [], response.status);
}

/**
 * A dotted field path from the pointer of an error, wherever the server found the field.
 * @param {string} pointer
 */
export const pathOf = (pointer) =>
  pointer
    .replace(/^\//, '')
    .replace(/^scene[/.]/, '')
    .replaceAll('/', '.');

/**
 * @param {Scene} scene
 * @param {string} path
 * @returns {any}
 */
export const valueAt = (scene, path) => path.split('.').reduce((/** @type {any} */ value, key) => value?.[key], scene);

/**
 * The value a field has in a scene, its default where nothing is said; undefined when it has none.
 * @param {Scene} scene
 * @param {Field} field
 */
export const playedAt = (scene, field) => valueAt(scene, field.path) ?? field.default ?? undefined;

/**
 * @param {Scene} scene
 * @param {string} path
 * @param {unknown} value
 */
export function setAt(scene, path, value) {
  const keys = path.split('.');
  const last = /** @type {string} */ (keys.pop());
  let inner = scene;
  for (const key of keys) inner = inner[key] ??= {};
  inner[last] = value;
}
