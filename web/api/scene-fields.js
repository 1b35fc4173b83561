// The fields of a scene: their table, and their values by dotted path.

/** Compares two values of a field, vertices included. @param {unknown} one @param {unknown} other */
export const same = (one, other) => one === other || (Array.isArray(one) && String(one) === String(other));

/** The field path of an error's pointer, in a request's body or in its query. @param {string} pointer */
export const pathOf = (pointer) =>
  pointer
    .replace(/^\//, '')
    .replace(/^scene[/.]/, '')
    .replaceAll('/', '.');

/** @param {Scene} scene @param {string} path @returns {any} */
export const valueAt = (scene, path) => path.split('.').reduce((/** @type {any} */ value, key) => value?.[key], scene);

/** The value of a field in a scene, or its default; undefined when it has neither. @param {Scene} scene @param {Field} field */
export const playedAt = (scene, field) => valueAt(scene, field.field) ?? field.default ?? undefined;

/** @param {Scene} scene @param {string} path @param {unknown} value */
export function setAt(scene, path, value) {
  const keys = path.split('.');
  const last = /** @type {string} */ (keys.pop());
  let inner = scene;
  for (const key of keys) {
    inner[key] ??= {};
    inner = inner[key];
  }
  inner[last] = value;
}

/** The fields in which two scenes differ. @param {Field[]} fields @param {Scene} one @param {Scene} other */
export const differences = (fields, one, other) =>
  fields.filter((field) => !same(playedAt(one, field), playedAt(other, field)));
