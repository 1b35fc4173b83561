// A file that is dropped on Play: measured bounces and scenes of a rig are read on another page.

import { h } from '../dom/elements.js';
import { notice } from '../dom/notices.js';

/** @param {() => URLSearchParams | null} query of the scene */
export function leadFiles(query) {
  const has = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files') ?? false;
  addEventListener('dragover', (event) => {
    if (has(event)) event.preventDefault();
  });
  addEventListener('drop', (event) => {
    if (!has(event)) return;
    // Else the browser would open it in place of the page.
    event.preventDefault();
    const rig = h('a', { href: `rig?${query() ?? ''}#measurements` }, 'My rig');
    notice('file', ['Measured bounces and scenes are read on ', rig, '. Drop the file there.']);
  });
}
