// The rig of the page: its scene, what its owner says of its errors, and the address that keeps both.

import { setAt } from '../api/scene-fields.js';
import { merged, parameters } from '../api/scene-query.js';
import { brokenLinkNotice } from '../dom/notices.js';
import { sceneOf } from '../app/link.js';
import { ScenePage } from '../panels/scene-page.js';

/** Sizes that the owner has, by field: `have.table.errors.angle_bias=0.001`. */
const HAVE = /^have\.([a-z_.]+)$/;

/** Parts of a file that are no values of its scene. */
const BESIDE = ['preset', 'derived', '$schema'];

export class Rig extends ScenePage {
  /** Sizes of errors that the owner has typed, in SI units. @type {Record<string, number>} */
  have = {};

  /** @param {Field[]} fields @param {Case[]} cases */
  constructor(fields, cases) {
    super('rig', fields, cases);
  }

  /** @param {string} search */
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
    brokenLinkNotice('link-have', dropped);
    super.read(`?${query}`);
  }

  /** The scene as text, the last that was whole. */
  get words() {
    return String(this.queryOf());
  }

  get search() {
    const query = new URLSearchParams(super.search);
    for (const [path, value] of Object.entries(this.have)) query.set(`have.${path}`, String(value));
    return `?${query}`;
  }

  /** Takes the values of the form. @param {Scene} scene @param {boolean} complete */
  type(scene, complete) {
    this.scene = scene;
    this.complete = complete;
    this.tell();
  }

  /** The scene with other values. @param {Record<string, unknown>} values by path; `null` takes one away */
  with(values) {
    const changes = {};
    for (const [path, value] of Object.entries(values)) setAt(changes, path, value);
    return merged(this.scene, changes);
  }

  /** @param {string} path @param {number | undefined} size */
  own(path, size) {
    const { [path]: _, ...others } = this.have;
    this.have = size === undefined ? others : { ...others, [path]: size };
    this.keep(true);
    this.tell();
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
    const values = Object.fromEntries(Object.entries(given).filter(([key]) => !BESIDE.includes(key)));
    const preset = typeof content.preset === 'string' ? [['preset', content.preset]] : [];
    const query = new URLSearchParams([...preset, ...parameters('scene', values)]);
    const { link, chosen, scene } = sceneOf(`?${query}`, this.fields, this.cases);
    if (Object.keys(link.changes).length === 0 && !link.preset) return ['all of it: there is no scene in it'];
    this.take(merged({}, scene), chosen);
    return link.dropped;
  }
}
