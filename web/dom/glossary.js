// Explanations of the field's words and symbols: a button beside or around the word, and a note that a click or a key opens. Longer ones are in
// docs/physics.md.

import { h } from './elements.js';
import { sign } from '../panels/parts.js';
import { html, render } from '../vendor/preact/preact.js';

const TERMS = {
  residue: {
    title: 'Residue',
    sign: 'R',
    text: 'Greene’s residue: (2 − trace)/4 of the part of the linear map that moves the angle. From 0 to 1 the body keeps its balance.',
  },
  kappa: {
    title: 'Tilt gain',
    sign: 'κ',
    text: 'The table tilts by κ times the angle of the body at the contact: α = κθ.',
  },
  'kappa-critical': {
    title: 'Critical tilt gain',
    sign: 'κ_c',
    text: 'The largest tilt gain that balances. Above it an eigenvalue passes −1, and the body swings over.',
  },
  'spectral-radius': {
    title: 'Spectral radius',
    sign: 'max |λ|',
    text: 'Largest modulus of the eigenvalues: the factor by which small deviations grow or shrink per bounce. Below 1 all of them die out.',
  },
  wilson: {
    title: 'Wilson interval',
    text: 'Range in which the true share lies with 95 % confidence, given how many runs were made. More runs make it narrower.',
  },
  median: { title: 'Median', text: 'Half of the runs lie below it, half above.' },
  'half-life': {
    title: 'Half-life',
    text: 'Contacts in which half of the runs still going end, from the second half of the contacts.',
  },
  'at-risk': { title: 'At risk', text: 'Runs that reach a contact: those that have not ended before it.' },
  lqr: {
    title: 'Linear-quadratic regulator (LQR)',
    text: 'The law with the least sum of weighted squares of deviations and of tilt. A larger weight makes that deviation smaller; a larger weight of the tilt makes the table calmer.',
  },
  riccati: {
    title: 'Riccati equation',
    text: 'The equation whose solution gives the best law. Its residual says how exactly it was solved; it should be tiny.',
  },
  'gain-margin': { title: 'Gain margin', text: 'Factors by which the whole law may be off before it no longer holds.' },
  orbit: { title: 'Periodic orbit', text: 'A motion that repeats after a number of bounces, its period.' },
  soft: { title: 'Soft boundary', text: 'Beyond the boundary the body settles on a small swing nearby.' },
  hard: { title: 'Hard boundary', text: 'Beyond the boundary nothing nearby holds the body: it falls.' },
};

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
