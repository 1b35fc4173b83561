// Pages whose scene is in the address: how they begin, what a panel finds around it, and the choice of a case.

import { get, wordsOf } from '../api/client.js';
import { sceneQuery } from '../api/scene-query.js';
import { sceneOf } from '../app/link.js';
import { retryButton } from '../dom/elements.js';
import { brokenLinkNotice, notice } from '../dom/notices.js';
import { knowTitles } from '../dom/typeset.js';
import { followAddress, keepAngles } from '../dom/units.js';
import { html } from '../vendor/preact/preact.js';
import { entriesOf } from './card.js';
import { Choice, useChanges } from './parts.js';
import { Parts } from './settings.js';

/** Makes a page of the fields of a scene and the cases; one that fails can be asked for again. @param {(fields: Field[], cases: Case[]) => unknown} make */
export async function begin(make) {
  try {
    const [{ items: fields }, { items: cases }] = await Promise.all([get('v1/fields'), get('v1/scenes')]);
    knowTitles(fields);
    await make(fields, cases);
  } catch (error) {
    const again = retryButton(() => location.reload());
    notice('server', [wordsOf(error), ' ', again], { dismissible: false, caution: true });
  }
}

/** A scene with the parts of the address that belong to panels on it: a page around components. It tells each change by an event. */
export class ScenePage extends Parts {
  /** @type {Scene} */
  scene = {};
  /** The case that the scene began with. @type {Case | null} */
  chosen = null;
  /** False while some of what is typed is no value. */
  complete = true;
  fields;
  cases;
  #path;
  #panels;

  /** @param {string} path of the page @param {Field[]} fields @param {Case[]} cases @param {string[]} [panels] that begin their parts of its address */
  constructor(path, fields, cases, panels = entriesOf(path).map(({ id }) => id)) {
    super();
    this.fields = fields;
    this.cases = cases;
    this.#path = path;
    this.#panels = panels;
  }

  /** Tells of another address: other parts of panels, or another unit of angles. */
  changed() {
    this.keep(false);
    this.tell();
  }

  tell() {
    this.dispatchEvent(new Event('change'));
  }

  /** Reads an address. @param {string} search */
  read(search) {
    const { link, chosen, scene } = sceneOf(search, this.fields, this.cases);
    this.chosen = chosen;
    this.scene = scene;
    this.complete = true;
    this.link = new URLSearchParams([...link.panels].filter(([key]) => this.#panels.includes(key.split('.')[0])));
    brokenLinkNotice('link', link.dropped);
    for (const id of this.#panels) this.dropped(id, []);
    this.tell();
  }

  /** Reads the address again on the way back. */
  followHistory() {
    addEventListener('popstate', () => {
      // A link to a place in the page changes nothing.
      if (location.search === this.search) return;
      followAddress(location.search);
      this.read(location.search);
    });
  }

  /** A scene as a query. @param {Scene} [scene] */
  queryOf(scene = this.scene) {
    return sceneQuery(scene, this.chosen, this.fields);
  }

  /** The scene as a query; null while some of it is no value. */
  get query() {
    return this.complete ? this.queryOf() : null;
  }

  /** The address of the page without its hash. */
  get search() {
    const query = new URLSearchParams([...this.queryOf(), ...this.link]);
    keepAngles(query);
    return `?${query}`;
  }

  /** Writes the address. @param {boolean} step so that the way back leads to what was before */
  keep(step) {
    const { search } = this;
    if (search === location.search) return;
    history[step ? 'pushState' : 'replaceState'](null, '', `${this.#path}${search}${location.hash}`);
  }

  /** Another scene takes the place of this one. @param {Scene} scene @param {Case | null} [chosen] */
  take = (scene, chosen = this.chosen) => {
    this.scene = scene;
    this.chosen = chosen;
    this.complete = true;
    this.keep(true);
    this.tell();
  };
}

/** The case that a page begins with. @param {{page: ScenePage, id: string, label: string, own: string}} props `own` names a scene that is none */
export function Cases({ page, id, label, own }) {
  const { cases, chosen } = useChanges(page);
  const plain = (/** @type {string} */ text) => text.replaceAll('κ_c', 'κ꜀').replaceAll('_', '');
  const choose = (/** @type {string} */ name) => {
    const one = cases.find((other) => other.name === name);
    if (one) page.take(structuredClone(one.scene), one);
  };
  const choices = Object.fromEntries(cases.map(({ name, title }) => [name, plain(title)]));
  return html`<p class="chosen row">
    <label for=${id}>${label} </label>
    <${Choice} id=${id} value=${chosen?.name ?? ''} choices=${chosen ? choices : { '': own, ...choices }} changed=${choose} />
  </p>`;
}
