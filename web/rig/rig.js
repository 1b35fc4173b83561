// The rig of the page: its scene, what its owner says of its errors, and the address that keeps both.

import { setAt } from '../api/scene-fields.js';
import { merged, parameters } from '../api/scene-query.js';
import { sceneOf } from '../app/link.js';
import { entriesOf } from '../panels/card.js';
import { ScenePage } from '../panels/scene-page.js';
import { numberOf } from '../panels/settings.js';

/** The beginning of the parts of the address with sizes that the owner has: `have.table.errors.angle_bias=0.001`. */
const HAVE = 'have.';

/** Parts of a file that are no values of its scene. */
const BESIDE = ['preset', 'derived', '$schema'];

export class Rig extends ScenePage {
  /** @param {Field[]} fields @param {Case[]} cases */
  constructor(fields, cases) {
    super('rig', fields, cases, [...entriesOf('rig').map(({ id }) => id), 'have']);
  }

  /** Sizes of errors that the owner has typed, in SI units, by field. @returns {Record<string, number>} */
  get have() {
    const own = [...this.link].filter(([key]) => key.startsWith(HAVE));
    return Object.fromEntries(own.map(([key, text]) => [key.slice(HAVE.length), numberOf(text)]));
  }

  /** @param {string} search */
  read(search) {
    super.read(search);
    const wrong = Object.entries(this.have).filter(([, size]) => !(size >= 0 && Number.isFinite(size)));
    const words = (/** @type {string} */ path) =>
      `what you have of ${path} “${this.link.get(HAVE + path)?.slice(0, 40)}”, which is not a number from 0 on`;
    if (wrong.length > 0)
      this.drop(
        'have',
        wrong.map(([path]) => [HAVE + path, words(path)]),
      );
  }

  /** The scene as text, the last that was whole. */
  get words() {
    return String(this.queryOf());
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

  /** The way back leads to what the owner had before. @param {string} path @param {number | undefined} size */
  own(path, size) {
    history.pushState(null, '');
    this.part({ [HAVE + path]: size === undefined ? null : String(size) });
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
