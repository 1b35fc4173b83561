// Explanations of the field's words and symbols: a button beside or around the word, and a note that a click or a key opens. Longer ones are in
// docs/physics.md.

import { h } from '../dom/elements.js';
import { html, render } from '../vendor/preact/preact.js';
import TERMS from './glossary.json' with { type: 'json' };
import { sign } from './parts.js';

/** @typedef {keyof typeof TERMS} TermName */
/** @typedef {{title: string, sign?: string, text: string}} Entry */

/** The note, one for the whole page; it moves to where it is asked for. @type {HTMLElement | null} */
let note = null;
/** The term whose note is open. @type {HTMLElement | null} */
let opener = null;

/** A word with its explanation one click or key away. @param {{name: TermName, words?: string}} props what the button says; else the term itself */
export function Term({ name, words }) {
  const { title, sign: letters } = /** @type {Entry} */ (TERMS[name]);
  const click = (/** @type {Event} */ event) => {
    event.preventDefault();
    const button = /** @type {HTMLElement} */ (event.currentTarget);
    const wasOpen = button === opener;
    note?.hidePopover();
    if (!wasOpen) open(button, name);
  };
  // With a target it is no press elsewhere, which would close the note before the click.
  return html`<button type="button" class="term" aria-expanded="false" aria-haspopup="dialog" data-term=${name}
    popovertarget="glossary" onClick=${click}>${words ?? (letters ? sign(letters) : title)}</button>`;
}

/** @param {HTMLElement} button @param {TermName} name */
function open(button, name) {
  const { title, sign: letters, text } = /** @type {Entry} */ (TERMS[name]);
  note ??= made();
  // Things outside of an open dialog cannot be reached.
  const home = button.closest('dialog, main') ?? document.body;
  if (note.parentElement !== home) home.append(note);
  render(html`<p><strong>${title}</strong>${letters && [' ', sign(letters)]}</p><p>${text}</p>`, note);
  note.setAttribute('aria-label', title);
  opener = button;
  button.setAttribute('aria-expanded', 'true');
  // The style sheet puts it below or above the word.
  note.showPopover({ source: button });
  // Focus goes back to the button when the note closes.
  note.focus({ preventScroll: true });
}

function made() {
  const element = h('div', {
    id: 'glossary',
    class: 'glossary',
    popover: 'auto',
    role: 'dialog',
    tabindex: -1,
    // The event after the change may come only when the next note is open.
    beforetoggle: (/** @type {ToggleEvent} */ event) => {
      if (event.newState !== 'closed') return;
      opener?.setAttribute('aria-expanded', 'false');
      if (element.contains(document.activeElement)) opener?.focus({ preventScroll: true });
      opener = null;
    },
  });
  return element;
}
