// Copies text to the clipboard.

import { h } from './elements.js';

/** Text to the clipboard, and the button says so for a moment. @param {HTMLElement} button @param {string} text */
export async function copy(button, text) {
  button.dataset.label ??= button.textContent ?? '';
  const { label } = button.dataset;
  try {
    if (navigator.clipboard) await navigator.clipboard.writeText(text);
    else copyOverHttp(text);
    button.textContent = 'Copied';
  } catch {
    button.textContent = 'Not allowed to copy';
  }
  setTimeout(() => {
    button.textContent = label;
  }, 1600);
}

/** A lab's machine is often reached by plain HTTP, where browsers have no clipboard but the old one. @param {string} text */
function copyOverHttp(text) {
  const carrier = h('textarea', { class: 'unseen' });
  carrier.value = text;
  document.body.append(carrier);
  carrier.select();
  const copied = document.execCommand('copy');
  carrier.remove();
  if (!copied) throw new Error('not copied');
}
