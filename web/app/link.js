// Reads the page's address: scene and run in the words of `/v1/live`. Links grow old, so every part is checked.

import { differences, setAt, valueAt } from '../api/scene-fields.js';
import { merged, sceneQuery } from '../api/scene-query.js';
import { linked } from '../api/settings.js';
import { FASTEST, SLOWEST, VELOCITIES, interventionQuery, interventionsOf } from '../run/interventions.js';

/** Keys of a run. */
const RUN_KEYS = /^(interventions\.\d+\.(impact|(set|kick|catch|throw)\.[\w.]+)|clock\.\d+\.(wall_ms|run|speed)|hold)$/;
/** Keys of panels. */
const PANEL_KEYS =
  /^(tab|you|have\.[a-z_.]+|map\.([xy]\.(parameter|from|to)|quantity|impacts|columns)|survival\.(runs|impacts|timing_sd|model)|precision\.(impacts|axis)|ladder\.(impacts|tolerance)|(map\.)?catch\.(strategy|ratio|strikes|brake|hold|height|theta|low|high)|calls\.language|design\.(contact|weights\.((x|theta)(_dot)?|input))|fit\.[\w.]+|brush\.\w+\.(from|to)|pin\.[0-2]\.(preset|(scene|interventions)\.[\w.]+))$/;

/**
 * @typedef {object} Link
 * @property {string | null} preset
 * @property {string | null} unknown name of a case that there is not
 * @property {Scene} changes to the preset, or the whole scene without one
 * @property {number} speed
 * @property {URLSearchParams | null} run interventions of a run to release, with epoch and clock of one to join
 * @property {URLSearchParams} panels what the panels show, read where each is drawn
 * @property {string[]} dropped what could not be kept, in words
 */

/** @param {string} search @param {Field[]} fields @param {Case[]} cases @returns {Link} */
function readLink(search, fields, cases) {
  const panels = new URLSearchParams();
  /** @type {Link} */
  const link = { preset: null, unknown: null, changes: {}, speed: 1, run: null, panels, dropped: [] };
  const run = new URLSearchParams();
  let whole = true;
  for (const [told, text] of new URLSearchParams(search)) {
    // Links before version 0.3 have a time of day without its unit.
    const key = told.replace(/^(epoch|clock\.\d+\.wall)$/, '$1_ms');
    const fault = readPart(key, text, link, run, fields, cases);
    if (fault === null) continue;
    link.dropped.push(fault);
    if (/^(preset$|scene\.)/.test(key)) whole = false;
  }
  /** @type {number[][]} */
  const vertices = Array.from(link.changes.body?.vertices ?? []);
  if (vertices.some((place) => place?.[0] === undefined || place[1] === undefined)) {
    delete link.changes.body.vertices;
    link.dropped.push('the vertices, which are not whole');
    whole = false;
  }
  const kept = wholeRun(run, fields, whole, link.dropped);
  if (kept.size > 0) link.run = kept;
  return link;
}

/** The case that a scene is, if it is one. @param {Scene} scene @param {Field[]} fields @param {Case[]} cases */
export const caseOf = (scene, fields, cases) =>
  cases.find((one) => differences(fields, one.scene, scene).length === 0) ?? null;

/** The scene that an address names, the first case where it names none, with its case and its query. @param {string} search @param {Field[]} fields @param {Case[]} cases */
export function sceneOf(search, fields, cases) {
  const link = readLink(search, fields, cases);
  const { preset, changes } = link;
  const named = cases.find(({ name }) => name === preset);
  const chosen = named ?? (Object.keys(changes).length === 0 ? cases[0] : caseOf(changes, fields, cases));
  const scene = merged(chosen?.scene ?? {}, changes);
  return { link, chosen, scene, query: sceneQuery(scene, chosen, fields) };
}

/** Foreign text, short enough to print. @param {string} text */
const shown = (text) => (text.length > 40 ? `${text.slice(0, 40)}…` : text);

/**
 * Reads a part of an address into a link.
 * @param {string} key
 * @param {string} text
 * @param {Link} link
 * @param {URLSearchParams} run the run's part
 * @param {Field[]} fields
 * @param {Case[]} cases
 * @returns {string | null} what could not be kept, in words
 */
function readPart(key, text, link, run, fields, cases) {
  const value = text.trim() === '' ? NaN : Number(text);
  if (key.startsWith('scene.')) return readField(key.slice(6), text, fields, link.changes);
  if (key === 'preset') {
    link.preset = cases.find((one) => one.name === text)?.name ?? null;
    if (link.preset !== null) return null;
    link.unknown = shown(text);
    return `the case “${link.unknown}”, which is not known here`;
  }
  if (key === 'speed') {
    if (!(value >= SLOWEST && value <= FASTEST))
      return `the speed “${shown(text)}”: it must be from ${SLOWEST} to ${FASTEST}`;
    link.speed = value;
  } else if (key === 'epoch_ms') {
    if (!(Number.isFinite(value) && value >= 0)) return `the start “${shown(text)}”, which is not a time in ms`;
    run.set(key, text);
  } else if (RUN_KEYS.test(key)) {
    if (!Number.isFinite(value) && !isChoice(key, text, fields)) return `${key}: “${shown(text)}” is not a number`;
    run.set(key, text);
  } else if (PANEL_KEYS.test(key)) link.panels.set(key, text);
  else if (key !== 'from' && key !== 'chart' && !(key === 'angles' && /^(deg|rad)$/.test(text)))
    return `“${shown(key)}”, which has no meaning here`;
  return null;
}

/** True when an intervention sets a choice to one that exists. @param {string} key @param {string} text @param {Field[]} fields */
function isChoice(key, text, fields) {
  if (/^interventions\.\d+\.catch\.strategy$/.test(key)) return /^(auto|bounce_down|plan|brake)$/.test(text);
  const path = /^interventions\.\d+\.set\.(.+)$/.exec(key)?.[1];
  return fields.some((field) => field.field === path && field.choices?.includes(text));
}

/** @param {string} path @param {string} text @param {Field[]} fields @param {Scene} changes where the value goes @returns {string | null} why it was not taken */
function readField(path, text, fields, changes) {
  const [, list, index, axis] = /^(.+?)\.(\d\d?)(?:\.([01]))?$/.exec(path) ?? [];
  const kind = axis ? 'vertices' : list ? 'numbers' : null;
  const field = fields.find((one) => one.field === (list ?? path));
  const takesBack = text === 'null' && !list && path !== 'body.point';
  const own = field && ['vertices', 'numbers'].includes(field.kind) && !takesBack ? field.kind : null;
  if (!field || own !== kind) return `“scene.${shown(path)}”, which is no field of a scene`;
  const { value, problem } = takesBack ? { value: null } : linked(field, text);
  if (problem) return `${field.title.toLowerCase()} “${shown(text)}”, which ${problem}`;
  if (!list) setAt(changes, path, value);
  else {
    const values = [...(valueAt(changes, list) ?? [])];
    values[Number(index)] = axis ? Object.assign([...(values[Number(index)] ?? [])], { [axis]: value }) : value;
    setAt(changes, list, values);
  }
  return null;
}

/** Parts of an entry of the clock. */
const CLOCK = ['wall_ms', 'run', 'speed'];

/**
 * The run's part of a link with what is whole in it, numbered anew.
 * @param {URLSearchParams} run
 * @param {Field[]} fields
 * @param {boolean} whole false for a run whose scene is not
 * @param {string[]} dropped
 */
function wholeRun(run, fields, whole, dropped) {
  if (run.size > 0 && !whole) {
    dropped.push('the run itself, since its scene is not whole');
    return new URLSearchParams();
  }
  const begun = run.has('epoch_ms');
  const kept = new URLSearchParams([...run].filter(([key]) => /^(epoch_ms|hold)$/.test(key)));
  const interventions = interventionsOf(run);
  const good = interventions.filter(
    ({ impact, set, kick, guide }) =>
      impact >= 1 &&
      Object.keys(set).every((path) => fields.some((field) => field.field === path && field.live)) &&
      Object.keys(kick).every((name) => Object.hasOwn(VELOCITIES, name)) &&
      Object.keys({ ...set, ...kick, ...guide }).length > 0,
  );
  if (good.length < interventions.length)
    dropped.push(`${interventions.length - good.length} of ${interventions.length} interventions, which are not whole`);
  for (const [name, value] of interventionQuery(good)) kept.set(name, value);
  const marks = new Set([...run.keys()].flatMap((key) => /^clock\.(\d+)/.exec(key)?.[1] ?? []));
  const complete = [...marks]
    .filter((mark) => begun && CLOCK.every((part) => run.has(`clock.${mark}.${part}`)))
    .sort((one, other) => Number(one) - Number(other));
  if (complete.length < marks.size)
    dropped.push(`a pause or a change of speed, which ${begun ? 'is not whole' : 'belongs to a run with a start'}`);
  for (const [index, mark] of complete.entries())
    for (const part of CLOCK) kept.set(`clock.${index}.${part}`, run.get(`clock.${mark}.${part}`) ?? '');
  return kept;
}
