// Explanations of the field's words and symbols: a button beside or around the word, and a note that a click or a key opens. Longer ones are in
// docs/physics.md.

import { html, useState } from '../vendor/preact/preact.js';
import TERMS from './glossary.json' with { type: 'json' };
import { sign } from './parts.js';

/** @typedef {{title: string, sign?: string, text: string}} Entry */

/** The button before a note opens it; the style sheet puts it below or above the word. @param {HTMLElement | null} note */
const aim = (note) => {
  if (note) /** @type {HTMLButtonElement} */ (note.previousElementSibling).popoverTargetElement = note;
};

/** A word with its explanation one click or key away. @param {{name: keyof typeof TERMS, words?: string}} props what the button says; else the term itself */
export function Term({ name, words }) {
  const { title, sign: letters, text } = /** @type {Entry} */ (TERMS[name]);
  const [open, turn] = useState(false);
  // A term may stand twice on a page, but only one explanation is open.
  return html`<button type="button" class="term" aria-expanded=${String(open)} aria-haspopup="dialog"
      data-term=${name}>${words ?? (letters ? sign(letters) : title)}</button><div
      id=${open ? `glossary-${name}` : null} class="glossary" popover role="dialog" tabindex="-1" autofocus aria-label=${title} ref=${aim}
      onToggle=${(/** @type {ToggleEvent} */ { newState }) => turn(newState === 'open')}>
      <p><strong>${title}</strong>${letters && [' ', sign(letters)]}</p><p>${text}</p>
    </div>`;
}
