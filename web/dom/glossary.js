// Explanations of the field's words and symbols: a button beside or around the word, and a note that a click or a key opens. Longer ones are in
// docs/physics.md.

import { h } from './elements.js';
import { symbol } from './typeset.js';

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

/** @typedef {keyof typeof TERMS} Term */

/** The note, one for the whole page; it moves to where it is asked for. @type {HTMLElement | null} */
let note = null;
/** The term whose note is open. @type {HTMLElement | null} */
let opener = null;

/** The term that was open when the pointer went down, which closes every note. @type {HTMLElement | null} */
let pressed = null;

/** Space between a word and its note, and to the edges of the window, px. */
const GAP = 6;

/**
 * A word with its explanation one click or key away.
 * @param {Term} name
 * @param {string | Node} [words] what the button says; else the term itself
 */
export function term(name, words) {
  const { title, sign } = /** @type {{title: string, sign?: string}} */ (TERMS[name]);
  return h(
    'button',
    {
      type: 'button',
      class: 'term',
      'aria-expanded': 'false',
      'aria-haspopup': 'dialog',
      'data-term': name,
      pointerdown: () => {
        pressed = opener;
      },
      click: (/** @type {Event} */ event) => toggle(/** @type {HTMLElement} */ (event.currentTarget), name),
    },
    words ?? (sign ? symbol(sign) : title),
  );
}

/**
 * Terms in a sentence: `{name}` or `{name|words}` becomes a button.
 * @param {string} text
 * @returns {(string | Node)[]}
 */
export const explained = (text) =>
  text.split(/\{([a-z-]+(?:\|[^}]*)?)\}/).map((part, index) => {
    if (index % 2 === 0) return part;
    const [name, words] = part.split('|');
    return term(/** @type {Term} */ (name), words);
  });

/** @param {HTMLElement} button @param {Term} name */
function toggle(button, name) {
  const wasOpen = button === opener || button === pressed;
  pressed = null;
  note?.hidePopover();
  if (!wasOpen) open(button, name);
}

/** @param {HTMLElement} button @param {Term} name */
function open(button, name) {
  const { title, sign, text } = /** @type {{title: string, sign?: string, text: string}} */ (TERMS[name]);
  note ??= made();
  // What is outside of an open dialog cannot be reached.
  const home = button.closest('dialog, main') ?? document.body;
  if (note.parentElement !== home) home.append(note);
  const heading = h('strong', {}, title);
  note.replaceChildren(
    h('p', {}, heading, sign && ' ', sign && symbol(sign)),
    h('p', {}, ...text.split('\n').flatMap((line, index) => (index ? [h('br'), line] : [line]))),
  );
  note.setAttribute('aria-label', title);
  opener = button;
  button.setAttribute('aria-expanded', 'true');
  note.showPopover();
  place(note, button);
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

/** Below the word or, without room there, above it. @param {HTMLElement} element @param {HTMLElement} word */
function place(element, word) {
  const { left, top, bottom } = word.getBoundingClientRect();
  const { offsetWidth: width, offsetHeight: height } = element;
  const room = innerHeight - bottom - GAP;
  const y = room >= height || room >= top ? bottom + GAP : top - GAP - height;
  element.style.left = `${Math.max(GAP, Math.min(left, innerWidth - width - GAP))}px`;
  element.style.top = `${Math.max(GAP, y)}px`;
}
