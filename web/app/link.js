// Reads the page's address: scene and run in the words of `/v1/live`. Links grow old, so every part is checked.

import { number, quantity } from '../dom/numbers.js';
import { setAt, valueAt } from '../api/scene-fields.js';
import { interventionQuery, interventionsOf } from '../run/interventions.js';
import { FASTEST, SLOWEST } from '../run/speed.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('contract').Preset} Case */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */

/** Keys of panels. */
const PANEL_KEYS =
  /^(tab|you|map\.([xy]\.(parameter|from|to)|quantity|impacts|columns)|survival\.(runs|impacts|timing_sd|model)|precision\.(impacts|axis)|ladder\.(impacts|tolerance)|(map\.)?catch\.(strategy|ratio|strikes|brake|hold|height|theta|low|high)|calls\.language|design\.(contact|weights\.((x|theta)(_dot)?|input))|fit\.[\w.]+|brush\.\w+\.(from|to)|pin\.[0-2]\.(preset|(scene|interventions)\.[\w.]+))$/;

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

/**
 * @param {string} search
 * @param {Field[]} fields
 * @param {Case[]} cases
 * @returns {Link}
 */
export function readLink(search, fields, cases) {
  /** @type {Link} */
  const link = {
    preset: null,
    unknown: null,
    changes: {},
    speed: 1,
    run: null,
    panels: new URLSearchParams(),
    dropped: [],
  };
  const run = new URLSearchParams();
  const query = new URLSearchParams(search);
  let whole = true;
  /** @param {string} what */
  const dropScene = (what) => {
    whole = false;
    link.dropped.push(what);
  };
  for (const [told, text] of query) {
    const key = presentName(told);
    const value = text.trim() === '' ? NaN : Number(text);
    if (key === 'preset') {
      if (cases.some((one) => one.name === text)) link.preset = text;
      else {
        link.unknown = shown(text);
        dropScene(`the case “${link.unknown}”, which is not known here`);
      }
    } else if (/^scene\.body\.vertices\.\d{1,2}\.[01]$/.test(key) && Number.isFinite(value)) {
      const [index, axis] = key.split('.').slice(3).map(Number);
      link.changes.body ??= {};
      const { body } = link.changes;
      body.vertices ??= [];
      body.vertices[index] ??= [];
      body.vertices[index][axis] = value;
    } else if (key.startsWith('scene.')) {
      const refused = readField(key.slice(6), text, fields, link.changes);
      if (refused) dropScene(refused);
    } else if (key === 'speed') {
      if (value >= SLOWEST && value <= FASTEST) link.speed = value;
      else link.dropped.push(`the speed “${shown(text)}”: it must be from ${SLOWEST} to ${FASTEST}`);
    } else if (key === 'epoch_ms') {
      if (Number.isFinite(value) && value >= 0) run.set(key, text);
      else link.dropped.push(`the start “${shown(text)}”, which is not a time in ms`);
    } else if (
      /^(interventions\.\d+\.(impact|(set|kick|catch|throw)\.[\w.]+)|clock\.\d+\.(wall_ms|run|speed)|hold)$/.test(key)
    ) {
      if (Number.isFinite(value) || isChoice(key, text, fields)) run.set(key, text);
      else link.dropped.push(`${key}: “${shown(text)}” is not a number`);
    } else if (PANEL_KEYS.test(key)) {
      link.panels.set(key, text);
    } else if (key !== 'from' && key !== 'chart' && !(key === 'angles' && /^(deg|rad)$/.test(text))) {
      link.dropped.push(`“${shown(key)}”, which has no meaning here`);
    }
  }
  /** @type {number[][] | undefined} */
  const vertices = link.changes.body?.vertices;
  if (vertices && Array.from(vertices).some((place) => place?.[0] === undefined || place[1] === undefined)) {
    delete link.changes.body.vertices;
    dropScene('the vertices, which are not whole');
  }
  if (run.size > 0 && !whole) link.dropped.push('the run itself, since its scene is not whole');
  else {
    const kept = wholeRun(run, fields, link.dropped);
    if (kept.size > 0) link.run = kept;
  }
  return link;
}

/** The name of a time of day, which links before version 0.3 have without its unit. @param {string} key */
const presentName = (key) => key.replace(/^(epoch|clock\.\d+\.wall)$/, '$1_ms');

/** True when an intervention sets a choice to one that exists. @param {string} key @param {string} text @param {Field[]} fields */
function isChoice(key, text, fields) {
  if (/^interventions\.\d+\.catch\.strategy$/.test(key)) return /^(auto|bounce_down|plan|brake)$/.test(text);
  const path = /^interventions\.\d+\.set\.(.+)$/.exec(key)?.[1];
  return fields.some((field) => field.field === path && field.choices?.includes(text));
}

/** Foreign text, short enough to print. @param {string} text */
const shown = (text) => (text.length > 40 ? `${text.slice(0, 40)}…` : text);

/**
 * @param {string} path
 * @param {string} text
 * @param {Field[]} fields
 * @param {Scene} changes where the value goes
 * @returns {string | null} why it was not taken
 */
function readField(path, text, fields, changes) {
  const [, list, index] = /^(.+)\.(\d\d?)$/.exec(path) ?? [];
  const field = fields.find((one) => one.field === (one.kind === 'numbers' && text !== 'null' ? list : path));
  if (!field) return `“scene.${shown(path)}”, which is no field of a scene`;
  /** @type {unknown} */
  let value = text;
  if (text === 'null' && path !== 'body.point') {
    setAt(changes, path, null);
    return null;
  }
  if (field.minimum !== null) {
    value = text.trim() === '' ? NaN : Number(text);
    const { minimum, maximum } = field;
    if (!Number.isFinite(value)) return `${field.title.toLowerCase()} “${shown(text)}”, which is not a number`;
    if ((minimum != null && Number(value) < minimum) || (maximum != null && Number(value) > maximum)) {
      return `${field.title.toLowerCase()} ${number(Number(value))}: it must be from ${number(minimum)} to ${quantity(maximum, field.unit)}`;
    }
  } else if (field.kind === 'boolean') {
    if (text !== 'true' && text !== 'false')
      return `${field.title.toLowerCase()} “${shown(text)}”, which is neither true nor false`;
    value = text === 'true';
  } else if (field.choices && !field.choices.includes(text)) {
    return `${field.title.toLowerCase()} “${shown(text)}”: it must be one of ${field.choices.join(', ')}`;
  }
  if (index) setAt(changes, list, (valueAt(changes, list) ?? []).toSpliced(Number(index), 1, value));
  else setAt(changes, path, value);
  return null;
}

/**
 * The run's part of a link with what is whole in it, numbered anew.
 * @param {URLSearchParams} run
 * @param {Field[]} fields
 * @param {string[]} dropped
 */
function wholeRun(run, fields, dropped) {
  const epoch = run.get('epoch_ms');
  const kept = new URLSearchParams([...run].filter(([key]) => /^(epoch_ms|hold)$/.test(key)));
  const interventions = interventionsOf(run);
  const whole = interventions.filter(
    ({ impact, set, kick, guide }) =>
      impact >= 1 &&
      Object.keys(set).every((path) => fields.some((field) => field.field === path && field.live)) &&
      Object.keys(kick).every((name) => ['theta_dot', 'x_dot', 'y_dot'].includes(name)) &&
      Object.keys(set).length + Object.keys(kick).length + Object.keys(guide).length > 0,
  );
  if (whole.length < interventions.length)
    dropped.push(
      `${interventions.length - whole.length} of ${interventions.length} interventions, which are not whole`,
    );
  for (const [name, value] of interventionQuery(whole)) kept.set(name, value);
  const marks = [
    ...new Set([...run.keys()].filter((key) => key.startsWith('clock.')).map((key) => Number(key.split('.')[1]))),
  ].sort((a, b) => a - b);
  const complete = marks.filter(
    (mark) => epoch !== null && ['wall_ms', 'run', 'speed'].every((part) => run.has(`clock.${mark}.${part}`)),
  );
  if (complete.length < marks.length)
    dropped.push(
      `a pause or a change of speed, which ${epoch === null ? 'belongs to a run with a start' : 'is not whole'}`,
    );
  complete.forEach((mark, index) => {
    for (const part of ['wall_ms', 'run', 'speed'])
      kept.set(`clock.${index}.${part}`, run.get(`clock.${mark}.${part}`) ?? '');
  });
  return kept;
}
