// Undo and redo of edits: the typed scene, and the run with what was done to it. Beside it the browser's own history stays as it is: it leads
// from address to address, and undo changes the address that is shown.

import { valueAt } from '../api/scene-fields.js';
import { byId, h } from '../dom/elements.js';
import { quantity } from '../dom/numbers.js';
import { updateAddress } from './address-bar.js';
import { restoreState } from './scenes.js';

/** @typedef {import('./page.js').Page} Page */

/** @typedef {import('./page.js').State} State */
/** A state, and the edit that came after it: the path of a field, or words. @typedef {{state: State, edit: string}} Entry */

/** Entries kept. */
const MOST = 200;
/** Edits of one field by keys count as one while they follow each other within so long, ms. */
const TOGETHER_MS = 800;
/** The words on what was undone stay so long, ms. */
const SAID_MS = 4000;

/** A run's query without its clock, which no edit changes. @param {string | null} query */
function withoutClock(query) {
  if (query === null) return null;
  const params = new URLSearchParams(query);
  for (const key of [...params.keys()]) if (key.startsWith('clock.')) params.delete(key);
  params.sort();
  return String(params);
}

/** @param {State} one @param {State} other */
const alike = (one, other) =>
  JSON.stringify(one.scene) === JSON.stringify(other.scene) &&
  one.chosen === other.chosen &&
  one.pins === other.pins &&
  withoutClock(one.run) === withoutClock(other.run);

export class History {
  #page;
  /** @type {Entry[]} */
  #past = [];
  /** @type {Entry[]} */
  #future = [];
  /** The field whose edit goes on. @type {string | null} */
  #open = null;
  /** @type {number | undefined} */
  #closing;
  /** @type {number | undefined} */
  #fading;
  /** True when the last entry may turn out to be of no change. */
  #unsure = false;
  #undo = byId('undo', HTMLButtonElement);
  #redo = byId('redo', HTMLButtonElement);
  #said = h('p', { id: 'undone', class: 'undone', role: 'status' });

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    document.body.append(this.#said);
    this.#undo.addEventListener('click', () => this.undo());
    this.#redo.addEventListener('click', () => this.redo());
    // A press begins another edit, of the same slider too.
    addEventListener('pointerdown', () => this.#close(), { capture: true });
    addEventListener('keydown', (event) => this.#press(event));
    this.#show();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.defaultPrevented || !['z', 'y'].includes(key))
      return;
    if (document.querySelector('dialog[open]')) return;
    // A text that is being edited keeps the browser's own undo.
    const target = event.target instanceof Element ? event.target : null;
    if (target?.closest('input:not([type=range]):not([type=checkbox]), textarea, [contenteditable]')) return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) this.redo();
    else this.undo();
  }

  /** @returns {State} */
  #now() {
    const { typed = {}, releasedAs, chosen, run, pins } = this.#page;
    const played = run.phase === 'idle' ? null : String(run.query);
    return { scene: typed, releasedAs, chosen, run: played, pins: String(pins?.query() ?? '') };
  }

  /** Keeps the page as it is before an edit. @param {string} words for what is done, as in “the kick” */
  record(words) {
    this.#settle();
    this.#close();
    this.#keep(words);
    this.#future.length = 0;
    this.#show();
  }

  /** Keeps the page as it is before the edit of a field, once for a drag or for a text. @param {string} path @param {boolean} final */
  edit(path, final) {
    clearTimeout(this.#closing);
    if (this.#open !== path) {
      this.#settle();
      this.#keep(path);
      this.#open = path;
      this.#unsure = true;
      this.#show();
    }
    if (final) this.#closing = setTimeout(() => this.#close(), TOGETHER_MS);
  }

  /** @param {string} edit */
  #keep(edit) {
    this.#past.push({ state: this.#now(), edit });
    if (this.#past.length > MOST) this.#past.shift();
  }

  #close() {
    this.#open = null;
  }

  /** Forgets an edit that changed nothing; one that did leaves nothing to redo. */
  #settle() {
    if (!this.#unsure) return;
    this.#unsure = false;
    const last = this.#past.at(-1);
    if (last && alike(last.state, this.#now())) this.#past.pop();
    else this.#future.length = 0;
  }

  undo() {
    this.#go(this.#past, this.#future, 'Undone');
  }

  redo() {
    this.#go(this.#future, this.#past, 'Redone');
  }

  /** @param {Entry[]} from @param {Entry[]} to @param {string} verb */
  #go(from, to, verb) {
    this.#settle();
    this.#close();
    const now = this.#now();
    let entry = from.pop();
    while (entry && alike(entry.state, now)) entry = from.pop();
    if (entry) {
      to.push({ state: now, edit: entry.edit });
      restoreState(this.#page, entry.state);
      this.#page.pins?.restore(new URLSearchParams(entry.state.pins));
      // A run that is being replayed has its address when the server has answered.
      if (this.#page.run.phase !== 'connecting') updateAddress(this.#page);
    }
    this.#say(
      entry ? `${verb}: ${this.#wordsOf(entry)}` : `Nothing is left to ${verb === 'Undone' ? 'undo' : 'redo'}.`,
    );
    this.#show();
  }

  /** Says for a while what was done. @param {string} words */
  #say(words) {
    this.#said.textContent = words;
    this.#said.classList.add('fresh');
    clearTimeout(this.#fading);
    this.#fading = setTimeout(() => this.#said.classList.remove('fresh'), SAID_MS);
  }

  /** @param {Entry} entry that was just restored */
  #wordsOf({ state, edit }) {
    const field = this.#page.fields.find((one) => one.field === edit);
    if (!field) return `${edit}.`;
    const value = valueAt(state.scene, edit) ?? field.default;
    const words = typeof value === 'number' ? quantity(value, field.unit) : typeof value === 'string' ? value : null;
    return `${field.title.toLowerCase()}${words === null ? '' : ` is ${words} again`}.`;
  }

  #show() {
    for (const [button, entries, name] of /** @type {const} */ ([
      [this.#undo, this.#past, 'Undo'],
      [this.#redo, this.#future, 'Redo'],
    ])) {
      const { edit } = entries.at(-1) ?? {};
      button.disabled = !edit;
      const title = this.#page.fields.find((one) => one.field === edit)?.title.toLowerCase() ?? edit;
      button.title = title ? `${name} ${title}` : name;
    }
  }
}
