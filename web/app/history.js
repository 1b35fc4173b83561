// Undo and redo of edits: the typed scene, and the run with what was done to it. Beside it the browser's own history stays as it is: it leads
// from address to address, and undo changes the address that is shown.

import { valueAt } from '../api/scene-fields.js';
import { told } from '../api/settings.js';
import { TYPED_IN, byId, pressedIn } from '../dom/elements.js';
import { restoreState } from './scenes.js';

/** A state, and the edit that came after it: the path of a field, or words. @typedef {{state: PageState, edit: string}} Entry */
/** A way through the states. @typedef {{name: 'undo' | 'redo', done: string, entries: Entry[]}} Way */

/** Entries kept. */
const MOST = 200;
/** Edits of one field by keys count as one while they follow each other within so long, ms. */
const TOGETHER_MS = 800;
/** The words on what was undone stay so long, ms. */
const SAID_MS = 4000;

/** A state as text, without the clock of its run, which no edit changes. @param {PageState} state */
function textOf({ scene, chosen, pins, run }) {
  const own = run === null ? null : [...new URLSearchParams(run)].filter(([key]) => !key.startsWith('clock.')).sort();
  return JSON.stringify([scene, chosen?.name, pins, own]);
}

/** Brings undo and redo: `record` keeps the page as it is before what words tell, `edit` before the edit of a field, once for a drag or for a text. @param {Page} page */
export function bringHistory(page) {
  /** @type {Way} */
  const undo = { name: 'undo', done: 'Undone', entries: [] };
  /** @type {Way} */
  const redo = { name: 'redo', done: 'Redone', entries: [] };
  /** The field whose edit goes on. @type {string | null} */
  let open = null;
  /** @type {number | undefined} */
  let closing;
  /** @type {number | undefined} */
  let fading;
  const said = byId('undone');
  const fieldOf = (/** @type {string} */ edit) => page.fields.find(({ field }) => field === edit);

  /** @returns {PageState} */
  const now = () => {
    const { typed = {}, releasedAs, chosen, run, pins } = page;
    const played = run.phase === 'idle' ? null : String(run.query);
    return { scene: typed, releasedAs, chosen, run: played, pins: String(pins?.query() ?? '') };
  };

  const show = () => {
    for (const { name, entries } of [undo, redo]) {
      const button = byId(name, HTMLButtonElement);
      const edit = entries.at(-1)?.edit ?? '';
      const words = fieldOf(edit)?.title.toLowerCase() ?? edit;
      button.disabled = entries.length === 0;
      button.title = `${name === 'undo' ? 'Undo' : 'Redo'} ${words}`.trim();
    }
  };

  const close = () => {
    open = null;
  };

  /** @param {string} edit */
  const keep = (edit) => {
    const { entries } = undo;
    const state = now();
    const last = entries.at(-1);
    // The edit before this one has changed nothing.
    if (last && textOf(last.state) === textOf(state)) entries.pop();
    entries.push({ state, edit });
    if (entries.length > MOST) entries.shift();
    redo.entries.length = 0;
    show();
  };

  /** @param {Entry} entry that was just restored */
  const wordsOf = ({ state, edit }) => {
    const field = fieldOf(edit);
    if (!field) return edit;
    const value = valueAt(state.scene, edit);
    return field.title.toLowerCase() + (Array.isArray(value) ? '' : ` is ${told(field, value)} again`);
  };

  /** @param {Way} from @param {Way} to */
  const go = (from, to) => {
    close();
    const state = now();
    let entry = from.entries.pop();
    while (entry && textOf(entry.state) === textOf(state)) entry = from.entries.pop();
    if (entry) {
      to.entries.push({ state, edit: entry.edit });
      restoreState(page, entry.state);
      page.pins?.restore(new URLSearchParams(entry.state.pins));
      // A run that is being replayed has its address when the server has answered.
      if (page.run.phase !== 'connecting') page.updateAddress();
    }
    said.textContent = entry ? `${from.done}: ${wordsOf(entry)}.` : `Nothing is left to ${from.name}.`;
    said.classList.add('fresh');
    clearTimeout(fading);
    fading = setTimeout(() => said.classList.remove('fresh'), SAID_MS);
    show();
  };

  byId('undo').addEventListener('click', () => go(undo, redo));
  byId('redo').addEventListener('click', () => go(redo, undo));
  // A press begins another edit, of the same slider too.
  addEventListener('pointerdown', close, { capture: true });
  addEventListener('keydown', (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.defaultPrevented || !'zy'.includes(key)) return;
    // A text that is being edited keeps the browser's own undo.
    if (document.querySelector('dialog[open]') || pressedIn(event, TYPED_IN)) return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) go(redo, undo);
    else go(undo, redo);
  });
  show();
  return {
    record: (/** @type {string} */ words) => {
      close();
      keep(words);
    },
    edit: (/** @type {string} */ path, /** @type {boolean} */ final) => {
      clearTimeout(closing);
      if (open !== path) {
        open = path;
        keep(path);
      }
      if (final) closing = setTimeout(close, TOGETHER_MS);
    },
  };
}
