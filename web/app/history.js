// Undo and redo of edits: the typed scene, and the run with what was done to it. Beside it the browser's own history stays as it is: it leads
// from address to address, and undo changes the address that is shown.

import { valueAt } from '../api/scene-fields.js';
import { told } from '../api/settings.js';
import { TYPED_IN, byId, h, pressedIn } from '../dom/elements.js';
import { updateAddress } from './address-bar.js';
import { restoreState } from './scenes.js';

/** @typedef {import('./page.js').Page} Page */
/** @typedef {import('./page.js').State} State */
/** A state, and the edit that came after it: the path of a field, or words. @typedef {{state: State, edit: string}} Entry */

/** A way through the states, undo or redo. @typedef {{name: string, done: string, entries: Entry[], button: HTMLButtonElement}} Way */

/** Entries kept. */
const MOST = 200;
/** Edits of one field by keys count as one while they follow each other within so long, ms. */
const TOGETHER_MS = 800;
/** The words on what was undone stay so long, ms. */
const SAID_MS = 4000;

/** A state as text, without the clock of its run, which no edit changes. @param {State} state */
function textOf({ scene, chosen, pins, run }) {
  const own = run === null ? null : [...new URLSearchParams(run)].filter(([key]) => !key.startsWith('clock.')).sort();
  return JSON.stringify([scene, chosen?.name, pins, own]);
}

/** @param {State} one @param {State} other */
const alike = (one, other) => textOf(one) === textOf(other);

export class History {
  #page;
  /** @type {Way} */
  #undo = { name: 'Undo', done: 'Undone', entries: [], button: byId('undo', HTMLButtonElement) };
  /** @type {Way} */
  #redo = { name: 'Redo', done: 'Redone', entries: [], button: byId('redo', HTMLButtonElement) };
  /** The field whose edit goes on. @type {string | null} */
  #open = null;
  /** @type {number | undefined} */
  #closing;
  /** @type {number | undefined} */
  #fading;
  #said = h('p', { id: 'undone', class: 'undone', role: 'status' });

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    document.body.append(this.#said);
    this.#undo.button.addEventListener('click', () => this.#go(this.#undo, this.#redo));
    this.#redo.button.addEventListener('click', () => this.#go(this.#redo, this.#undo));
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
    // A text that is being edited keeps the browser's own undo.
    if (document.querySelector('dialog[open]') || pressedIn(event, TYPED_IN)) return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) this.#go(this.#redo, this.#undo);
    else this.#go(this.#undo, this.#redo);
  }

  /** @returns {State} */
  get #now() {
    const { typed = {}, releasedAs, chosen, run, pins } = this.#page;
    const played = run.phase === 'idle' ? null : String(run.query);
    return { scene: typed, releasedAs, chosen, run: played, pins: String(pins?.query() ?? '') };
  }

  /** Keeps the page as it is before an edit. @param {string} words for what is done, as in “the kick” */
  record(words) {
    this.#close();
    this.#keep(words);
  }

  /** Keeps the page as it is before the edit of a field, once for a drag or for a text. @param {string} path @param {boolean} final */
  edit(path, final) {
    clearTimeout(this.#closing);
    if (this.#open !== path) {
      this.#open = path;
      this.#keep(path);
    }
    if (final) this.#closing = setTimeout(() => this.#close(), TOGETHER_MS);
  }

  /** @param {string} edit */
  #keep(edit) {
    const { entries } = this.#undo;
    const state = this.#now;
    const last = entries.at(-1);
    // The edit before this one has changed nothing.
    if (last && alike(last.state, state)) entries.pop();
    entries.push({ state, edit });
    if (entries.length > MOST) entries.shift();
    this.#redo.entries.length = 0;
    this.#show();
  }

  #close() {
    this.#open = null;
  }

  /** @param {Way} from @param {Way} to */
  #go(from, to) {
    this.#close();
    const now = this.#now;
    let entry = from.entries.pop();
    while (entry && alike(entry.state, now)) entry = from.entries.pop();
    if (entry) {
      to.entries.push({ state: now, edit: entry.edit });
      restoreState(this.#page, entry.state);
      this.#page.pins?.restore(new URLSearchParams(entry.state.pins));
      // A run that is being replayed has its address when the server has answered.
      if (this.#page.run.phase !== 'connecting') updateAddress(this.#page);
    }
    this.#said.textContent = entry
      ? `${from.done}: ${this.#wordsOf(entry)}.`
      : `Nothing is left to ${from.name.toLowerCase()}.`;
    this.#said.classList.add('fresh');
    clearTimeout(this.#fading);
    this.#fading = setTimeout(() => this.#said.classList.remove('fresh'), SAID_MS);
    this.#show();
  }

  /** @param {string | undefined} edit */
  #fieldOf(edit) {
    return this.#page.fields.find(({ field }) => field === edit);
  }

  /** @param {Entry} entry that was just restored */
  #wordsOf({ state, edit }) {
    const field = this.#fieldOf(edit);
    if (!field) return edit;
    const value = valueAt(state.scene, edit);
    return field.title.toLowerCase() + (Array.isArray(value) ? '' : ` is ${told(field, value)} again`);
  }

  #show() {
    for (const { name, entries, button } of [this.#undo, this.#redo]) {
      const { edit } = entries.at(-1) ?? {};
      button.disabled = edit === undefined;
      button.title = [name, this.#fieldOf(edit)?.title.toLowerCase() ?? edit].filter(Boolean).join(' ');
    }
  }
}
