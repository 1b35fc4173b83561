// The typed scene of the page. The form is a view of it that may come later.

import { setAt, valueAt } from '../../api/scene-fields.js';

/** @typedef {import('../../api/scene-fields.js').Scene} Scene */
/** @typedef {import('../../api/scene-fields.js').Field} Field */

/** A scene without the lengths that its kind of body cannot have. @param {Scene} scene @returns {Scene} */
function withOneBody({ body, ...rest }) {
  if (!body) return rest;
  if (body.point) return { ...rest, body: { point: true } };
  const { point: _, ...extended } = body;
  if (!extended.vertices) return { ...rest, body: extended };
  const { contact_distance: __, radius_of_gyration: ___, ...polygon } = extended;
  return { ...rest, body: polygon };
}

export class TypedScene {
  /** @type {Field[]} */
  fields = [];
  /** The values that were set; of a field whose text is no value, the last one that was. Replaced, never changed. @type {Scene | undefined} */
  scene;
  /** The form, once it is there. @type {import('../../form/form.js').Form | null} */
  #form = null;
  #complete = false;

  /** The scene; null while some of it is no value. @returns {Scene | null} */
  get complete() {
    return this.#complete ? (this.scene ?? null) : null;
  }

  get form() {
    return this.#form;
  }

  /** @param {import('../../form/form.js').Form} form */
  join(form) {
    this.#form = form;
    if (this.scene) form.fill(this.scene);
  }

  /** Another scene takes the place of this one. @param {Scene} scene */
  fill(scene) {
    this.#set(scene);
    this.#form?.fill(this.scene ?? {});
  }

  /** Sets a value from elsewhere than the form. @param {string} path @param {unknown} value */
  put(path, value) {
    const next = structuredClone(this.scene ?? {});
    setAt(next, path, value ?? undefined);
    this.#set(next);
    if (!this.#form) return;
    this.#form.put(path, value);
    this.take();
  }

  /** Reads what was typed into the form. */
  take() {
    if (!this.#form) return;
    const { scene, complete } = this.#form.read();
    /** @type {Scene} */
    const next = {};
    for (const { field: path } of this.fields) {
      const value = valueAt(scene, path) ?? (complete ? undefined : valueAt(this.scene ?? {}, path));
      if (value !== undefined) setAt(next, path, value);
    }
    this.scene = withOneBody(next);
    this.#complete = complete;
  }

  /** @param {Scene} scene */
  #set(scene) {
    /** @type {Scene} */
    const next = {};
    for (const { field: path } of this.fields) {
      const value = valueAt(scene, path) ?? undefined;
      if (value !== undefined) setAt(next, path, value);
    }
    this.scene = withOneBody(next);
    const missing = this.fields.some(
      ({ field: path, required }) =>
        required &&
        !path.startsWith('body.') &&
        !(path === 'table.tilt_gain' && next.table?.feedback) &&
        valueAt(next, path) === undefined,
    );
    this.#complete = !missing;
  }
}
