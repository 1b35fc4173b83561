// The rig of the page: its scene, what its owner says of its errors, and the address that keeps both.

import { setAt, valueAt } from '../api/scene-fields.js';
import { merged, parameters, sceneQuery } from '../api/scene-query.js';
import { wholeParts, withParts } from '../panels/settings.js';
import { sceneOf } from '../panels/scene-page.js';
import { keepAngles } from '../dom/units.js';

/** @typedef {import('../api/scene-fields.js').Field} Field */
/** @typedef {import('../api/scene-fields.js').Scene} Scene */
/** @typedef {import('contract').Preset} Case */

/** Sizes that the owner has, by field: `have.table.errors.angle_bias=0.001`. */
const HAVE = /^have\.([a-z_.]+)$/;

/** Panels of this page, which begin their parts of the address. */
const OWNERS = ['survival', 'design', 'fit', 'calls'];
const OWN = new RegExp(`^(${OWNERS.join('|')})\\.`);

export class Rig {
  fields;
  cases;
  /** @type {Scene} */
  scene = {};
  /** The case that the scene began with. @type {Case | null} */
  chosen = null;
  /** False while some of what is typed is no value. */
  complete = true;
  /** Sizes of errors that the owner has typed, in SI units. @type {Record<string, number>} */
  have = {};
  /** Parts of the address of the panels. */
  link = new URLSearchParams();
  #dropped;
  /** @type {Set<() => void>} */
  #watchers = new Set();

  /** @param {Field[]} fields @param {Case[]} cases @param {(id: string, words: string[]) => void} dropped hears of broken parts of the address */
  constructor(fields, cases, dropped) {
    this.fields = fields;
    this.cases = cases;
    this.#dropped = dropped;
  }

  /** @param {() => void} changed @returns {() => void} ends it */
  watch(changed) {
    this.#watchers.add(changed);
    return () => void this.#watchers.delete(changed);
  }

  #tell() {
    for (const changed of this.#watchers) changed();
  }

  /** Reads an address. @param {string} search */
  read(search) {
    const query = new URLSearchParams(search);
    /** @type {string[]} */
    const dropped = [];
    this.have = {};
    for (const [key, text] of [...query]) {
      const [, path] = HAVE.exec(key) ?? [];
      if (!path) continue;
      query.delete(key);
      const value = text.trim() === '' ? NaN : Number(text);
      if (value >= 0 && Number.isFinite(value)) this.have[path] = value;
      else dropped.push(`what you have of ${path} “${text.slice(0, 40)}”, which is not a number from 0 on`);
    }
    const { link, chosen, scene } = sceneOf(`?${query}`, this.fields, this.cases);
    this.chosen = chosen;
    this.scene = scene;
    this.complete = true;
    this.link = new URLSearchParams([...link.panels].filter(([key]) => OWN.test(key)));
    this.#dropped('page', [...link.dropped, ...dropped]);
    for (const id of OWNERS) this.#dropped(id, []);
    this.#tell();
  }

  /** Changes parts of the address of a panel; null takes one away. @param {Record<string, string | null>} changes */
  part = (changes) => {
    this.link = withParts(this.link, changes);
    this.keep(false);
    this.#tell();
  };

  /** Takes broken parts away, and tells of them. @param {string} id of the panel @param {import('../panels/settings.js').Broken} broken */
  drop(id, broken) {
    this.link = wholeParts(this.link, broken);
    this.#dropped(
      id,
      broken.map(([, words]) => words),
    );
    this.#tell();
  }

  /** The scene as a query; null while some of it is no value. */
  get query() {
    return this.complete ? sceneQuery(this.scene, this.chosen, this.fields) : null;
  }

  /** The same as text, the last that was whole. */
  get words() {
    return String(sceneQuery(this.scene, this.chosen, this.fields));
  }

  /** The address of the page without its step. */
  get search() {
    const query = sceneQuery(this.scene, this.chosen, this.fields);
    for (const [path, value] of Object.entries(this.have)) query.set(`have.${path}`, String(value));
    for (const [key, value] of this.link) query.append(key, value);
    keepAngles(query);
    return `?${query}`;
  }

  /** Writes the address. @param {boolean} step so that the way back leads to what was before */
  keep(step) {
    const { search } = this;
    if (search === location.search) return;
    history[step ? 'pushState' : 'replaceState'](null, '', `rig${search}${location.hash}`);
  }

  /** Takes the values of the form. @param {Scene} scene @param {boolean} complete */
  type(scene, complete) {
    this.scene = scene;
    this.complete = complete;
    this.#tell();
  }

  /** Another scene takes the place of this one. @param {Scene} scene @param {Case | null} [chosen] */
  take = (scene, chosen = this.chosen) => {
    this.scene = scene;
    this.chosen = chosen;
    this.complete = true;
    this.keep(true);
    this.#tell();
  };

  /** The scene with other values. @param {Record<string, unknown>} values by path; `null` takes one away */
  set(values) {
    const scene = structuredClone(this.scene);
    for (const [path, value] of Object.entries(values)) {
      if (value !== null) setAt(scene, path, value);
      else if (valueAt(scene, path) !== undefined) {
        const keys = path.split('.');
        delete valueAt(scene, keys.slice(0, -1).join('.'))[/** @type {string} */ (keys.at(-1))];
      }
    }
    this.take(scene);
  }

  /** @param {string} path @param {number | undefined} size */
  own(path, size) {
    const { [path]: _, ...others } = this.have;
    this.have = size === undefined ? others : { ...others, [path]: size };
    this.keep(true);
    this.#tell();
  }

  /** Shows the same in another unit of angles. */
  retell() {
    this.keep(false);
    this.#tell();
  }

  /**
   * Reads a scene from a file: a scene, or an answer or a request with one in it.
   * @param {string} text JSON
   * @returns {string[]} what could not be kept, in words
   */
  load(text) {
    /** @type {any} */
    let content;
    try {
      content = JSON.parse(text);
    } catch {
      return ['all of it: the file is not JSON'];
    }
    const given = content?.scene ?? content;
    if (typeof given !== 'object' || given === null || Array.isArray(given))
      return ['all of it: there is no scene in it'];
    const query = new URLSearchParams(typeof content.preset === 'string' ? { preset: content.preset } : {});
    const flatten = (/** @type {string} */ path, /** @type {unknown} */ value) => {
      if (value === null || value === undefined) return;
      if (typeof value === 'object' && !Array.isArray(value))
        for (const [key, inner] of Object.entries(value)) flatten(`${path}.${key}`, inner);
      else for (const [name, one] of parameters(path, value)) query.append(name, one);
    };
    for (const [key, value] of Object.entries(given))
      if (!['preset', 'derived', '$schema'].includes(key)) flatten(`scene.${key}`, value);
    const { link, chosen, scene } = sceneOf(`?${query}`, this.fields, this.cases);
    if (Object.keys(link.changes).length === 0 && !link.preset) return ['all of it: there is no scene in it'];
    this.take(merged({}, scene), chosen);
    return link.dropped;
  }
}
