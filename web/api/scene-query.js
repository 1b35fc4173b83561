// A scene as the query that means it, and a preset with changes.

import { playedAt, same } from './scene-fields.js';

/** A preset with changes laid over it; a body of another kind replaces the preset's whole. @param {Scene} preset @param {Scene} changes @returns {Scene} */
export function merged(preset, changes) {
  const base = structuredClone(preset);
  const kind = (/** @type {Scene} */ { body }) => (body?.point ? 'point' : body?.vertices ? 'polygon' : 'rod');
  if (changes.body && kind(changes) !== kind(base) && (kind(changes) !== 'rod' || kind(base) === 'point'))
    delete base.body;
  /** @param {Scene} into @param {Scene} from */
  const lay = (into, from) => {
    for (const [key, value] of Object.entries(from)) {
      if (value === null) delete into[key];
      else if (typeof value === 'object' && !Array.isArray(value)) {
        into[key] ??= {};
        lay(into[key], value);
      } else into[key] = value;
    }
    return into;
  };
  return lay(base, changes);
}

/** A value as parameters: one for each number of a list, and for each value of a part of a scene. @param {string} name @param {unknown} value @returns {string[][]} */
export const parameters = (name, value) =>
  typeof value === 'object'
    ? Object.entries(value ?? {}).flatMap(([key, inner]) => parameters(`${name}.${key}`, inner))
    : [[name, String(value)]];

/**
 * A scene as the shortest query that means it: the preset and what differs, `null` where a value is taken back, or all of it where the
 * body is another one.
 * @param {Scene} scene with what was set only, defaults left out
 * @param {Case | null} preset
 * @param {Field[]} fields
 */
export function sceneQuery(scene, preset, fields) {
  const query = new URLSearchParams();
  const covered =
    preset &&
    fields.every(
      (field) =>
        !field.field.startsWith('body.') ||
        playedAt(preset.scene, field) === undefined ||
        playedAt(scene, field) !== undefined,
    );
  if (covered) query.set('preset', preset.name);
  for (const field of fields) {
    const value = playedAt(scene, field);
    if (value === undefined && covered && playedAt(preset.scene, field) !== undefined)
      query.set(`scene.${field.field}`, 'null');
    if (value === undefined || same(value, covered ? playedAt(preset.scene, field) : field.default)) continue;
    for (const [name, text] of parameters(`scene.${field.field}`, value)) query.set(name, text);
  }
  return query;
}
