// The typed scene: the values that were set, of which a body has only those of its kind. The form is a view of it.

import { same, setAt, valueAt } from '../api/scene-fields.js';

const LENGTHS = ['body.contact_distance', 'body.radius_of_gyration'];

export class TypedScene {
  /** @type {Field[]} */
  fields = [];
  /** Hears of another scene, or of another value of a field. @type {(path: string | null) => void} */
  retyped = () => {};
  /** The scene; of one that lacks a value that it needs, the last that did not. Replaced, never changed. @type {Scene | undefined} */
  typed;
  /** Fields that need a value and have none. @type {Field[]} */
  missing = [];
  /** The values that were set, with those that this kind of body cannot have: they stay for later. @type {Map<string, unknown>} */
  #values = new Map();

  /** The scene; null while a value is missing. @returns {Scene | null} */
  get complete() {
    return this.missing.length === 0 ? (this.typed ?? null) : null;
  }

  /** The value that was set. @param {Field} field */
  value({ field: path }) {
    return this.#values.get(path);
  }

  /** True for a field that the body cannot have: a point has no extent, and a polygon the lengths of its corners. @param {Field} field */
  isOff({ field: path }) {
    if (!path.startsWith('body.') || path === 'body.point') return false;
    if (this.#values.get('body.point') === true) return true;
    return this.#values.has('body.vertices') && LENGTHS.includes(path);
  }

  /** True for a field that has to have a value; a table with a state feedback needs no tilt gain. @param {Field} field */
  needs(field) {
    if (!field.required || this.isOff(field)) return false;
    return (
      field.field !== 'table.tilt_gain' || ![...this.#values.keys()].some((one) => one.startsWith('table.feedback.'))
    );
  }

  /** Another scene takes the place of this one; what it leaves open has its default. @param {Scene} scene */
  fill(scene) {
    this.#values.clear();
    for (const field of this.fields) {
      const value = valueAt(scene, field.field);
      if (value != null && !same(value, field.default)) this.#values.set(field.field, value);
    }
    this.typed = this.#update();
    this.retyped(null);
  }

  /** @param {string} path @param {unknown} value undefined to take it away */
  put(path, value) {
    if (value == null) this.#values.delete(path);
    else this.#values.set(path, value);
    const scene = this.#update();
    if (this.missing.length === 0) this.typed = scene;
    this.retyped(path);
  }

  #update() {
    /** @type {Scene} */
    const scene = {};
    for (const field of this.fields) {
      const value = this.value(field);
      if (value !== undefined && !this.isOff(field)) setAt(scene, field.field, value);
    }
    this.missing = this.fields.filter((field) => this.needs(field) && this.value(field) === undefined);
    return scene;
  }
}
