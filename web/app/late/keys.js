// Single keys for the run. They can be turned off for people whose tools send letters.

import { byId, h } from '../../dom/elements.js';
import { remember, remembered } from '../../play/remembered.js';

/** @typedef {{keys: string[], label: string, name: string, act: (key: string) => void}} Key */

const STORED = 'equipoise.keys';

/** @param {Key[]} keys */
export function listenToKeys(keys) {
  const dialog = byId('keys', HTMLDialogElement);
  const on = byId('keys-on', HTMLInputElement);
  on.checked = remembered(STORED, true);
  on.addEventListener('change', () => remember(STORED, on.checked));
  const all = [...keys, { keys: ['?'], label: '?', name: 'Show these keys', act: () => dialog.showModal() }];
  byId('keys-list').append(
    ...all.map(({ label, name }) => h('div', {}, h('dt', {}, h('kbd', {}, label)), h('dd', {}, name))),
  );
  byId('keys-open').addEventListener('click', () => dialog.showModal());
  addEventListener('keydown', (event) => {
    if (
      !on.checked ||
      document.querySelector('dialog[open]:not(.large)') ||
      event.defaultPrevented ||
      event.repeat ||
      event.ctrlKey ||
      event.metaKey ||
      event.altKey
    )
      return;
    const target = event.target instanceof Element ? event.target : null;
    // Letters belong to where one types, and Space to whatever it presses.
    if (target?.closest('input:not([type=range]):not([type=checkbox]), select, textarea, [contenteditable]')) return;
    if (event.key === ' ' && target?.closest('button, a, summary, input, [tabindex]:not(dialog)')) return;
    const found = all.find(({ keys: known }) => known.includes(event.key));
    if (!found) return;
    event.preventDefault();
    found.act(event.key);
  });
}
