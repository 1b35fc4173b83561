// Elements from script, without markup in strings. Not for anything that draws.

import { number } from './numbers.js';

/**
 * An element with attributes and children; a property that is a function becomes a listener.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, string | number | boolean | null | undefined | ((event: any) => void)>} [attributes]
 * @param {...(Node | string | null | undefined | false)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, '');
    else if (value != null && value !== false) element.setAttribute(name, String(value));
  }
  element.append(
    ...children
      .filter((child) => child != null && child !== false)
      .map((child) => /** @type {Node | string} */ (child)),
  );
  return element;
}

/**
 * The element of the page with this id; its absence is a mistake in the page itself.
 * @template {typeof HTMLElement} C
 * @param {string} id
 * @param {C} [kind]
 * @returns {InstanceType<C>}
 */
export function byId(id, kind) {
  const element = document.getElementById(id);
  if (!(element instanceof (kind ?? HTMLElement))) throw new Error(`the page has no #${id}`);
  return /** @type {InstanceType<C>} */ (element);
}

/**
 * A symbol in italics, `κ_c` with its subscript and `y*` with its star raised.
 * @param {string} text
 */
export function symbol(text) {
  const [base, low] = text.split('_');
  const star = base.endsWith('*');
  return h(
    'i',
    { class: 'symbol' },
    star ? base.slice(0, -1) : base,
    star && h('sup', {}, '*'),
    low && h('sub', {}, low),
  );
}

/**
 * The server's sentences: symbols and minus signs set as such, names of fields in words.
 * @param {string} text
 */
export const marked = (text) =>
  text
    .replaceAll('`', '')
    .replace(/(?<=[a-z])_(?=[a-z])/g, ' ')
    .replace(/(?<![\w.])-(?=\d)/g, '\u2212')
    .split(/((?:κ|σ)_[A-Za-z]+(?:,max)?|y\*)/)
    .map((part, index) => (index % 2 ? symbol(part) : part));

/** The same with numbers no longer than one reads. @param {string} text */
export const prose = (text) =>
  marked(text.replace(/-?\b\d+\.\d{6,}(?:e-?\d+)?/g, (digits) => number(Number(digits), 6)));

/**
 * Text to the clipboard, and the button says so for a moment.
 * @param {HTMLElement} button
 * @param {string} text
 */
export async function copy(button, text) {
  const label = (button.dataset.label ??= button.textContent ?? '');
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

/**
 * A finger that only scrolls past a slider has moved it before the browser knows: then what was there is put back.
 * @param {HTMLInputElement} slider before anything else listens to it
 * @param {() => () => void} hold keeps what the slider stands for, and gives what puts it back
 */
export function steady(slider, hold) {
  /** @type {(() => void) | null} */
  let putBack = null;
  let scrolled = false;
  slider.addEventListener('pointerdown', () => {
    scrolled = false;
    putBack = hold();
  });
  slider.addEventListener('pointercancel', () => {
    scrolled = true;
    putBack?.();
  });
  slider.addEventListener('keydown', () => {
    scrolled = false;
  });
  // The browser tells the cancelled move all the same.
  for (const event of ['input', 'change'])
    slider.addEventListener(event, (told) => {
      if (!scrolled) return;
      told.stopImmediatePropagation();
      putBack?.();
      if (event === 'change') scrolled = false;
    });
}

/**
 * Runs the last call only, once there was quiet for so long.
 * @param {number} quiet_ms
 * @param {() => void} run
 */
export function settled(quiet_ms, run) {
  /** @type {number | undefined} */
  let timer;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(run, quiet_ms);
  };
}
