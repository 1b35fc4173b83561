// Elements from script, without markup in strings.

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

/** @param {() => void} click */
export const retryButton = (click) => h('button', { type: 'button', click }, 'Try again');

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

/** Elements that take typed letters. */
export const TYPED_IN = 'input:not([type=range]):not([type=checkbox]), textarea, [contenteditable]';

/** True for an event in an element of a kind. @param {Event} event @param {string} selector */
export const pressedIn = ({ target }, selector) => target instanceof Element && target.closest(selector) !== null;
