// Explanations of the field's words and symbols: a button beside or around the word, and a note that a click or a key opens. Longer ones are in
// docs/physics.md.

import { html, useLayoutEffect, useRef, useState } from '../vendor/preact/preact.js';
import TERMS from './glossary.json' with { type: 'json' };
import { sign } from './parts.js';

/** @typedef {{title: string, sign?: string, text: string}} Entry */

/** A word with its explanation one click or key away. @param {{name: keyof typeof TERMS, words?: string}} props what the button says; else the term itself */
export function Term({ name, words }) {
  const { title, sign: letters, text } = /** @type {Entry} */ (TERMS[name]);
  const id = `glossary-${name}`;
  const [open, turn] = useState(false);
  const [button, note] = [useRef(/** @type {any} */ (null)), useRef(/** @type {any} */ (null))];
  useLayoutEffect(() => {
    if (!open) return;
    // The style sheet puts it below or above the word.
    note.current.showPopover({ source: button.current });
    // Focus goes back to the button when the note closes.
    note.current.focus({ preventScroll: true });
  }, [open]);
  const click = (/** @type {Event} */ event) => {
    event.preventDefault();
    if (open) note.current.hidePopover();
    else turn(true);
  };
  // With a target it is no press elsewhere, which would close the note before the click.
  return html`<button type="button" class="term" aria-expanded=${String(open)} aria-haspopup="dialog" data-term=${name}
      popovertarget=${open ? id : null} onClick=${click} ref=${button}>${words ?? (letters ? sign(letters) : title)}</button>
    ${
      open &&
      html`<div id=${id} class="glossary" popover="auto" role="dialog" tabindex="-1" aria-label=${title} ref=${note}
        onToggle=${(/** @type {ToggleEvent} */ { newState }) => newState === 'closed' && turn(false)}>
        <p><strong>${title}</strong>${letters && [' ', sign(letters)]}</p><p>${text}</p>
      </div>`
    }`;
}
