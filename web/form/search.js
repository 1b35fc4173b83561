// The bar above the settings: a search for fields, and the way back to the case for all of them.

import { h } from '../dom/elements.js';

export class SettingsBar {
  element;
  #all = h('button', { type: 'button', id: 'settings-reset', hidden: true });
  #found = h('p', { class: 'muted found', role: 'status' });
  #input = h('input', {
    type: 'search',
    id: 'settings-search',
    placeholder: 'Find a setting',
    'aria-label': 'Find a setting',
    autocomplete: 'off',
    spellcheck: 'false',
  });

  /** @param {(words: string[]) => number | null} search shows the fields with all these words and counts them @param {() => void} resetAll */
  constructor(search, resetAll) {
    this.element = h('div', { class: 'settings-bar' }, this.#input, this.#all, this.#found);
    this.#input.addEventListener('input', () => {
      const words = this.#input.value.toLowerCase().split(/\s+/).filter(Boolean);
      const found = search(words);
      this.#found.textContent =
        words.length === 0
          ? ''
          : found === 0
            ? 'No setting has these words.'
            : `${found} ${found === 1 ? 'setting' : 'settings'}`;
    });
    this.#input.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape' || this.#input.value === '') return;
      event.preventDefault();
      this.clear();
    });
    this.#all.addEventListener('click', () => {
      resetAll();
      this.#input.focus();
    });
  }

  /** Shows all fields again. */
  clear() {
    if (this.#input.value === '') return;
    this.#input.value = '';
    this.#input.dispatchEvent(new Event('input'));
  }

  /** @param {number} count of the fields that differ from the case */
  differ(count) {
    this.#all.hidden = count === 0;
    this.#all.textContent = `Reset all (${count})`;
  }
}
